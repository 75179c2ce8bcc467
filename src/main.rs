//! The command line of Tandem: arguments in, a run, an exit status out.

#![expect(
    unreachable_pub,
    reason = "a program exports nothing; `pub` marks what other modules use"
)]

mod arm;
mod cli;
mod command;
mod controller_choice;
mod fixture;
mod fleet;
mod interrupt;
mod logs;
mod output;
mod status;

use clap::Parser;
use std::process::ExitCode;

use crate::cli::Cli;
use crate::status::Status;

fn main() -> ExitCode {
    let cli = Cli::parse();
    interrupt::install();
    let status = match command::run(&cli) {
        Ok(status) => status,
        // A reader of our output that went away (`| head`) is no failure of ours.
        Err(error) if output::is_broken_pipe(&error) => Status::Done,
        Err(error) => {
            eprintln!("error: {error:#}");
            Status::of_error(&error)
        }
    };
    status.into()
}
