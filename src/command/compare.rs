//! `tandem compare`: two controllers on the same recorded human behaviour.

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

use ::compare::{Comparison, LogPair, Question, Verdict, report};
use anyhow::{Context as _, Result, bail};
use clap::Args;
use replay::Mode;

use crate::cli::Common;
use crate::command::replay::{HumanName, ModeName};
use crate::controller_choice::ControllerChoice;
use crate::status::Status;
use crate::{arm, fleet, interrupt, logs, output};

/// Compare two controllers on the same recorded human behaviour.
///
/// Each log is replayed into both. In closed loop (the default here) both arms are simulated, with
/// the same person and the same noise; metrics are paired per log, and uncertainty is over logs.
#[derive(Args)]
#[command(after_help = "\
Example:
  tandem compare --a paper-kinematic --b tandem-kinematic logs/*.mcap --report report/

Exit status: 0 better, worse or same; 1 failed; 3 undecided.")]
pub struct Compare {
    /// The controller to compare with
    #[arg(long, value_name = "C")]
    pub a: ControllerChoice,
    /// The controller that is judged
    #[arg(long, value_name = "C")]
    pub b: ControllerChoice,
    /// The logs
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Open loop (recorded sensors) or closed loop (recorded person, simulated robot)
    #[arg(long, value_enum, default_value_t = ModeName::Closed)]
    pub mode: ModeName,
    /// How the recorded person is brought back in closed loop
    #[arg(long, value_enum, default_value_t = HumanName::Playback)]
    pub human: HumanName,
    /// Write the report into this folder: report.html, report.md, report.json
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
}

impl Compare {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let comparison = self.compare(common)?;
        let failed = comparison.logs.iter().filter_map(|log| Some((log, log.error.as_ref()?)));
        for (log, error) in failed.clone().filter(|(_, error)| !error.contains("interrupted")) {
            output::note(&format!("error: {}: {error}", log.log));
        }
        if interrupt::pressed() {
            output::note(&format!("error: interrupted; {} logs not compared", failed.count()));
        }
        output::print(common, &comparison, report::terminal)?;
        if interrupt::pressed() {
            return Ok(Status::Impossible);
        }
        Ok(match comparison.verdict {
            Verdict::Better | Verdict::Worse | Verdict::Same => Status::Done,
            // A command that processed nothing has not found anything out.
            Verdict::Failed if comparison.failed_logs() == comparison.logs.len() => {
                let damaged =
                    |log: &PathBuf| schemas::log::inspect(log).is_ok_and(|l| l.damage.is_some());
                if self.logs.iter().any(damaged) { Status::Differs } else { Status::Impossible }
            }
            Verdict::Failed => Status::Differs,
            Verdict::Undecided => Status::Undecided,
        })
    }

    /// Compares and writes the report, without telling; also the way in for `demo`.
    pub fn compare(&self, common: &Common) -> Result<Comparison> {
        if self.human == HumanName::Ladder {
            bail!(
                "compare takes one level of the ladder at a time; `tandem replay --human ladder` runs all"
            );
        }
        let gains = if self.mode.needs_gains(self.human) {
            arm::gains(common, &self.logs)
        } else {
            replay::Gains::PRIOR
        };
        let mode = self.mode.with(self.human, gains);
        let reports = match &self.report {
            None => Vec::new(),
            Some(folder) => report_files(folder, common.force)?,
        };
        self.refuse_copies()?;
        let results = fleet::each(common, &self.logs, "comparing", |log| {
            let pair = arm::pair(log, (&self.a, &self.b), mode)?;
            output::detail(common, || format!("{}: compared", pair.log));
            Ok(pair)
        });
        let pairs: Vec<LogPair> = self
            .logs
            .iter()
            .zip(results)
            .map(|(log, result)| {
                result.unwrap_or_else(|error| LogPair {
                    log: log.display().to_string(),
                    operator: String::new(),
                    scenario: None,
                    a: Err(format!("{error:#}")),
                    b: Err(format!("{error:#}")),
                    diff: None,
                })
            })
            .collect();
        let question = Question {
            a: self.a.label().to_owned(),
            b: self.b.label().to_owned(),
            mode: mode.name().to_owned(),
            human: match mode {
                Mode::Open => Vec::new(),
                Mode::Closed(person) => vec![person.name().to_owned()],
            },
        };
        let mut comparison = ::compare::compare(&question, pairs)?;
        comparison.report = reports.iter().map(|path| path.display().to_string()).collect();
        for path in &reports {
            let text = match path.extension().and_then(|extension| extension.to_str()) {
                Some("html") => report::html(&comparison)?,
                Some("md") => report::markdown(&comparison),
                _ => report::json(&comparison)?,
            };
            fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))?;
        }
        Ok(comparison)
    }
}

impl Compare {
    /// Refuses the same recording twice: one person counted twice looks like more evidence.
    fn refuse_copies(&self) -> Result<()> {
        let mut seen = BTreeMap::new();
        for log in self.logs.iter().filter(|log| log.is_file()) {
            if let Some(other) = seen.insert(logs::hash_file(log)?, log) {
                bail!(
                    "{} and {} are the same recording; name it once",
                    other.display(),
                    log.display()
                );
            }
        }
        Ok(())
    }
}

/// The files of a report, checked before the work begins rather than after it.
fn report_files(folder: &Path, force: bool) -> Result<Vec<PathBuf>> {
    let files: Vec<PathBuf> =
        ["report.html", "report.md", "report.json"].iter().map(|name| folder.join(name)).collect();
    for file in &files {
        logs::guard(file, force)?;
    }
    Ok(files)
}
