//! The arguments of the program. Each command's own are beside its code.

use clap::{Args, Parser, Subcommand, ValueEnum};

use crate::command;

/// Record, replay and compare shared controllers of a mobile robot on the same human behaviour.
///
/// A person and a controller share a robot. Tandem records what both did, replays it into another
/// version of the controller, and says what would have changed.
///
/// Research software: not a certified safety device.
#[derive(Parser)]
#[command(version, propagate_version = true, max_term_width = 100)]
#[command(after_help = "\
Start here:  tandem demo
Exit status: 0 done, same, gate passed; 1 differs, gate failed, file damaged;
             2 could not be done; 3 undecided")]
pub struct Cli {
    #[command(flatten)]
    pub common: Common,
    #[command(subcommand)]
    pub command: Command,
}

/// What every command takes.
#[derive(Args, Clone)]
pub struct Common {
    /// For people, or JSON on standard output alone
    #[arg(long, value_enum, default_value_t, global = true, help_heading = "Common options")]
    pub format: Format,
    /// Say nothing but the result
    #[arg(long, short, global = true, help_heading = "Common options")]
    pub quiet: bool,
    /// Say more on standard error about what is done
    #[arg(long, short, global = true, help_heading = "Common options", conflicts_with = "quiet")]
    pub verbose: bool,
    /// Overwrite files that exist
    #[arg(long, global = true, help_heading = "Common options")]
    pub force: bool,
    /// How many logs to work on at once [default: the number of cores]
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u16).range(1..), global = true,
          allow_negative_numbers = true,
          help_heading = "Common options")]
    pub threads: Option<u16>,
}

/// Who reads the result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum Format {
    /// A person.
    #[default]
    Human,
    /// A program.
    Json,
}

#[derive(Subcommand)]
pub enum Command {
    Demo(command::demo::Demo),
    Record(command::record::Record),
    Replay(command::replay::Replay),
    Diff(command::diff::Diff),
    Compare(command::compare::Compare),
    Metrics(command::metrics::Metrics),
    Map(command::map::Map),
    Explain(command::explain::Explain),
    Plot(command::plot::Plot),
    Check(command::check::Check),
    Approve(command::approve::Approve),
    Info(command::info::Info),
    Scenarios(command::list::Scenarios),
    Controllers(command::list::Controllers),
    Topics(command::list::Topics),
}
