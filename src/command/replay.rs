//! `tandem replay`: logs through a controller again.

use std::collections::BTreeMap;
use std::fmt::Write as _;
use std::fs;
use std::fs::File;
use std::io::BufWriter;
use std::path::{Path, PathBuf};
use std::time::Instant;

use anyhow::{Context as _, Result, bail};
use clap::{Args, ValueEnum};
use replay::{Mode, Outcome, Person};
use schemas::log::{LogWriter, WriterOptions};
use schemas::{Event, Header, RunInfo, Span, Stamped};
use serde::Serialize;

use crate::cli::Common;
use crate::controller_choice::ControllerChoice;
use crate::status::Status;
use crate::{fleet, interrupt, logs, output};

/// Replay logs into a controller.
///
/// Open loop feeds the recorded sensors and joystick at the recorded step times and compares what
/// the controller says. Closed loop lets the recorded person drive a simulated robot in the log's
/// own world, with sensors simulated anew from the recorded seed.
///
/// With the controller that recorded the log, both give the recording back bit for bit.
#[derive(Args)]
#[command(after_help = "\
Examples:
  tandem replay session.mcap
  tandem replay session.mcap --mode closed
  tandem replay logs/*.mcap --controller paper-kinematic --mode closed -o replayed/

Exit status: 1 when an open-loop replay of the recording controller is not identical to the
recording, or when a damaged log could be replayed in part only.")]
pub struct Replay {
    /// The logs to replay
    #[arg(required = true, value_name = "LOG")]
    pub logs: Vec<PathBuf>,
    /// Controller to replay into [default: the one that recorded the log]
    #[arg(long, default_value = "recorded", value_name = "C", hide_default_value = true)]
    pub controller: ControllerChoice,
    #[command(flatten)]
    pub how: How,
    /// Write the replayed session: a file for one log, a folder for several
    #[arg(long, short, value_name = "FILE|DIR")]
    pub output: Option<PathBuf>,
}

/// Open or closed loop, and with which person.
#[derive(Args, Clone, Copy)]
pub struct How {
    /// Open loop (recorded sensors) or closed loop (recorded person, simulated robot)
    #[arg(long, value_enum, default_value_t = ModeName::Open)]
    pub mode: ModeName,
    /// How the recorded person is brought back in closed loop
    #[arg(long, value_enum, default_value_t = HumanName::Playback)]
    pub human: HumanName,
}

/// `--mode`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum ModeName {
    /// Recorded sensors in, outputs compared
    Open,
    /// Recorded person, simulated robot
    Closed,
}

/// `--human`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub enum HumanName {
    /// The joystick as a function of time
    Playback,
}

impl ModeName {
    /// With the person it needs.
    pub fn with(self, human: HumanName) -> Mode {
        match (self, human) {
            (ModeName::Open, _) => Mode::Open,
            (ModeName::Closed, HumanName::Playback) => Mode::Closed(Person::Playback),
        }
    }
}

/// One line of the result.
#[derive(Serialize)]
struct Run {
    log: String,
    output: Option<String>,
    mode: &'static str,
    human: Option<&'static str>,
    controller: String,
    steps: u64,
    engaged_steps: u64,
    output_hash: Option<String>,
    identical_to_recorded: bool,
    max_deviation: Option<f64>,
    max_deviation_field: Option<&'static str>,
    max_deviation_at_s: Option<f64>,
    horizon_s: Option<f64>,
    realtime_factor: Option<f64>,
    cpu_s: Option<f64>,
    error: Option<String>,
    #[serde(skip)]
    status: Status,
}

#[derive(Serialize)]
struct Runs {
    runs: Vec<Run>,
}

impl Replay {
    pub fn run(&self, common: &Common) -> Result<Status> {
        let several = self.logs.len() > 1;
        if several && self.output.as_ref().is_some_and(|output| output.is_file()) {
            bail!("-o names a file, but there are several logs: name a folder");
        }
        let mode = self.how.mode.with(self.how.human);
        self.guard_outputs(several)?;
        let results = fleet::each(common, &self.logs, "replaying", |log| {
            self.replay_one(common, log, mode, several)
        });
        let runs: Vec<Run> = self
            .logs
            .iter()
            .zip(results)
            .map(|(log, result)| {
                result.unwrap_or_else(|error| Run {
                    log: log.display().to_string(),
                    output: None,
                    mode: mode.name(),
                    human: human_name(mode),
                    controller: self.controller.label().to_owned(),
                    steps: 0,
                    engaged_steps: 0,
                    output_hash: None,
                    identical_to_recorded: false,
                    max_deviation: None,
                    max_deviation_field: None,
                    max_deviation_at_s: None,
                    horizon_s: None,
                    realtime_factor: None,
                    cpu_s: None,
                    status: Status::of_error(&error),
                    error: Some(format!("{error:#}")),
                })
            })
            .collect();
        let status = runs.iter().fold(Status::Done, |worst, run| worst.worse(run.status));
        for run in &runs {
            if let Some(error) = &run.error {
                output::note(&format!("error: {error}"));
            }
        }
        output::print(common, &Runs { runs }, |runs| text(&runs.runs))?;
        Ok(status)
    }

    /// Refuses two logs of one name for one folder: one result would overwrite the other.
    fn guard_outputs(&self, several: bool) -> Result<()> {
        let Some(output) = &self.output else { return Ok(()) };
        let mut seen = BTreeMap::new();
        for log in &self.logs {
            let path = logs::output_for(log, self.controller.label(), output, several);
            if let Some(other) = seen.insert(path.clone(), log) {
                bail!(
                    "{} and {} would both be written to {}; replay them into different folders",
                    other.display(),
                    log.display(),
                    path.display()
                );
            }
        }
        Ok(())
    }

    fn replay_one(&self, common: &Common, log: &Path, mode: Mode, several: bool) -> Result<Run> {
        let header = logs::open(log)?.header().clone();
        let spec = self.controller.for_log(&header)?;
        output::detail(common, || {
            let run = &header.run;
            format!(
                "{}: {} recorded with {}, seed {}; replaying into {}",
                log.display(),
                run.scenario,
                run.controller,
                run.seed,
                spec.name
            )
        });
        let began = Instant::now();
        let mut replay = replay::Replay::new(|| logs::open_raw(log), &spec, mode)
            .with_context(|| log.display().to_string())?;
        let mut writer = match &self.output {
            None => None,
            Some(output) => {
                let path = logs::output_for(log, &spec.name, output, several);
                logs::guard_input(&path, log)?;
                logs::guard(&path, common.force)?;
                let header = replay_header(&header, &spec, mode, logs::hash_file(log)?);
                Some(Writing::begin(path, &header)?)
            }
        };
        let mut interrupted = false;
        while let Some(event) = replay.next_event() {
            if let Some(writer) = &mut writer {
                writer.write(&event)?;
            }
            if interrupt::pressed() {
                interrupted = true;
                break;
            }
        }
        let written = writer.map(Writing::finish).transpose()?;
        let outcome = match replay.finish().with_context(|| log.display().to_string()) {
            Ok(outcome) => outcome,
            Err(error) => {
                // A log without a step is no result.
                if let Some(path) = &written {
                    let _ = fs::remove_file(path);
                }
                return Err(error);
            }
        };
        let error = match &outcome.damage {
            _ if interrupted => Some(format!("{}: interrupted", log.display())),
            Some(damage) => Some(format!("{}: {damage}", log.display())),
            None => None,
        };
        let elapsed_s = began.elapsed().as_secs_f64();
        let status = self.status(&outcome, mode, interrupted);
        Ok(Run {
            log: log.display().to_string(),
            output: written.map(|path| path.display().to_string()),
            mode: mode.name(),
            human: human_name(mode),
            controller: match &self.controller {
                ControllerChoice::Recorded => spec.name.clone(),
                ControllerChoice::Version { typed, .. } => typed.clone(),
            },
            steps: outcome.steps,
            engaged_steps: outcome.engaged_steps,
            output_hash: Some(outcome.output_hash),
            identical_to_recorded: outcome.identical_to_recorded,
            max_deviation: outcome.max_deviation.as_ref().map(|deviation| deviation.amount),
            max_deviation_field: outcome.max_deviation.as_ref().map(|deviation| deviation.field),
            max_deviation_at_s: outcome.max_deviation.as_ref().map(|deviation| deviation.t_s),
            horizon_s: None,
            realtime_factor: (elapsed_s > 0.0).then(|| outcome.duration_s / elapsed_s),
            cpu_s: None,
            error,
            status,
        })
    }

    fn status(&self, outcome: &Outcome, mode: Mode, interrupted: bool) -> Status {
        if interrupted {
            return Status::Impossible;
        }
        let recording_controller = self.controller == ControllerChoice::Recorded;
        let should_be_identical = mode == Mode::Open && recording_controller;
        if outcome.damage.is_some() || (should_be_identical && !outcome.identical_to_recorded) {
            Status::Differs
        } else {
            Status::Done
        }
    }
}

fn human_name(mode: Mode) -> Option<&'static str> {
    match mode {
        Mode::Open => None,
        Mode::Closed(person) => Some(person.name()),
    }
}

/// The head of a replayed log: the recording's, with the controller that was replayed.
pub fn replay_header(
    recorded: &Header,
    spec: &controller::Spec,
    mode: Mode,
    source_hash: String,
) -> Header {
    let run = RunInfo {
        mode: mode.name().to_owned(),
        driver: human_name(mode).map_or_else(|| recorded.run.driver.clone(), str::to_owned),
        source_hash,
        ..recorded.run.clone()
    };
    let period = Span::from_seconds(spec.params.control_period_s);
    logs::header(spec, recorded.scenario.clone(), recorded.run.start, period, run)
}

/// A log being written, that knows its name when something goes wrong.
pub struct Writing {
    path: PathBuf,
    log: LogWriter<BufWriter<File>>,
}

impl Writing {
    pub fn begin(path: PathBuf, header: &Header) -> Result<Writing> {
        let log = schemas::log::create(&path, header, &WriterOptions::offline())
            .with_context(|| path.display().to_string())?;
        Ok(Writing { path, log })
    }

    pub fn write(&mut self, event: &Stamped<Event>) -> Result<()> {
        self.log.write(event).with_context(|| self.path.display().to_string())
    }

    pub fn finish(self) -> Result<PathBuf> {
        self.log.finish().with_context(|| self.path.display().to_string())?;
        Ok(self.path)
    }
}

fn text(runs: &[Run]) -> String {
    let mut text = String::new();
    for run in runs {
        let (Some(hash), human) = (&run.output_hash, run.human) else {
            let _ = writeln!(text, "{}: not replayed", run.log);
            continue;
        };
        let loop_name =
            human.map_or_else(|| run.mode.to_owned(), |h| format!("{} ({h})", run.mode));
        let _ = writeln!(text, "{}", run.log);
        let _ = writeln!(text, "  controller   {} · {loop_name} loop", run.controller);
        let _ = writeln!(
            text,
            "  steps        {} ({} with the feedback law driving)",
            run.steps, run.engaged_steps
        );
        let verdict = match (run.identical_to_recorded, run.max_deviation_field) {
            (true, _) => "identical, bit for bit".to_owned(),
            (false, Some(field)) => format!(
                "differs; most in {field}, by {:.6} at {:.2} s",
                run.max_deviation.unwrap_or(f64::NAN),
                run.max_deviation_at_s.unwrap_or(f64::NAN)
            ),
            (false, None) if run.error.is_some() => {
                "no difference as far as the log goes".to_owned()
            }
            (false, None) => "differs, though in no number of a step".to_owned(),
        };
        let _ = writeln!(text, "  recording    {verdict}");
        let _ = writeln!(text, "  hash         {hash}");
        if let Some(factor) = run.realtime_factor {
            let _ = writeln!(text, "  speed        {factor:.0} × real time");
        }
        if let Some(output) = &run.output {
            let _ = writeln!(text, "  written to   {output}");
        }
    }
    text
}
