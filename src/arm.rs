//! One arm of a comparison: a log under one controller.

mod plant;
mod side;

use std::collections::{BTreeMap, BTreeSet};
use std::fs::File;
use std::io::BufReader;
use std::panic::{self, AssertUnwindSafe};
use std::path::{Path, PathBuf};
use std::sync::Arc;

use anyhow::{Result, anyhow};
use compare::{CATALOGUE, Diff, LevelPair, LogPair, Measured, Meter, Tolerances};
use controller::{Runner, Spec};
use plant::PlantWords;
pub use plant::{DrivenPlant, driven};
use replay::{Faults, Gains, Mode, Person, Recording, Replay};
use schemas::log::LogReader;
use schemas::{Event, Header, Stamped, Time};
use side::Side;

use crate::cli::Common;
use crate::command::replay::{PlantName, replay_header};
use crate::controller_choice::ControllerChoice;
use crate::fleet::watch;
use crate::{faults, fleet, interrupt, logs, side_by_side};

/// A log under one controller, event by event.
enum Arm {
    /// Replayed.
    Replayed(Replay<BufReader<File>>),
    /// As it was recorded.
    Recorded(Box<LogReader<BufReader<File>>>),
}

impl Arm {
    fn next_event(&mut self) -> Result<Option<Stamped<Event>>> {
        interrupt::check()?;
        match self {
            // What a controller does to itself is the result of its own arm.
            Arm::Replayed(replay) => caught(|| replay.next_event()),
            Arm::Recorded(log) => Ok(log.next_event()?),
        }
    }

    /// Ends the arm: why it ended before its log should have, where it did, and which faults met nothing.
    fn finish(self, unmet: &mut BTreeSet<String>) -> Result<()> {
        let Arm::Replayed(replay) = self else { return Ok(()) };
        let outcome = replay.finish()?;
        unmet.extend(outcome.unmet_faults.iter().map(faults::unmet));
        match outcome.damage {
            None => Ok(()),
            Some(damage) => Err(anyhow!(damage)),
        }
    }
}

/// Both arms of a log, over one reading of it where both are replayed.
fn arms(
    log: &Log<'_>,
    choices: [&ControllerChoice; 2],
    mode: Mode,
    faults: &Faults,
) -> [Result<Arm>; 2] {
    let specs = choices.map(|choice| match choice {
        ControllerChoice::Recorded => Ok(None),
        version @ ControllerChoice::Version { .. } => {
            let spec = version.for_log(&log.header)?;
            made(&log.header, &spec)?;
            anyhow::Ok(Some(spec))
        }
    });
    let replayed = |replay: Replay<BufReader<File>>| Arm::Replayed(replay.under(faults.clone()));
    if let (Mode::Open, [Ok(Some(a)), Ok(Some(b))]) = (mode, &specs) {
        let shared = logs::open_raw(log.path)
            .map(|reader| Replay::side_by_side(reader, &[a.clone(), b.clone()]));
        if let Ok(Ok([a, b])) = shared.map(<[_; 2]>::try_from) {
            return [a, b].map(|replay| Ok(replayed(replay?)));
        }
    }
    specs.map(|spec| {
        let Some(spec) = spec? else {
            return Ok(Arm::Recorded(Box::new(logs::open_raw(log.path)?)));
        };
        Ok(replayed(match (mode, &log.recording) {
            (Mode::Closed(person), Some(recording)) => {
                Replay::of_recording(recording, &spec, person)?
            }
            _ => Replay::new(|| logs::open_raw(log.path), &spec, mode)?,
        }))
    })
}

/// Makes a controller for a log and throws it away: what breaks in the making breaks here, where it is
/// caught and watched. Reading the log and its person, which may take its time, is not the controller's.
pub fn made(header: &Header, spec: &Spec) -> Result<()> {
    let setup = replay::setup(header, spec)?;
    caught(|| Runner::new(&setup).map(drop))??;
    Ok(())
}

/// Runs what may be somebody else's code: a panic becomes an error that says so, and whoever watches
/// this thread knows that it is in there.
pub fn caught<T>(work: impl FnOnce() -> T) -> Result<T> {
    let inside = watch::enter();
    let done = panic::catch_unwind(AssertUnwindSafe(work));
    drop(inside);
    if watch::is_given_up() {
        return Err(anyhow!("the controller answered when it had long been given up"));
    }
    done.map_err(|payload| {
        let said = payload
            .downcast_ref::<&str>()
            .map(|text| (*text).to_owned())
            .or_else(|| payload.downcast_ref::<String>().cloned());
        anyhow!("the controller panicked: {}", said.as_deref().unwrap_or("it did not say why"))
    })
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

/// The plant-gap floor of a log: how far each metric of the recording controller's closed-loop replay
/// is from the recorded one. No change below it counts as real. 0 where plant and person are exact.
pub fn floor(
    log: &Path,
    recording: &Arc<Recording>,
    person: Person,
) -> Result<BTreeMap<&'static str, f64>> {
    let header = recording.header();
    let spec = ControllerChoice::Recorded.for_log(header)?;
    made(header, &spec)?;
    let mut simulated = Meter::new(header);
    let mut replay: Replay<BufReader<File>> = Replay::of_recording(recording, &spec, person)?;
    while let Some(event) = caught(|| replay.next_event())? {
        interrupt::check()?;
        simulated.observe(&event);
    }
    let mut recorded = Meter::new(header);
    let mut events = logs::open_raw(log)?;
    while let Some(event) = events.next_event()? {
        recorded.observe(&event);
    }
    let (simulated, recorded) = (simulated.finish()?.metrics, recorded.finish()?.metrics);
    let gaps = CATALOGUE.iter().filter_map(|metric| {
        let gap = simulated.get(metric.name)? - recorded.get(metric.name)?;
        Some((metric.name, gap.abs()))
    });
    Ok(gaps.collect())
}

/// A log to be replayed into both arms.
struct Log<'a> {
    path: &'a Path,
    header: Header,
    /// The person, for closed loop: read once for all arms and levels.
    recording: Option<Arc<Recording>>,
    /// What there is to be said of the plant that is driven.
    plant: PlantWords,
}

impl<'a> Log<'a> {
    fn read(path: &'a Path, modes: &[Mode], plant: PlantName) -> Result<Log<'a>> {
        let header = logs::open(path)?.header().clone();
        let closed = modes.iter().any(|mode| matches!(mode, Mode::Closed(_)));
        // Whoever replays a log that cannot be read to its end reports that for each arm.
        let recording = closed.then(|| Recording::read(logs::open_raw(path)?)).transpose();
        let (recording, plant) = match recording {
            Ok(None) => (None, PlantWords::default()),
            Ok(Some(recording)) => {
                let (recording, plant) = driven(path, recording, plant)?;
                (Some(Arc::new(recording)), PlantWords::of(&plant))
            }
            // What is not driven is not tested either.
            Err(error) => (None, PlantWords { doubt: None, untold: Some(error.to_string()) }),
        };
        Ok(Log { path, header, recording, plant })
    }
}

/// Both arms of one log, walked side by side: measured, and compared step by step; for each mode in
/// turn, the levels of the ladder. Both under the same faults.
pub fn pair(
    path: &Path,
    choices: (&ControllerChoice, &ControllerChoice),
    modes: &[Mode],
    faults: &Faults,
    plant: PlantName,
) -> Result<LogPair> {
    let log = Log::read(path, modes, plant)?;
    let mut unmet = BTreeSet::new();
    let levels = modes.iter().map(|mode| level(&log, choices, *mode, faults, &mut unmet)).collect();
    Ok(LogPair {
        log: path.display().to_string(),
        operator: log.header.run.operator.clone(),
        hash: logs::hash_file(path)?,
        recorded: if log.recording.is_some() { recorded_by(&log, choices.0)? } else { None },
        plant_doubt: log.plant.doubt,
        plant_untold: log.plant.untold,
        unmet_faults: unmet.into_iter().collect(),
        scenario: Some(log.header.scenario),
        levels,
    })
}

/// Both arms of one log in one mode, side by side in a log of their own.
pub fn write_side_by_side(
    path: &Path,
    choices: [&ControllerChoice; 2],
    (mode, faults, plant): (Mode, &Faults, PlantName),
    output: &Path,
) -> Result<()> {
    let log = Log::read(path, &[mode], plant)?;
    let hash = logs::hash_file(path)?;
    let header = |choice: &ControllerChoice| match choice {
        ControllerChoice::Recorded => Ok(log.header.clone()),
        version @ ControllerChoice::Version { .. } => {
            let spec = version.for_log(&log.header)?;
            anyhow::Ok(replay_header(&log.header, &spec, mode, hash.clone()))
        }
    };
    let headers = [header(choices[0])?, header(choices[1])?];
    let [a, b] = arms(&log, choices, mode, faults);
    let (mut a, mut b) = (a?, b?);
    let headers = [&headers[0], &headers[1]];
    // Who is stopped here fails, and leaves no file.
    side_by_side::write(output, headers, || a.next_event(), || b.next_event(), || None)
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
fn level(
    log: &Log<'_>,
    choices: (&ControllerChoice, &ControllerChoice),
    mode: Mode,
    faults: &Faults,
    unmet: &mut BTreeSet<String>,
) -> LevelPair {
    let mut level = LevelPair::failed("");
    if let Mode::Closed(person) = mode {
        person.name().clone_into(&mut level.human);
        level.estimates = person.is_estimate();
    }
    match arms(log, [choices.0, choices.1], mode, faults) {
        [Ok(a), Ok(b)] => {
            let a = Side::new(&log.header, choices.0, a, None);
            let b = Side::new(&log.header, choices.1, b, Some(&a));
            let sides = [a, b];
            let (a, b, diff, horizon_s) = walk(log.header.run.start, sides, unmet);
            level.horizon_s = horizon_s;
            let text = |result: Result<Measured>| result.map_err(|error| format!("{error:#}"));
            (level.a, level.b) = (text(a), text(b));
            level.diff = Some(diff.map_err(|error| format!("{error:#}")));
        }
        [a, b] => {
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

fn walk(
    start: Time,
    [a, b]: [Side; 2],
    unmet: &mut BTreeSet<String>,
) -> (Result<Measured>, Result<Measured>, Result<Diff>, Option<f64>) {
    let diff = compare::diff::<anyhow::Error, _>(
        &Tolerances::exact(),
        (start, || Ok(a.next_event())),
        (start, || Ok(b.next_event())),
    );
    let horizon_s = [a.horizon_s(), b.horizon_s()].into_iter().flatten().min_by(f64::total_cmp);
    (a.finish(unmet), b.finish(unmet), diff, horizon_s)
}

#[cfg(test)]
mod tests {
    use super::*;
    use recorder::Simulated;
    use schemas::log::{LogWriter, WriterOptions};

    /// Of a log with nobody to bring back in closed loop it is not said that its plant was tested; in open loop
    /// nobody asks.
    #[test]
    fn a_log_without_a_person_says_nothing_of_its_plant() {
        let scenario = simulator::scenario("case1").unwrap();
        let spec = Spec::for_scenario("human", &scenario, &[]).unwrap();
        let header = Simulated::of(spec, scenario).header();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("nobody.mcap");
        let log = LogWriter::new(Vec::new(), &header, &WriterOptions::offline()).unwrap();
        std::fs::write(&path, log.finish().unwrap().0).unwrap();
        for plant in [PlantName::Recorded, PlantName::Identified] {
            let words = |mode| Log::read(&path, &[mode], plant).unwrap().plant;
            let closed = words(Mode::Closed(Person::Playback));
            assert!(closed.doubt.is_none());
            assert!(closed.untold.is_some_and(|why| why.contains("no /joystick")));
            assert!(words(Mode::Open).untold.is_none());
        }
    }

    #[test]
    fn a_panic_is_an_error_that_says_why() {
        assert_eq!(caught(|| 3).unwrap(), 3);
        let error = caught(|| -> u8 { panic!("gain {} is no gain", -1) }).unwrap_err();
        assert_eq!(error.to_string(), "the controller panicked: gain -1 is no gain");
    }
}
