//! The sessions that a self-test is over: logs that are given, or sessions of its own.

use std::io::Cursor;
use std::path::PathBuf;
use std::sync::Arc;
use std::time::Duration;

use anyhow::{Context as _, Result};
use recorder::Simulated;
use replay::Recording;
use schemas::log::{LogReader, LogWriter, WriterOptions};
use schemas::{SensorSuite, Time};

use crate::arm::caught;
use crate::cli::Common;
use crate::command::record::scenario;
use crate::controller_choice::ControllerChoice;
use crate::fleet::watch;
use crate::{fleet, interrupt, logs};

/// Rooms and people, and how many sessions of each.
const KINDS: [&str; 6] =
    ["rect:goal", "rect:joystick", "slant:goal", "slant:joystick", "disc:goal", "disc:joystick"];
const OF_EACH_KIND: u32 = 4;

/// A session, with the person in it.
#[derive(Clone)]
pub struct Session {
    /// Its name in reports.
    pub name: String,
    /// BLAKE3 of its file; empty for a session of our own.
    pub hash: String,
    /// The person.
    pub recording: Arc<Recording>,
}

impl Session {
    /// When it began.
    pub fn start(&self) -> Time {
        self.recording.header().run.start
    }
}

/// The logs that are given.
pub fn of_logs(common: &Common, paths: &[PathBuf]) -> Result<Vec<Session>> {
    fleet::each(common, paths, "reading", |path| {
        let name = || path.display().to_string();
        let recording = Recording::read(logs::open(path)?).with_context(name)?;
        Ok(Session { name: name(), hash: logs::hash_file(path)?, recording: Arc::new(recording) })
    })
    .into_iter()
    .collect()
}

/// Sessions of our own: random rooms with sixteen faulty sonars, recorded with the controller that is
/// tested. Each has a seed of its own: with one for all they would share their noise.
pub fn built_in(
    common: &Common,
    controller: &ControllerChoice,
    hang_after: Duration,
) -> Result<Vec<Session>> {
    let mut names = Vec::new();
    for kind in KINDS {
        names.extend((1..=OF_EACH_KIND).map(|number| format!("random:{kind}:{number}")));
    }
    let numbered: Vec<(u64, String)> = (1..).zip(names).collect();
    let controller = controller.clone();
    let work = move |(seed, name): &(u64, String)| record(name, *seed, &controller);
    watch::each(common, numbered, "recording", hang_after, work).into_iter().collect()
}

/// Records a session into memory.
fn record(name: &str, seed: u64, controller: &ControllerChoice) -> Result<Session> {
    let scenario = scenario(name)?;
    let spec = controller.for_scenario(&scenario)?;
    let simulated =
        Simulated { sensors: SensorSuite::Sonar, seed, ..Simulated::of(spec, scenario) };
    let (simulation, runner) = caught(|| simulated.begin())??;
    let run = simulated.header().run;
    let Simulated { spec, scenario, .. } = simulated;
    let header = logs::header(&spec, scenario, run.start, runner.control_period(), run);
    let options = WriterOptions { view: false, ..WriterOptions::offline() };
    let mut log = LogWriter::new(Vec::new(), &header, &options)?;
    let mut session = controller::Session::new(simulation, runner);
    loop {
        interrupt::check()?;
        let Ok(event) = caught(|| session.next_event())?;
        let Some(event) = event else { break };
        log.write(&event)?;
    }
    let (bytes, _) = log.finish()?;
    let recording = Recording::read(LogReader::new(Cursor::new(bytes))?)?;
    Ok(Session { name: name.to_owned(), hash: String::new(), recording: Arc::new(recording) })
}
