//! `tandem diff`: what differs between two runs.

use std::collections::BTreeSet;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::{Path, PathBuf};

use anyhow::{Context as _, Result};
use clap::Args;
use compare::{CompareError, Next, Tolerances, report};
use schemas::log::{Arm, LogReader};
use serde::Serialize;

use crate::cli::{Common, Format};
use crate::status::Status;
use crate::{interrupt, logs, output};

/// What was compared, and what of it could not be read.
#[derive(Serialize)]
struct Compared {
    #[serde(flatten)]
    diff: compare::Diff,
    /// What ended a run before its end.
    damage: Vec<Damage>,
}

#[derive(Serialize)]
struct Damage {
    run: String,
    what: String,
}

/// The next event of a run. What it is damaged by ends it here and is kept.
fn next(
    log: &mut LogReader<BufReader<File>>,
    path: &Path,
    damage: &mut Option<Damage>,
) -> Result<Next> {
    match log.next_event() {
        Ok(event) => Ok(event.into()),
        Err(error) if error.is_damage() => {
            *damage = Some(Damage { run: path.display().to_string(), what: error.to_string() });
            Ok(Next::Cut)
        }
        Err(error) => Err(error).with_context(|| path.display().to_string()),
    }
}

/// What is known of runs of which nothing can be read that is compared.
fn nothing_compared() -> compare::Diff {
    compare::Diff {
        same: false,
        whole: false,
        same_behaviour: false,
        compared: compare::Compared::default(),
        fields: Vec::new(),
        first_cause: None,
    }
}

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

Exit status: 1 when the runs differ, or when a damaged log could be compared in part only.")]
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
        let mut damage = [None, None];
        let [damage_a, damage_b] = &mut damage;
        let diff = compare::diff::<anyhow::Error, _>(
            &tolerances,
            (starts.0, || {
                interrupt::check()?;
                next(&mut a, &self.a, damage_a)
            }),
            (starts.1, || next(&mut b, name_b, damage_b)),
        );
        let damage: Vec<Damage> = damage.into_iter().flatten().collect();
        let diff = match (diff, damage.first()) {
            // Where nothing is left to compare, the reason is what was wrong with the log.
            (Err(error), Some(Damage { run, what })) if error.is::<CompareError>() => {
                output::note(&format!("error: {run}: {what}; no step stands before that"));
                if common.format == Format::Json {
                    let result = Compared { diff: nothing_compared(), damage };
                    output::print(common, &result, |_| String::new())?;
                }
                return Ok(Status::Differs);
            }
            (diff, _) => diff?,
        };
        let mut told = BTreeSet::new();
        for Damage { run, what } in &damage {
            if told.insert((run, what)) {
                output::note(&format!("error: {run}: {what}"));
            }
        }
        let status = if diff.same { Status::Done } else { Status::Differs };
        let result = Compared { diff, damage };
        output::print(common, &result, |result| report::diff_text(&result.diff))?;
        Ok(status)
    }
    /// One of the runs that stand side by side.
    fn arm(&self, arm: Arm) -> Result<LogReader<BufReader<File>>> {
        logs::open(&self.a)?
            .arm(arm)
            .with_context(|| format!("{}: a second run is needed, but", self.a.display()))
    }
}
