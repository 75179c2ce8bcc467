use super::*;
use crate::{driver, scenario};
use schemas::{Footprint, SIMULATION_EPOCH, Twist};

const TENTH: Span = Span(100_000_000);
const FIFTIETH: Span = Span(20_000_000);

fn setup(
    name: &str,
    sensors: SensorSuite,
    control_period: Span,
    duration_s: f64,
) -> SimulationSetup {
    SimulationSetup {
        scenario: scenario(name).expect("known"),
        sensors,
        seed: 4,
        start: SIMULATION_EPOCH,
        control_period,
        duration: Span::from_seconds(duration_s),
    }
}

fn start(setup: SimulationSetup) -> Simulation {
    let human = driver(&setup.scenario, setup.scenario.driver, setup.seed).expect("it can drive");
    Simulation::new(setup, human).expect("a sound setup")
}

/// What a session consists of, with `None` for a step; commands are what `answer` makes of the last
/// joystick.
fn run(
    mut simulation: Simulation,
    mut answer: impl FnMut(&JoystickSample) -> Twist,
) -> Vec<(Time, Option<Event>)> {
    let mut events = Vec::new();
    let mut joystick = JoystickSample::default();
    while let Some(pulled) = simulation.pull().unwrap_or_else(|never| match never {}) {
        match pulled {
            Pulled::Event(stamped) => {
                if let Event::Sample(Sample::Joystick(sample)) = &stamped.value {
                    joystick = *sample;
                }
                events.push((stamped.at, Some(stamped.value)));
            }
            Pulled::StepDue { at, now } => {
                let twist = answer(&joystick);
                simulation.actuate(&Command { stamp: now, twist, accel: None });
                events.push((at, None));
            }
        }
    }
    events
}

fn obey(joystick: &JoystickSample) -> Twist {
    Twist { v_mps: joystick.v_mps, omega_radps: joystick.omega_radps }
}

fn rank(event: Option<&Event>) -> usize {
    match event {
        Some(Event::Sample(Sample::Sonar(_))) => 0,
        Some(Event::Sample(Sample::Imu(_))) => 1,
        Some(Event::Sample(Sample::Encoders(_))) => 2,
        Some(Event::Sample(Sample::Exact(_))) => 3,
        Some(Event::Sample(Sample::Joystick(_))) => 4,
        Some(Event::Truth(_)) => 5,
        None => 6,
        other => panic!("a simulation does not produce {other:?}"),
    }
}

/// Rates of specification §10 and the order at equal instants: over exactly one second, with both
/// ends, 25 Hz makes 26 events, and every log time is its instant plus its rank.
#[test]
fn streams_have_their_rates_and_ranks() {
    for (sensors, counts) in [
        (SensorSuite::Sonar, [26, 101, 51, 0, 51, 51, 11]),
        (SensorSuite::Exact, [0, 0, 0, 11, 51, 51, 11]),
    ] {
        let events = run(start(setup("case1-lab", sensors, TENTH, 1.0)), obey);
        let periods_ns: [u64; 7] =
            [40_000_000, 10_000_000, 20_000_000, 100_000_000, 20_000_000, 20_000_000, 100_000_000];
        let mut seen = [0_u64; 7];
        for (at, event) in &events {
            let rank = rank(event.as_ref());
            let instant_ns = seen[rank] * periods_ns[rank];
            assert_eq!(*at, SIMULATION_EPOCH.after_ns(instant_ns + rank as u64));
            match event {
                Some(Event::Sample(sample)) => {
                    assert_eq!(sample.stamp(), SIMULATION_EPOCH.after_ns(instant_ns));
                }
                Some(Event::Truth(truth)) => {
                    assert_eq!(truth.stamp, SIMULATION_EPOCH.after_ns(instant_ns));
                }
                _ => {}
            }
            seen[rank] += 1;
        }
        assert_eq!(seen, counts);
        assert!(events.windows(2).all(|pair| pair[0].0 < pair[1].0));
    }
}

/// Log times increase strictly, with room for the command after each step, even where the control
/// period makes instants that are nanoseconds apart.
#[test]
fn log_times_increase_strictly_whatever_the_control_period() {
    for period_ns in [1_000, 9_999_999, 10_000_001, 20_000_001, 33_333_333] {
        let duration_s = if period_ns < 1_000_000 { 0.05 } else { 3.0 };
        let setup = setup("case1-lab", SensorSuite::Sonar, Span(period_ns), duration_s);
        let mut least = SIMULATION_EPOCH;
        for (at, event) in run(start(setup), obey) {
            assert!(at >= least, "{period_ns}");
            least = at.after_ns(if event.is_none() { 2 } else { 1 });
        }
    }
}

#[test]
fn refuses_what_it_cannot_simulate() {
    let refuse = |setup: SimulationSetup| {
        let human = driver(&setup.scenario, schemas::Driver::Joystick, 0).expect("anyone can");
        Simulation::new(setup, human).err().map(|error| error.to_string()).expect("refused")
    };
    let good = setup("case1", SensorSuite::Exact, TENTH, 1.0);
    let error = refuse(SimulationSetup { control_period: Span(0), ..good.clone() });
    assert!(error.contains("got 0 ns"), "{error}");
    let mut bad = good.clone();
    bad.scenario.world.room[0].normal = [2.0, 0.0];
    assert!(refuse(bad).contains("world.room[0] normal"));
    let case3 = scenario("case3").expect("known");
    assert!(driver(&case3, schemas::Driver::Goal, 0).is_err());
    assert!(driver(&good.scenario, schemas::Driver::Script, 0).is_err());
}

/// The truth tells the clearance of the footprint: at the start of Case I, 0.2 m from the left wall
/// for the point robot, 0.5 m less the turned body's reach for the other.
#[test]
fn truth_tells_the_clearance_of_the_footprint() {
    for (name, wanted_m) in
        [("case1", 0.2), ("case1-lab", 0.5 - 0.25 * (libm::sin(0.5811) + libm::cos(0.5811)))]
    {
        let setup = setup(name, SensorSuite::Exact, TENTH, 0.0);
        assert_eq!(setup.scenario.robot.footprint == Footprint::POINT, name == "case1");
        let events = run(start(setup), |_| Twist::default());
        let truth = events.iter().find_map(|(_, event)| match event {
            Some(Event::Truth(truth)) => Some(truth),
            _ => None,
        });
        let truth = truth.expect("the truth at t = 0");
        assert!((truth.clearance_m - wanted_m).abs() < 1e-12, "{name}: {}", truth.clearance_m);
        assert_eq!(truth.clearance_static_m, truth.clearance_m);
    }
}

/// Fact I-h of specification §11: with k = 1 throughout, the robot of Case I leaves the admissible
/// set at 10.5 ± 0.2 s, returns at 27.3 ± 0.2 s, and leaves it again between 38 and 40.5 s.
#[test]
fn case1_without_a_controller_leaves_and_returns() {
    let events = run(start(setup("case1", SensorSuite::Exact, FIFTIETH, 60.0)), obey);
    let mut crossings_s = Vec::new();
    let mut admissible = true;
    for (_, event) in &events {
        if let Some(Event::Truth(truth)) = event
            && (truth.clearance_m >= 0.0) != admissible
        {
            admissible = !admissible;
            crossings_s.push(truth.stamp.seconds_since(SIMULATION_EPOCH));
        }
    }
    assert_eq!(crossings_s.len(), 3, "{crossings_s:?}");
    assert!((crossings_s[0] - 10.5).abs() <= 0.2, "{crossings_s:?}");
    assert!((crossings_s[1] - 27.3).abs() <= 0.2, "{crossings_s:?}");
    assert!(38.0 < crossings_s[2] && crossings_s[2] < 40.5, "{crossings_s:?}");
}

/// The same setup and commands give the same session, bit for bit; another seed does not.
#[test]
fn a_session_is_determined_by_its_setup() {
    let session = |seed| {
        let setup = SimulationSetup {
            seed,
            ..setup("random:disc:joystick:3", SensorSuite::Sonar, TENTH, 5.0)
        };
        run(start(setup), obey)
    };
    let first = session(1);
    assert_eq!(format!("{first:?}"), format!("{:?}", session(1)));
    assert_ne!(format!("{first:?}"), format!("{:?}", session(2)));
}

/// Another controller does not shift the noise: two robots that do different things get the same
/// tremor, and the same errors of turn rate and range where they differ by nothing else.
#[test]
fn commands_do_not_shift_the_noise() {
    let session = |v_mps: f64, control_period| {
        let setup = setup("case3-lab", SensorSuite::Sonar, control_period, 4.0);
        run(start(setup), move |_| Twist { v_mps, omega_radps: 0.0 })
    };
    let (still, moving) = (session(0.0, TENTH), session(0.3, FIFTIETH));
    let gyro = |events: &[(Time, Option<Event>)]| -> Vec<[f64; 3]> {
        events
            .iter()
            .filter_map(|(_, event)| match event {
                Some(Event::Sample(Sample::Imu(sample))) => Some(sample.gyro_radps),
                _ => None,
            })
            .collect()
    };
    let joystick = |events: &[(Time, Option<Event>)]| -> Vec<[f64; 2]> {
        events
            .iter()
            .filter_map(|(_, event)| match event {
                Some(Event::Sample(Sample::Joystick(sample))) => {
                    Some([sample.v_mps, sample.omega_radps])
                }
                _ => None,
            })
            .collect()
    };
    assert_eq!(gyro(&still).len(), 401);
    assert_eq!(gyro(&still), gyro(&moving));
    assert_eq!(joystick(&still), joystick(&moving));
}
