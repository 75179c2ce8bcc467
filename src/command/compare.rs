//! `tandem compare`: two controllers on the same recorded human behaviour.

mod report_files;
mod side_by_side;

use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};
use std::time::Duration;

use ::compare::{
    ArmInfo, Comparison, Gate, GateFile, LevelPair, LogPair, Provenance, Question, Verdict, report,
};
use anyhow::{Context as _, Result, bail, ensure};
use clap::Args;
use replay::{Faults, Mode};
use report_files::{ReportFiles, append};
use schemas::Header;
use side_by_side::SideBySide;

use crate::cli::Common;
use crate::command::replay::{HumanName, ModeName, PlantName, patience};
use crate::controller_choice::ControllerChoice;
use crate::faults::FaultArgs;
use crate::fleet::watch;
use crate::interrupt::Interrupted;
use crate::self_test::{Answer, Ask};
use crate::status::Status;
use crate::{arm, attribution, interrupt, logs, output, self_test};

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

Would it notice?
  tandem compare --self-test --a tandem-kinematic

With broken sensors, the same for both?
  tandem compare --a paper-kinematic --b tandem-kinematic --fault sonar-dead=3 logs/*.mcap

Exit status: 0 better, worse or same; 1 failed; 3 undecided.
With a gate: 0 passed, 1 failed, 3 undecided. With --self-test: 1 also when that is not passed.
Where a part of the report cannot be written, the rest and the verdict come out all the same;
the status is then 2.")]
pub struct Compare {
    /// The controller to compare with
    #[arg(long, value_name = "C")]
    pub a: ControllerChoice,
    /// The controller that is judged [with --self-test: A itself]
    #[arg(long, value_name = "C", required_unless_present = "self_test")]
    pub b: Option<ControllerChoice>,
    /// The logs [with --self-test alone: sessions of its own]
    #[arg(value_name = "LOG", required_unless_present = "self_test")]
    pub logs: Vec<PathBuf>,
    /// Open loop (recorded sensors) or closed loop (recorded person, simulated robot)
    #[arg(long, value_enum, default_value_t = ModeName::Closed)]
    pub mode: ModeName,
    /// How the recorded person is brought back in closed loop
    #[arg(long, value_enum, default_value_t = HumanName::Playback)]
    pub human: HumanName,
    /// Give up on a controller that does not answer for so many seconds; its log then has failed
    #[arg(long, default_value = "30", value_name = "SECONDS", value_parser = patience,
          allow_negative_numbers = true)]
    pub hang_after: Duration,
    /// The plant of a closed loop, for both arms: the one that each log claims, or the one that it shows
    #[arg(long, value_enum, default_value_t = PlantName::Recorded)]
    pub plant: PlantName,
    #[command(flatten)]
    pub faults: FaultArgs,
    /// TOML file that says how much worse B may be; it then decides the exit status
    #[arg(long, value_name = "FILE")]
    pub gate: Option<PathBuf>,
    /// Write the report into this folder: report.html, report.md, report.json, junit.xml, metrics.csv, and
    /// ab/ with logs for a viewer
    #[arg(long, value_name = "DIR")]
    pub report: Option<PathBuf>,
    /// With --report: of how many logs, those with most to see, both arms go side by side into a log
    #[arg(
        long,
        value_name = "N",
        default_value_t = 3,
        requires = "report",
        allow_negative_numbers = true
    )]
    pub ab: u16,
    /// Append the Markdown report to this file, for a step summary
    #[arg(long, value_name = "FILE")]
    pub summary: Option<PathBuf>,
    /// Swap each parameter that differs from A to B alone, and back: which of them makes the difference
    #[arg(long, requires = "b")]
    pub attribute: bool,
    /// Test the comparison itself: A against A, against mutants of A, and against A with other noise
    #[arg(long)]
    pub self_test: bool,
    /// With --self-test: how many comparisons with other noise
    #[arg(long, value_name = "N", default_value_t = 200, requires = "self_test",
          value_parser = clap::value_parser!(u16).range(1..), allow_negative_numbers = true)]
    pub alarms: u16,
}

/// A comparison, and what kept parts of its report from being written.
pub struct Compared {
    pub comparison: Comparison,
    pub unwritten: Vec<anyhow::Error>,
}

impl Compare {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let Compared { comparison, unwritten } = self.compare(common)?;
        let failed = comparison.logs.iter().filter_map(|log| Some((log, log.error.as_ref()?)));
        for (log, error) in failed.clone().filter(|(_, error)| !error.contains("interrupted")) {
            output::note(&format!("error: {}: {error}", log.log));
        }
        if interrupt::pressed() {
            let what = match failed.count() {
                0 => "while the report was written".to_owned(),
                count => format!("{count} logs not compared"),
            };
            output::note(&format!("error: interrupted; {what}"));
        }
        if comparison.mode == "open" {
            output::note(
                "in open loop the robot moves as recorded whichever controller is asked: nothing is said \
                 of safety and motion, and no gate on them can fail; --mode closed asks about those",
            );
        }
        for warning in comparison.plant_doubts().into_iter().chain(comparison.unmet_faults()) {
            output::note(&format!("warning: {warning}"));
        }
        for error in unwritten.iter().filter(|error| !Interrupted::caused(error)) {
            output::error(error);
        }
        output::print(common, &comparison, report::terminal)?;
        if interrupt::pressed() || !unwritten.is_empty() {
            return Ok(Status::Impossible);
        }
        let tested = match &comparison.self_test {
            Some(test) if !test.passed => Status::Differs,
            _ => Status::Done,
        };
        Ok(self.status(&comparison).worse(tested))
    }

    /// What a comparison comes to as an exit status.
    fn status(&self, comparison: &Comparison) -> Status {
        // A command that processed nothing has not found anything out, whatever the gate makes of it.
        let nothing = comparison.failed_logs() == comparison.logs.len();
        if let Some(gate) = comparison.gate.as_ref().filter(|_| !nothing) {
            return match gate.outcome {
                Gate::Pass | Gate::None => Status::Done,
                Gate::Fail => Status::Differs,
                Gate::Undecided => Status::Undecided,
            };
        }
        match comparison.verdict {
            Verdict::Better | Verdict::Worse | Verdict::Same => Status::Done,
            Verdict::Failed if nothing => {
                let damaged =
                    |log: &PathBuf| schemas::log::inspect(log).is_ok_and(|l| l.damage.is_some());
                if self.logs.iter().any(damaged) { Status::Differs } else { Status::Impossible }
            }
            Verdict::Failed => Status::Differs,
            Verdict::Undecided => Status::Undecided,
        }
    }

    /// Compares and writes the report, without telling; also the way in for `demo`.
    pub fn compare(&self, common: &Common) -> Result<Compared> {
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
            Some(folder) => ReportFiles::guarded(folder, common.force)?,
        };
        let side_by_side =
            self.report.as_deref().map(|folder| SideBySide::into(folder, common.force, &self.logs));
        let side_by_side = side_by_side.transpose()?;
        let gate = self.gate.as_deref().map(read_gate).transpose()?;
        ensure!(!self.logs.is_empty() || self.b.is_none(), "no log to compare A and B on");
        self.refuse_copies()?;
        let faults = self.faults.faults()?;
        self.mode.refuse_without_effect(self.human, self.plant)?;
        ensure!(
            self.plant == PlantName::Recorded || !self.self_test,
            "--self-test drives the plant that each log claims: leave out --plant identified"
        );
        let recorded = [&self.a, self.b()].contains(&&ControllerChoice::Recorded);
        ensure!(
            faults.is_empty() || !recorded,
            "--fault is put under controllers that are replayed, and `recorded` is not: name the \
             controller that recorded"
        );
        if self.attribute {
            attribution::refuse_laws((&self.a, self.b()), &self.logs)?;
        }
        let tested =
            if self.self_test { Some(self.test(common, &modes, gate.clone())?) } else { None };
        let provenance = self.provenance(tested.as_ref().map(|answer| &answer.header));
        let (self_test, itself) = tested.map(|answer| (answer.test, answer.itself)).unzip();
        let pairs = match (&self.b, itself) {
            (None, Some(itself)) => itself,
            _ => self.pairs(common, &modes, &faults),
        };
        let question = Question {
            a: self.a.label().to_owned(),
            b: self.b().label().to_owned(),
            mode: modes.first().map_or("closed", |mode| mode.name()).to_owned(),
            human: modes
                .iter()
                .filter_map(|mode| match mode {
                    Mode::Open => None,
                    Mode::Closed(person) => Some(person.name().to_owned()),
                })
                .collect(),
            provenance,
            gate,
            faults: faults.names(),
            plant: match (self.mode, self.plant) {
                (ModeName::Open, _) => String::new(),
                (ModeName::Closed, PlantName::Recorded) => "recorded".to_owned(),
                (ModeName::Closed, PlantName::Identified) => "identified".to_owned(),
            },
        };
        let mut comparison = ::compare::compare(&question, pairs)?;
        comparison.self_test = self_test;
        if self.attribute {
            let how = attribution::How {
                mode: shown(&modes),
                plant: self.plant,
                faults: faults.clone(),
                hang_after: self.hang_after,
            };
            comparison.swaps =
                attribution::attribute(common, (&self.a, self.b()), &self.logs, how)?;
        }
        let shows = !(self.logs.is_empty() || modes.is_empty());
        let side_by_side = side_by_side.filter(|_| shows);
        let mut unwritten = Vec::new();
        // What an earlier comparison left goes first, and makes room.
        unwritten.extend(side_by_side.as_ref().and_then(|folder| folder.clear().err()));
        let mut files = ReportFiles::write(&mut comparison, reports);
        if let Some(folder) = side_by_side {
            let shown = shown(&modes);
            let added = folder.write(&mut comparison, usize::from(self.ab), |log, output| {
                let arms = [&self.a, self.b()];
                arm::write_side_by_side(&self.logs[log], arms, (shown, &faults, self.plant), output)
            });
            files.unwritten.extend(added.err());
        }
        unwritten.extend(files.complete(&comparison));
        if let Some(path) = &self.summary {
            unwritten.extend(append(&comparison, path).err());
        }
        Ok(Compared { comparison, unwritten })
    }
}

impl Compare {
    /// The controller that is judged: A itself where only the comparison is tested.
    fn b(&self) -> &ControllerChoice {
        self.b.as_ref().unwrap_or(&self.a)
    }

    /// Both arms of every log.
    fn pairs(&self, common: &Common, modes: &[Mode], faults: &Faults) -> Vec<LogPair> {
        let (a, b, modes) = (self.a.clone(), self.b().clone(), modes.to_vec());
        let (faults, plant) = (faults.clone(), self.plant);
        let of_all = common.clone();
        let work = move |log: &PathBuf| {
            let pair = arm::pair(log, (&a, &b), &modes, &faults, plant)?;
            output::detail(&of_all, || format!("{}: compared", pair.log));
            Ok(pair)
        };
        let results = watch::each(common, self.logs.clone(), "comparing", self.hang_after, work);
        self.logs
            .iter()
            .zip(results)
            .map(|(log, result)| {
                result.unwrap_or_else(|error| LogPair {
                    log: log.display().to_string(),
                    operator: String::new(),
                    hash: String::new(),
                    scenario: None,
                    recorded: None,
                    plant_doubt: None,
                    plant_untold: Some("it could not be read".to_owned()),
                    unmet_faults: Vec::new(),
                    levels: vec![LevelPair::failed(&format!("{error:#}"))],
                })
            })
            .collect()
    }

    /// Tests the comparison itself, over the logs or over sessions of our own.
    fn test(&self, common: &Common, modes: &[Mode], gate: Option<GateFile>) -> Result<Answer> {
        let [Mode::Closed(person)] = modes else {
            bail!(
                "--self-test replays in closed loop, with one person: leave out --mode open and --human ladder"
            );
        };
        let sessions = if self.logs.is_empty() {
            self_test::built_in(common, &self.a, self.hang_after)?
        } else {
            self_test::of_logs(common, &self.logs)?
        };
        let ask = Ask {
            controller: self.a.clone(),
            sessions,
            person: *person,
            gate,
            comparisons: usize::from(self.alarms),
            faults: self.faults.faults()?,
            hang_after: self.hang_after,
        };
        ask.answer(common)
    }

    /// What runs this comparison, and the arms' parameters as they are on the first log that can be
    /// read, or on the session that is given.
    fn provenance(&self, session: Option<&Header>) -> Provenance {
        let of_log = self.logs.iter().find_map(|log| Some(logs::open(log).ok()?.header().clone()));
        let header = of_log.or_else(|| session.cloned());
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
            b: arm(self.b()).unwrap_or_default(),
            parameters: Vec::new(),
        }
    }

    /// Refuses the same recording twice: one person counted twice looks like more evidence.
    fn refuse_copies(&self) -> Result<()> {
        let size = |log: &PathBuf| {
            fs::metadata(log).ok().filter(fs::Metadata::is_file).map(|file| file.len())
        };
        let sizes: Vec<Option<u64>> = self.logs.iter().map(size).collect();
        let mut alike: BTreeMap<u64, usize> = BTreeMap::new();
        for size in sizes.iter().flatten() {
            *alike.entry(*size).or_default() += 1;
        }
        let mut seen = BTreeMap::new();
        for (log, size) in self.logs.iter().zip(sizes) {
            // Only what is as long as another can be the same.
            if size.is_none_or(|size| alike[&size] < 2) {
                continue;
            }
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

/// The mode that stands for a log in pictures: the first that estimates, else the first.
fn shown(modes: &[Mode]) -> Mode {
    let estimates = |mode: &&Mode| matches!(mode, Mode::Closed(person) if person.is_estimate());
    *modes.iter().find(estimates).or(modes.first()).unwrap_or(&Mode::Open)
}

/// The gate that a file describes.
fn read_gate(path: &Path) -> Result<GateFile> {
    let text =
        fs::read_to_string(path).with_context(|| format!("cannot read gate {}", path.display()))?;
    GateFile::from_toml(&text).with_context(|| path.display().to_string())
}
