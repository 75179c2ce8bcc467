//! `tandem compare`: two controllers on the same recorded human behaviour.

use std::collections::BTreeMap;
use std::fs::{self, OpenOptions};
use std::io::Write as _;
use std::path::{Path, PathBuf};

use ::compare::{
    ArmInfo, Comparison, Gate, GateFile, LevelPair, LogPair, Provenance, Question, Verdict, report,
};
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

In a pipeline:
  tandem compare --a tandem-kinematic --b tandem-kinematic:candidate.toml fixtures/*/session.mcap \\
      --gate gate.toml --report report/ --summary \"$GITHUB_STEP_SUMMARY\"

Exit status: 0 better, worse or same; 1 failed; 3 undecided.
With a gate: 0 passed, 1 failed, 3 undecided.")]
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
    /// TOML file that says how much worse B may be; it then decides the exit status
    #[arg(long, value_name = "FILE")]
    pub gate: Option<PathBuf>,
    /// Write the report into this folder: report.html, report.md, report.json, junit.xml, metrics.csv
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// Append the Markdown report to this file, for a step summary
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,
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
        // A command that processed nothing has not found anything out, whatever the gate makes of it.
        let nothing = comparison.failed_logs() == comparison.logs.len();
        if let Some(gate) = comparison.gate.as_ref().filter(|_| !nothing) {
            return Ok(match gate.outcome {
                Gate::Pass | Gate::None => Status::Done,
                Gate::Fail => Status::Differs,
                Gate::Undecided => Status::Undecided,
            });
        }
        Ok(match comparison.verdict {
            Verdict::Better | Verdict::Worse | Verdict::Same => Status::Done,
            Verdict::Failed if nothing => {
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
        let gains = if self.mode.needs_gains(self.human) {
            arm::gains(common, &self.logs)
        } else {
            replay::Gains::PRIOR
        };
        let modes = match self.mode {
            ModeName::Open => vec![Mode::Open],
            ModeName::Closed => self.human.levels(gains).into_iter().map(Mode::Closed).collect(),
        };
        let reports = match &self.report {
            None => Vec::new(),
            Some(folder) => report_files(folder, common.force)?,
        };
        let gate = self.gate.as_deref().map(read_gate).transpose()?;
        self.refuse_copies()?;
        let results = fleet::each(common, &self.logs, "comparing", |log| {
            let pair = arm::pair(log, (&self.a, &self.b), &modes)?;
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
                    hash: String::new(),
                    scenario: None,
                    recorded: None,
                    levels: vec![LevelPair::failed(&format!("{error:#}"))],
                })
            })
            .collect();
        let question = Question {
            a: self.a.label().to_owned(),
            b: self.b.label().to_owned(),
            mode: modes.first().map_or("closed", |mode| mode.name()).to_owned(),
            human: modes
                .iter()
                .filter_map(|mode| match mode {
                    Mode::Open => None,
                    Mode::Closed(person) => Some(person.name().to_owned()),
                })
                .collect(),
            provenance: self.provenance(),
            gate,
        };
        let mut comparison = ::compare::compare(&question, pairs)?;
        comparison.report = reports.iter().map(|path| path.display().to_string()).collect();
        for path in &reports {
            let text = match path.extension().and_then(|extension| extension.to_str()) {
                Some("html") => report::html(&comparison)?,
                Some("md") => report::markdown(&comparison),
                Some("xml") => report::junit(&comparison),
                Some("csv") => report::csv(&comparison),
                _ => report::json(&comparison)?,
            };
            fs::write(path, text).with_context(|| format!("cannot write {}", path.display()))?;
        }
        if let Some(path) = &self.summary {
            let name = || format!("cannot append to {}", path.display());
            let mut file =
                OpenOptions::new().create(true).append(true).open(path).with_context(name)?;
            file.write_all(report::markdown(&comparison).as_bytes()).with_context(name)?;
        }
        Ok(comparison)
    }
}

impl Compare {
    /// What runs this comparison, and the arms' parameters as they are on the first log that can be
    /// read.
    fn provenance(&self) -> Provenance {
        let header = self.logs.iter().find_map(|log| Some(logs::open(log).ok()?.header().clone()));
        let arm = |choice: &ControllerChoice| {
            let header = header.as_ref()?;
            let params_toml = match choice {
                ControllerChoice::Recorded => header.params_toml.clone(),
                ControllerChoice::Version { .. } => choice.for_log(header).ok()?.params_toml(),
            };
            let params_hash = blake3::hash(params_toml.as_bytes()).to_hex().to_string();
            Some(ArmInfo { params_hash, params_toml })
        };
        Provenance {
            version: env!("CARGO_PKG_VERSION").to_owned(),
            commit: env!("TANDEM_COMMIT").to_owned(),
            dirty: env!("TANDEM_DIRTY") == "true",
            a: arm(&self.a).unwrap_or_default(),
            b: arm(&self.b).unwrap_or_default(),
            parameters: Vec::new(),
        }
    }

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

/// The gate that a file describes.
fn read_gate(path: &Path) -> Result<GateFile> {
    let text =
        fs::read_to_string(path).with_context(|| format!("cannot read gate {}", path.display()))?;
    GateFile::from_toml(&text).with_context(|| path.display().to_string())
}

/// The files of a report, checked before the work begins rather than after it.
fn report_files(folder: &Path, force: bool) -> Result<Vec<PathBuf>> {
    let files: Vec<PathBuf> =
        ["report.html", "report.md", "report.json", "junit.xml", "metrics.csv"]
            .iter()
            .map(|name| folder.join(name))
            .collect();
    for file in &files {
        logs::guard(file, force)?;
    }
    Ok(files)
}
