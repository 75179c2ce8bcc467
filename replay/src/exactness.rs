//! Contract of replay: with the recording controller, the recorded person played back and the recorded
//! seed, a session comes back bit for bit, in open and in closed loop, whoever drove, whatever the
//! sensors got wrong, and on whichever thread.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use schemas::{
    Event, Gap, GyroBiasStep, Noise, Sample, Scenario, SensorSuite, SlipBurst, Span, Step,
};

use crate::session::{record_seeded, record_with_gaps, scenario};
use crate::{Mode, Person, Recording, Replay};

pub(crate) const SESSIONS: usize = 50;
const KINDS: [&str; 3] = ["rect", "slant", "disc"];
const DRIVERS: [&str; 6] = ["goal", "joystick", "hesitant", "flowing", "explorer", "tracker"];
const CONTROLLERS: [&str; 5] =
    ["tandem-kinematic", "tandem-dynamic", "paper-kinematic", "paper-dynamic", "human"];

/// What the sensors of a session get wrong beyond their usual noise: each in turn, and nothing.
fn fail(noise: &mut Noise, number: usize) {
    match number % 7 {
        0 => {
            let imu = noise.imu.as_mut().expect("random rooms have one");
            imu.gyro_bias_step = Some(GyroBiasStep { at_s: 1.5, by_radps: 0.2 });
        }
        1 => {
            let encoders = noise.encoders.as_mut().expect("random rooms have them");
            encoders.slip_burst = Some(SlipBurst { from_s: 1.0, until_s: 2.0, slip: 0.6 });
        }
        2 => noise.encoders.as_mut().expect("random rooms have them").left_dead_from_s = Some(2.0),
        3 => {
            let sonar = noise.sonar.as_mut().expect("random rooms have them");
            (sonar.dropout, sonar.cross_talk) = (0.4, 0.2);
        }
        4 => *noise = Noise::default(),
        _ => {}
    }
}

/// One of them: room, person, controller and fault go round at paces that have no factor in common,
/// so that they meet in ever new ways.
pub(crate) fn session(number: usize) -> (Scenario, &'static str, SensorSuite) {
    let (kind, driver) = (KINDS[number % 3], DRIVERS[number / 3 % 6]);
    let mut scenario = scenario(&format!("random:{kind}:{driver}:{}", 500 + number), 4.0);
    fail(&mut scenario.noise, number);
    // With a slow actuator now and then.
    scenario.plant.actuator_delay_s = if number % 4 == 1 { 0.1 } else { 0.0 };
    scenario.plant.limits_acceleration = number % 4 == 2;
    let sensors = if number % 8 == 7 { SensorSuite::Exact } else { SensorSuite::Sonar };
    (scenario, CONTROLLERS[number % 5], sensors)
}

/// The hashes of a session's replays, which are those of the recording.
fn replayed(number: usize) -> [String; 2] {
    let (scenario, controller, sensors) = session(number);
    let log = record_seeded(&scenario, controller, sensors, number as u64);
    let what = format!("{number}: {} with {controller}", scenario.name);
    let open = Replay::new(|| Ok(log.open()), &log.spec, Mode::Open).expect("replays");
    let recording = Arc::new(Recording::read(log.open()).expect("somebody drove"));
    let closed = Replay::beside(log.open(), &recording, &log.spec, Person::Playback);
    [(open, "open"), (closed.expect("replays"), "closed")].map(|(mut replay, mode)| {
        let mut events = 0;
        while replay.next_event().is_some() {
            events += 1;
        }
        assert_eq!(events, log.events.len(), "{mode} {what}");
        let outcome = replay.finish().expect("has steps");
        assert!(outcome.identical_to_recorded, "{mode} {what}: {:?}", outcome.max_deviation);
        assert_eq!(outcome.output_hash, outcome.recorded_hash, "{mode} {what}");
        let steps = libm::round(4.0 / log.spec.params.control_period_s) as u64 + 1;
        assert_eq!(outcome.steps, steps, "{mode} {what}");
        outcome.output_hash
    })
}

fn on_threads(threads: usize) -> Vec<[String; 2]> {
    let next = AtomicUsize::new(0);
    let hashes = Mutex::new(vec![Default::default(); SESSIONS]);
    std::thread::scope(|scope| {
        for _ in 0..threads {
            scope.spawn(|| {
                loop {
                    let number = next.fetch_add(1, Ordering::Relaxed);
                    if number >= SESSIONS {
                        break;
                    }
                    let hash = replayed(number);
                    hashes.lock().expect("who panics ends the test")[number] = hash;
                }
            });
        }
    });
    hashes.into_inner().expect("nobody panicked")
}

#[test]
fn fifty_random_sessions_come_back() {
    let alone = on_threads(1);
    assert!(alone.iter().flatten().all(|hash| hash.len() == 64));
    assert_eq!(on_threads(2), alone);
    // They are fifty sessions, not one fifty times.
    let mut different: Vec<&String> = alone.iter().map(|[_, closed]| closed).collect();
    different.sort();
    different.dedup();
    assert_eq!(different.len(), SESSIONS);
}

/// A log from before a field was recorded comes back bit for bit in all that it has; a log that has the
/// field comes back in that as well.
#[test]
fn a_recording_from_before_a_field_comes_back() {
    let scenario = scenario("random:rect:joystick:602", 3.0);
    let log = record_seeded(&scenario, "tandem-kinematic", SensorSuite::Sonar, 4);
    let steps = |change: fn(&mut Step)| {
        let mut log = record_seeded(&scenario, "tandem-kinematic", SensorSuite::Sonar, 4);
        for event in &mut log.events {
            if let Event::Step(step) = &mut event.value {
                change(step);
            }
        }
        log.rewrite(&scenario);
        log
    };
    let old = steps(|step| (step.sonars_unknown, step.safety_clear_m) = (None, None));
    assert_ne!(old.bytes, log.bytes);
    let other = steps(|step| step.sonars_unknown = step.sonars_unknown.map(|n| n + 1));
    for mode in [Mode::Open, Mode::Closed(Person::Playback)] {
        for (log, identical) in [(&old, true), (&other, false)] {
            let mut replay = Replay::new(|| Ok(log.open()), &log.spec, mode).expect("replays");
            while replay.next_event().is_some() {}
            let outcome = replay.finish().expect("has steps");
            assert_eq!(outcome.identical_to_recorded, identical, "{mode:?}");
            assert_eq!(outcome.max_deviation, None, "{mode:?}");
        }
    }
}

/// A recording that has a field, but for one step of it, or that has it in one step only, is not from before the
/// field: it differs there, under the field's name, and its hash is another one.
#[test]
fn a_recording_that_lost_a_field_differs() {
    let scenario = scenario("random:rect:joystick:602", 3.0);
    let whole = record_seeded(&scenario, "tandem-kinematic", SensorSuite::Sonar, 4);
    let count = whole.events.iter().filter(|event| matches!(event.value, Event::Step(_))).count();
    let lost = |lost: &dyn Fn(usize) -> bool| {
        let mut log = record_seeded(&scenario, "tandem-kinematic", SensorSuite::Sonar, 4);
        let steps = log.events.iter_mut().filter_map(|event| match &mut event.value {
            Event::Step(step) => Some(step),
            _ => None,
        });
        steps.enumerate().filter(|(n, _)| lost(*n)).for_each(|(_, s)| s.safety_clear_m = None);
        log.rewrite(&scenario);
        log
    };
    for mode in [Mode::Open, Mode::Closed(Person::Playback)] {
        let outcome = |log: &crate::session::Recorded| {
            let mut replay = Replay::new(|| Ok(log.open()), &log.spec, mode).expect("replays");
            while replay.next_event().is_some() {}
            replay.finish().expect("has steps")
        };
        let all = outcome(&whole);
        for (which, at_s) in [
            (lost(&|n| n == 0), 0.0),
            (lost(&|n| n == 7), 0.7),
            (lost(&|n| n + 1 == count), 3.0),
            (lost(&|n| n != 7), 0.0),
        ] {
            let outcome = outcome(&which);
            assert!(!outcome.identical_to_recorded, "{mode:?} {at_s}");
            assert_ne!(outcome.output_hash, outcome.recorded_hash, "{mode:?} {at_s}");
            // What was replayed is the same, whatever the recording lost.
            assert_eq!(outcome.output_hash, all.output_hash, "{mode:?} {at_s}");
            let most = outcome.max_deviation.expect("something differs");
            assert_eq!((most.field, most.amount), ("safety_clear_m", f64::INFINITY));
            assert!((most.t_s - at_s).abs() < 1e-9, "{mode:?} {at_s}: {most:?}");
        }
        // A controller that has nothing of the kind says something else, and no field of it is lost.
        let paper = crate::session::spec("paper-kinematic", &scenario);
        let mut replay = Replay::new(|| Ok(whole.open()), &paper, mode).expect("replays");
        while replay.next_event().is_some() {}
        let outcome = replay.finish().expect("has steps");
        assert!(!outcome.identical_to_recorded);
        assert_ne!(outcome.max_deviation.expect("it says something else").field, "safety_clear_m");
    }
}

/// Streams that were silent while a session was recorded, and noted as such, are silent in its closed
/// loop too: with the recording controller it is the recording; without the note it is not.
#[test]
fn gaps_are_met_again() {
    let scenario = scenario("random:slant:flowing:601", 5.0);
    let at = |seconds| schemas::SIMULATION_EPOCH + Span::from_seconds(seconds);
    let gap = |stream: &str, from_s, to_s| Gap {
        stamp: at(to_s),
        stream: stream.to_owned(),
        start: at(from_s),
        end: at(to_s),
        cause: "unplugged".to_owned(),
    };
    let gaps = [gap("/sonar", 1.0, 2.5), gap("/encoders", 2.0, 2.4), gap("/joystick", 3.0, 3.5)];
    let log = record_with_gaps(&scenario, "tandem-kinematic", SensorSuite::Sonar, 3, &gaps);
    let silent = log.events.iter().filter(|event| {
        let Event::Sample(sample) = &event.value else { return false };
        let inside = |from_s, to_s| at(from_s) < sample.stamp() && sample.stamp() < at(to_s);
        match sample {
            Sample::Sonar(_) => inside(1.0, 2.5),
            Sample::Encoders(_) => inside(2.0, 2.4),
            Sample::Joystick(_) => inside(3.0, 3.5),
            _ => false,
        }
    });
    assert_eq!(silent.count(), 0);
    for mode in [Mode::Open, Mode::Closed(Person::Playback)] {
        let mut replay = Replay::new(|| Ok(log.open()), &log.spec, mode).expect("replays");
        while replay.next_event().is_some() {}
        let outcome = replay.finish().expect("has steps");
        assert!(outcome.identical_to_recorded, "{mode:?}: {:?}", outcome.max_deviation);
    }
    let mut untold = log;
    untold.events.retain(|event| !matches!(event.value, Event::Gap(_)));
    untold.rewrite(&scenario);
    let mode = Mode::Closed(Person::Playback);
    let mut replay = Replay::new(|| Ok(untold.open()), &untold.spec, mode).expect("replays");
    while replay.next_event().is_some() {}
    assert!(!replay.finish().expect("has steps").identical_to_recorded);
}
