//! One session of the study: recorded with A, predicted for B, and really run with B.

use std::io::Cursor;
use std::sync::Arc;

use anyhow::Result;
use compare::{CATALOGUE, Meter};
use controller::{Law, Session, Spec};
use recorder::Simulated;
use replay::{Outcome, Person, PlantEstimate, Recording, Replay};
use schemas::log::{LogReader, LogWriter, WriterOptions};
use schemas::{Event, Header, Plant, Scenario, SensorSuite, Stamped};

/// The bytes of a log.
pub(crate) type Log = Cursor<Arc<[u8]>>;

/// Who was where, with what robot.
#[derive(Clone)]
pub(crate) struct Case {
    /// Room, task and person, with the plant that the log will claim.
    pub(crate) scenario: Scenario,
    /// The plant that there really is.
    pub(crate) plant: Plant,
    /// Noise seed.
    pub(crate) seed: u64,
    /// Sensors.
    pub(crate) sensors: SensorSuite,
}

/// A version of the controller with parameters of its own.
pub(crate) type Version = (&'static str, &'static [(&'static str, f64)]);

/// Controllers A and B.
pub(crate) type Pair = (Version, Version);

/// The version for a scenario.
pub(crate) fn spec(version: Version, scenario: &Scenario) -> Result<Spec> {
    let (name, settings) = version;
    let overrides: toml::Table =
        settings.iter().map(|(key, value)| ((*key).to_owned(), (*value).into())).collect();
    let law = controller::versions().iter().find(|v| v.name == name).map(|v| v.law);
    let of_scenario = match law {
        Some(Law::Dynamic) => &scenario.controller.dynamic,
        _ => &scenario.controller.kinematic,
    };
    Ok(Spec::resolve(name, &[of_scenario, &overrides])?)
}

/// What a run left behind for the metrics.
pub(crate) struct Run {
    header: Header,
    events: Vec<Stamped<Event>>,
}

impl Run {
    /// Every metric of the catalogue.
    pub(crate) fn metrics(&self) -> Vec<Option<f64>> {
        let mut meter = Meter::new(&self.header);
        self.events.iter().for_each(|event| meter.observe(event));
        match meter.finish() {
            Ok(measured) => measured.metrics.values().to_vec(),
            Err(_) => vec![None; CATALOGUE.len()],
        }
    }

    /// Mean distance between this run's robot and another's before an instant and from it on, metres;
    /// `None` for a part without length.
    pub(crate) fn apart(&self, other: &Run, cut_s: f64) -> [Option<f64>; 2] {
        let start = self.header.run.start;
        let poses = |run: &Run| -> Vec<(f64, [f64; 2])> {
            let pose = |event: &Stamped<Event>| match &event.value {
                Event::Truth(truth) => {
                    Some((truth.stamp.seconds_since(start), truth.pose.position_m()))
                }
                _ => None,
            };
            run.events.iter().filter_map(pose).collect()
        };
        let mut sums = [(0.0, 0.0); 2];
        for ((t_s, here), (_, there)) in poses(self).into_iter().zip(poses(other)) {
            let (sum_m, count) = &mut sums[usize::from(t_s >= cut_s)];
            *sum_m += (here[0] - there[0]).hypot(here[1] - there[1]);
            *count += 1.0;
        }
        sums.map(|(sum_m, count)| (count > 0.0).then(|| sum_m / count))
    }

    fn new(header: &Header) -> Run {
        Run { header: header.clone(), events: Vec::new() }
    }

    fn keep(&mut self, event: Stamped<Event>) {
        if matches!(event.value, Event::Truth(_) | Event::Step(_) | Event::Command(_)) {
            self.events.push(event);
        }
    }
}

/// Really runs the session; writes a log if asked to.
pub(crate) fn live(case: &Case, version: Version, log: bool) -> Result<(Run, Option<Arc<[u8]>>)> {
    let spec = spec(version, &case.scenario)?;
    let of = Simulated::of(spec, case.scenario.clone());
    let simulated = Simulated { plant: case.plant, sensors: case.sensors, seed: case.seed, ..of };
    let (simulation, runner) = simulated.begin()?;
    let header = simulated.header();
    let options = WriterOptions { view: false, ..WriterOptions::offline() };
    let mut writer = if log { Some(LogWriter::new(Vec::new(), &header, &options)?) } else { None };
    let mut session = Session::new(simulation, runner);
    let mut run = Run::new(&header);
    loop {
        let Ok(event) = session.next_event();
        let Some(event) = event else { break };
        if let Some(writer) = &mut writer {
            writer.write(&event)?;
        }
        run.keep(event);
    }
    let bytes = match writer {
        Some(writer) => Some(Arc::from(writer.finish()?.0)),
        None => None,
    };
    Ok((run, bytes))
}

/// What a log tells; on the plant that it claims, or on the one that it shows.
pub(crate) fn read(bytes: &Arc<[u8]>, identified: bool) -> Result<Arc<Recording>> {
    let open = || LogReader::new(Cursor::new(Arc::clone(bytes)));
    let recording = Recording::read(open()?)?;
    Ok(Arc::new(if identified {
        let claimed = recording.header().scenario.plant;
        recording.on_plant(PlantEstimate::of_log(open()?).applied_to(claimed))
    } else {
        recording
    }))
}

/// What replay says would have happened.
pub(crate) fn predicted(
    recording: &Arc<Recording>,
    spec: &Spec,
    person: Person,
) -> Result<(Run, Outcome)> {
    let mut replay: Replay<Log> = Replay::of_recording(recording, spec, person)?;
    let mut run = Run::new(recording.header());
    while let Some(event) = replay.next_event() {
        run.keep(event);
    }
    Ok((run, replay.finish()?))
}
