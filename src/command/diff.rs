//! `tandem diff`: what differs between two runs.

use std::fs::{self, File};
use std::io::BufReader;
use std::path::PathBuf;

use anyhow::{Context as _, Result};
use clap::Args;
use compare::{Tolerances, report};
use schemas::log::{Arm, LogReader};

use crate::cli::Common;
use crate::status::Status;
use crate::{interrupt, logs, output};

/// What differs between two runs, field by field, and what differed first.
///
/// The runs are those of two logs, or those that stand side by side in one, as `tandem replay -o`
/// writes them. Steps and commands are paired by time. The first cause is the earliest stage of
/// the controller's data flow that differs at the earliest time: input, estimate, distances,
/// reference, law, sharing, command.
#[derive(Args)]
#[command(after_help = "\
Examples:
  tandem replay session.mcap --controller paper-kinematic -o paper.mcap
  tandem diff paper.mcap
  tandem diff one.mcap another.mcap

Exit status: 1 when the runs differ.")]
pub struct Diff {
    /// One run
    #[arg(value_name = "RUN_A")]
    a: PathBuf,
    /// The other [default: the first file holds both, side by side]
    #[arg(value_name = "RUN_B")]
    b: Option<PathBuf>,
    /// TOML file with an absolute and a relative tolerance per field or unit, or the word `practical`
    /// for what nobody would notice [default: exact]
    #[arg(long, value_name = "FILE")]
    tolerance: Option<PathBuf>,
}

impl Diff {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let tolerances = match &self.tolerance {
            None => Tolerances::exact(),
            Some(word) if word.as_os_str() == "practical" => Tolerances::practical(),
            Some(file) => {
                let text = fs::read_to_string(file)
                    .with_context(|| format!("cannot read tolerances {}", file.display()))?;
                Tolerances::from_toml(&text).with_context(|| file.display().to_string())?
            }
        };
        let (mut a, mut b) = match &self.b {
            Some(b) => (logs::open(&self.a)?, logs::open(b)?),
            None => (self.arm(Arm::A)?, self.arm(Arm::B)?),
        };
        let name_b = self.b.as_ref().unwrap_or(&self.a);
        let starts = (a.header().run.start, b.header().run.start);
        let diff = compare::diff::<anyhow::Error>(
            &tolerances,
            (starts.0, || {
                interrupt::check()?;
                a.next_event().with_context(|| self.a.display().to_string())
            }),
            (starts.1, || b.next_event().with_context(|| name_b.display().to_string())),
        )?;
        output::print(common, &diff, report::diff_text)?;
        Ok(if diff.same { Status::Done } else { Status::Differs })
    }
    /// One of the runs that stand side by side.
    fn arm(&self, arm: Arm) -> Result<LogReader<BufReader<File>>> {
        logs::open(&self.a)?
            .arm(arm)
            .with_context(|| format!("{}: a second run is needed, but", self.a.display()))
    }
}
