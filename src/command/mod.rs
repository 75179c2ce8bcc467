//! One file per command: its arguments, what it does, and how it tells.

pub mod approve;
pub mod check;
pub mod compare;
pub mod demo;
pub mod diff;
pub mod explain;
pub mod info;
pub mod list;
pub mod map;
pub mod metrics;
pub mod plot;
pub mod record;
pub mod replay;

use anyhow::Result;

use crate::cli::{Cli, Command};
use crate::status::Status;

/// Runs the command that was asked for.
pub fn run(cli: &Cli) -> Result<Status> {
    let common = &cli.common;
    match &cli.command {
        Command::Demo(command) => command.run(common),
        Command::Record(command) => command.run(common),
        Command::Replay(command) => command.run(common),
        Command::Diff(command) => command.run(common),
        Command::Compare(command) => command.run(common),
        Command::Metrics(command) => command.run(common),
        Command::Map(command) => command.run(common),
        Command::Explain(command) => command.run(common),
        Command::Plot(command) => command.run(common),
        Command::Check(command) => command.run(common),
        Command::Approve(command) => command.run(common),
        Command::Info(command) => command.run(common),
        Command::Scenarios(command) => command.run(common),
        Command::Controllers(command) => command.run(common),
        Command::Topics(command) => command.run(common),
    }
}
