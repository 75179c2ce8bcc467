//! Sessions recorded in memory, for tests.

use std::io::Cursor;

use controller::{Session, Spec};
use recorder::Simulated;
use schemas::log::{LogReader, LogWriter, WriterOptions};
use schemas::{Event, Gap, Header, Scenario, SensorSuite, Stamped};

use crate::fault::Faulty;

/// A session recorded with one controller.
pub(crate) struct Recorded {
    pub(crate) bytes: Vec<u8>,
    pub(crate) spec: Spec,
    pub(crate) events: Vec<Stamped<Event>>,
}

impl Recorded {
    pub(crate) fn open(&self) -> LogReader<Cursor<Vec<u8>>> {
        LogReader::new(Cursor::new(self.bytes.clone())).expect("a log that was just written opens")
    }

    /// The same events under a head that claims another scenario.
    pub(crate) fn rewrite(&mut self, scenario: &Scenario) {
        let header = Header { scenario: scenario.clone(), ..self.open().header().clone() };
        let options = WriterOptions { view: false, ..WriterOptions::offline() };
        let mut log = LogWriter::new(Vec::new(), &header, &options).expect("memory takes it");
        for event in &self.events {
            log.write(event).expect("memory takes it");
        }
        (self.bytes, _) = log.finish().expect("memory takes it");
    }
}

/// The scenario of a name, `seconds` long.
pub(crate) fn scenario(name: &str, seconds: f64) -> Scenario {
    Scenario { duration_s: seconds, ..simulator::scenario(name).expect("a known scenario") }
}

/// A version with the scenario's own parameters.
pub(crate) fn spec(name: &str, scenario: &Scenario) -> Spec {
    Spec::for_scenario(name, scenario, &[]).expect("a known version")
}

/// Records a session.
pub(crate) fn record(scenario: &Scenario, controller: &str, sensors: SensorSuite) -> Recorded {
    record_seeded(scenario, controller, sensors, 5)
}

/// The same with a seed of one's own.
pub(crate) fn record_seeded(
    scenario: &Scenario,
    controller: &str,
    sensors: SensorSuite,
    seed: u64,
) -> Recorded {
    record_with_gaps(scenario, controller, sensors, seed, &[])
}

/// The same with streams that fall silent, which the log notes at its end.
pub(crate) fn record_with_gaps(
    scenario: &Scenario,
    controller: &str,
    sensors: SensorSuite,
    seed: u64,
    gaps: &[Gap],
) -> Recorded {
    let spec = spec(controller, scenario);
    let simulated = Simulated { sensors, seed, ..Simulated::of(spec.clone(), scenario.clone()) };
    let (simulation, runner) = simulated.begin().expect("a sound scenario");
    let mut header = simulated.header();
    // Under some drivers' names every estimate of the person is a playback: here it is the estimates that are
    // to be tested, with whatever joystick.
    "somebody".clone_into(&mut header.run.driver);
    let start = header.run.start;
    let options = WriterOptions { view: false, ..WriterOptions::offline() };
    let mut log = LogWriter::new(Vec::new(), &header, &options).expect("memory takes it");
    let mut source = Faulty::new(simulation, start);
    source.silence(gaps);
    let mut session = Session::new(source, runner);
    let mut events = Vec::new();
    loop {
        let Ok(event) = session.next_event();
        let Some(event) = event else { break };
        log.write(&event).expect("memory takes it");
        events.push(event);
    }
    for gap in gaps {
        let at = events.last().map_or(start, |event| event.at).after_ns(1);
        let event = Stamped { at, value: Event::Gap(gap.clone()) };
        log.write(&event).expect("memory takes it");
        events.push(event);
    }
    let (bytes, _) = log.finish().expect("memory takes it");
    Recorded { bytes, spec, events }
}

/// Whether two runs are the same, one not-a-number being like another.
pub(crate) fn same(a: &[Stamped<Event>], b: &[Stamped<Event>]) -> bool {
    a.len() == b.len() && a.iter().zip(b).all(|(a, b)| format!("{a:?}") == format!("{b:?}"))
}
