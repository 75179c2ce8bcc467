//! Contract of replay: with the recording controller, the recorded person played back and the recorded
//! seed, a session comes back bit for bit, in open and in closed loop, whoever drove, whatever the
//! sensors got wrong, and on whichever thread.

use std::sync::atomic::{AtomicUsize, Ordering};
use std::sync::{Arc, Mutex};

use schemas::{GyroBiasStep, Noise, Scenario, SensorSuite, SlipBurst};

use crate::session::{record_seeded, scenario};
use crate::{Mode, Person, Recording, Replay};

const SESSIONS: usize = 50;
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
fn session(number: usize) -> (Scenario, &'static str, SensorSuite) {
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
