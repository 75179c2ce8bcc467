//! One arm of a comparison: a log under one controller.

use std::cell::RefCell;
use std::fs::File;
use std::io::BufReader;
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Context as _, Result, anyhow};
use compare::{Diff, LevelPair, LogPair, Measured, Meter, Tolerances};
use replay::{Gains, Mode, Recording, Replay};
use schemas::log::LogReader;
use schemas::{Event, Header, Stamped};

use crate::cli::Common;
use crate::controller_choice::ControllerChoice;
use crate::{fleet, interrupt, logs};

/// A log under one controller, event by event.
enum Arm {
    /// Replayed.
    Replayed(Replay<BufReader<File>>),
    /// As it was recorded.
    Recorded(Box<LogReader<BufReader<File>>>),
}

impl Arm {
    fn new(log: &Log<'_>, choice: &ControllerChoice, mode: Mode) -> Result<Arm> {
        if *choice == ControllerChoice::Recorded {
            return Ok(Arm::Recorded(Box::new(logs::open_raw(log.path)?)));
        }
        let spec = choice.for_log(&log.header)?;
        Ok(Arm::Replayed(match (mode, &log.recording) {
            (Mode::Closed(person), Some(recording)) => {
                Replay::beside(logs::open_raw(log.path)?, recording, &spec, person)?
            }
            _ => Replay::new(|| logs::open_raw(log.path), &spec, mode)?,
        }))
    }

    fn next_event(&mut self) -> Result<Option<Stamped<Event>>> {
        if interrupt::pressed() {
            return Err(anyhow!("interrupted"));
        }
        match self {
            Arm::Replayed(replay) => Ok(replay.next_event()),
            Arm::Recorded(log) => Ok(log.next_event()?),
        }
    }

    /// Until when the recorded person is to be believed, where that is known; an error where the arm
    /// ended before its log should have.
    fn finish(self) -> Result<Option<f64>> {
        let Arm::Replayed(replay) = self else { return Ok(None) };
        let outcome = replay.finish()?;
        match outcome.damage {
            None => Ok(outcome.horizon.map(|h| h.first_s().unwrap_or(outcome.duration_s))),
            Some(damage) => Err(anyhow!(damage)),
        }
    }
}

/// Most logs that gains are pooled over; of more, evenly spread ones.
const MOST_POOLED: usize = 40;

/// Gains of the fitted person, pooled over the logs. A log that cannot be read, or holds nobody, has
/// no say; whoever replays it reports it.
pub fn gains(common: &Common, logs: &[PathBuf]) -> Gains {
    let every = logs.len().div_ceil(MOST_POOLED).max(1);
    let pool: Vec<&PathBuf> = logs.iter().step_by(every).collect();
    let read = fleet::each(common, &pool, "fitting", |log| {
        Ok(Arc::new(Recording::read(logs::open_raw(log)?)?))
    });
    let recordings: Vec<Arc<Recording>> = read.into_iter().filter_map(Result::ok).collect();
    Gains::pooled(&recordings)
}

/// A log to be replayed into both arms.
struct Log<'a> {
    path: &'a Path,
    header: Header,
    /// The person, for closed loop: read once for all arms and levels.
    recording: Option<Arc<Recording>>,
}

/// Both arms of one log, walked side by side: measured, and compared step by step; for each mode in
/// turn, the levels of the ladder.
pub fn pair(
    path: &Path,
    choices: (&ControllerChoice, &ControllerChoice),
    modes: &[Mode],
) -> Result<LogPair> {
    let header = logs::open(path)?.header().clone();
    let closed = modes.iter().any(|mode| matches!(mode, Mode::Closed(_)));
    // Whoever replays a log that cannot be read to its end reports that for each arm.
    let recording = closed.then(|| Recording::read(logs::open_raw(path)?)).transpose();
    let recording = recording.ok().flatten().map(Arc::new);
    let log = Log { path, header, recording };
    let levels = modes.iter().map(|mode| level(&log, choices, *mode)).collect();
    Ok(LogPair {
        log: path.display().to_string(),
        operator: log.header.run.operator.clone(),
        hash: logs::hash_file(path)?,
        recorded: if closed { recorded_by(&log, choices.0)? } else { None },
        scenario: Some(log.header.scenario),
        levels,
    })
}

/// What was recorded, where `choice` is the controller that recorded it.
fn recorded_by(log: &Log<'_>, choice: &ControllerChoice) -> Result<Option<Measured>> {
    let ControllerChoice::Version { .. } = choice else { return Ok(None) };
    let Ok(spec) = choice.for_log(&log.header) else { return Ok(None) };
    let params_hash = blake3::hash(spec.params_toml().as_bytes()).to_hex().to_string();
    let run = &log.header.run;
    let same = run.controller == spec.name && run.params_hash == params_hash;
    same.then(|| crate::command::metrics::measure(log.path)).transpose()
}

/// Both arms of one log in one mode.
fn level(log: &Log<'_>, (a, b): (&ControllerChoice, &ControllerChoice), mode: Mode) -> LevelPair {
    let mut level = LevelPair::failed("");
    if let Mode::Closed(person) = mode {
        person.name().clone_into(&mut level.human);
        level.estimates = person.is_estimate();
    }
    match (Arm::new(log, a, mode), Arm::new(log, b, mode)) {
        (Ok(a), Ok(b)) => {
            let (a, b, diff) = walk(&log.header, a, b);
            let horizons = [&a, &b].map(|arm| arm.as_ref().ok().and_then(|(_, horizon)| *horizon));
            level.horizon_s = horizons.into_iter().flatten().reduce(f64::min);
            let run = |arm: Walked| match arm {
                Ok((measured, _)) => Ok(measured),
                Err(error) => Err(format!("{error:#}")),
            };
            (level.a, level.b) = (run(a), run(b));
            level.diff = Some(diff.map_err(|error| format!("{error:#}")));
        }
        (a, b) => {
            // One arm that cannot run leaves nothing to compare the other with.
            let why = |arm: Result<Arm>| {
                Err(arm.err().map_or_else(
                    || "not run: the other arm failed".to_owned(),
                    |error| format!("{error:#}"),
                ))
            };
            (level.a, level.b) = (why(a), why(b));
        }
    }
    level
}

/// What one arm comes to: its metrics and its horizon.
type Walked = Result<(Measured, Option<f64>)>;

fn walk(header: &Header, a: Arm, b: Arm) -> (Walked, Walked, Result<Diff>) {
    let (a, b) = (Side::new(header, a), Side::new(header, b));
    let start = header.run.start;
    let diff = compare::diff::<anyhow::Error>(
        &Tolerances::exact(),
        (start, || Ok(a.next_event())),
        (start, || Ok(b.next_event())),
    );
    (a.finish(), b.finish(), diff)
}

/// An arm with its meter.
struct Side {
    arm: RefCell<Arm>,
    meter: RefCell<Meter>,
    failed: RefCell<Option<anyhow::Error>>,
}

impl Side {
    fn new(header: &Header, arm: Arm) -> Side {
        Side {
            arm: RefCell::new(arm),
            meter: RefCell::new(Meter::new(header)),
            failed: RefCell::new(None),
        }
    }

    /// The next event. A failure ends this side alone: the other is measured to its end.
    fn next_event(&self) -> Option<Stamped<Event>> {
        match self.arm.borrow_mut().next_event() {
            Ok(Some(event)) => {
                self.meter.borrow_mut().observe(&event);
                Some(event)
            }
            Ok(None) => None,
            Err(error) => {
                *self.failed.borrow_mut() = Some(error);
                None
            }
        }
    }

    fn finish(self) -> Walked {
        if let Some(error) = self.failed.into_inner() {
            return Err(error);
        }
        let arm = self.arm.into_inner();
        let horizon_s = arm.finish().context("only part of the log could be replayed")?;
        Ok((self.meter.into_inner().finish()?, horizon_s))
    }
}
