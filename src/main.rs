//! The command line of Tandem: arguments in, a run, an exit status out.

#![expect(
    unreachable_pub,
    reason = "a program exports nothing; `pub` marks what other modules use"
)]

mod arm;
mod attribution;
mod cli;
mod command;
mod controller_choice;
mod explain;
mod faults;
mod fixture;
mod fleet;
mod interrupt;
mod logs;
mod output;
mod self_test;
mod side_by_side;
mod status;

use clap::Parser;
use clap::error::ErrorKind;
use std::process::ExitCode;

use crate::cli::Cli;
use crate::status::Status;

fn main() -> ExitCode {
    let cli = match Cli::try_parse() {
        Ok(cli) => cli,
        // A value that does not do is one line; everything else is clap's own to tell.
        Err(error) if error.kind() == ErrorKind::ValueValidation => {
            output::note(&output::one_line(error.to_string().lines().next().unwrap_or_default()));
            return Status::Impossible.into();
        }
        Err(error) => error.exit(),
    };
    interrupt::install();
    fleet::watch::keep_panics_quiet();
    let status = match command::run(&cli) {
        Ok(status) => status,
        Err(error) => {
            output::error(&error);
            Status::of_error(&error)
        }
    };
    status.into()
}
