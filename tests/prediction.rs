//! Contract: with a plant that does what it is told, the controller foresees where each of its commands
//! will find the robot (specification §9): the pose that it measures from is the pose that the plant has
//! when the command takes effect, whatever the delay, the period and the age of what was measured, and
//! for velocities at once, velocities at no more than an acceleration, and accelerations alike.

use std::collections::{BTreeMap, VecDeque};

use controller::{Runner, Setup, Spec};
use schemas::{
    Event, Plant, Pose, Pulled, SIMULATION_EPOCH, Sample, Scenario, SensorSuite, Source, Span,
    Start,
};
use simulator::{Simulation, SimulationSetup};

/// A room with a person who drives about freely, and a robot that is under way when it begins.
fn scenario(plant: Plant) -> Scenario {
    let mut scenario = simulator::scenario("random:rect:joystick:7").expect("a random room");
    scenario.plant = plant;
    scenario.start = Start { v_mps: 0.3, omega_radps: -0.5, ..scenario.start };
    scenario.duration_s = 8.0;
    scenario
}

/// Drives, with every measured pose `held_back` control periods late, and gives the largest errors of the
/// foreseen pose, metres and radians, and how far the plant went between measurement and effect.
fn errors(version: &str, scenario: Scenario, period_s: f64, held_back: usize) -> [f64; 3] {
    let mut period = toml::Table::new();
    period.insert("control_period_s".to_owned(), period_s.into());
    // With no lease on odometry, and no room to stop in asked for, whatever is asked for is tried.
    period.insert("projection".to_owned(), "none".into());
    period.insert("margin".to_owned(), "never".into());
    let spec = Spec::resolve(version, &[&period]).expect("a version of the list");
    let sensors = SensorSuite::Exact;
    let setup = Setup { spec, scenario: scenario.clone(), sensors, start: SIMULATION_EPOCH };
    let mut runner = Runner::new(&setup).expect("parameters go together");
    let human = simulator::driver(&scenario, scenario.driver, 3).expect("has a driver");
    let delay = Span::from_seconds(scenario.plant.actuator_delay_s);
    let setup = SimulationSetup {
        sensors,
        control_period: runner.control_period(),
        ..SimulationSetup::of(scenario, runner.control_period())
    };
    let mut simulation = Simulation::new(setup, human).expect("makes sense");
    let mut measured: VecDeque<Sample> = VecDeque::new();
    let (mut foreseen, mut truths) = (Vec::new(), BTreeMap::new());
    while let Some(pulled) = simulation.pull().expect("never fails") {
        match pulled {
            Pulled::Event(event) => match event.value {
                Event::Sample(sample @ Sample::Exact(_)) => {
                    measured.push_back(sample);
                    if measured.len() > held_back {
                        runner.observe(&measured.pop_front().expect("just pushed"));
                    }
                }
                Event::Sample(sample) => runner.observe(&sample),
                Event::Truth(truth) => {
                    truths.insert(truth.stamp, truth.pose);
                }
                _ => {}
            },
            Pulled::StepDue { now, .. } => {
                let outcome = runner.step(now);
                simulation.actuate(&outcome.command);
                let looked_from = *runner.look().expect("has stepped").from();
                if outcome.step.pose.is_finite() {
                    foreseen.push((now + delay, looked_from, outcome.step.pose));
                }
            }
        }
    }
    let apart_m = |a: &Pose, b: &Pose| (a.x_m - b.x_m).hypot(a.y_m - b.y_m);
    let [mut off_m, mut off_rad, mut gone_m] = [0.0_f64; 3];
    let mut compared = 0;
    for (at, pose, from) in &foreseen {
        let Some(truth) = truths.get(at) else { continue };
        compared += 1;
        off_m = off_m.max(apart_m(pose, truth));
        off_rad = off_rad.max((pose.theta_rad - truth.theta_rad).abs());
        gone_m = gone_m.max(apart_m(from, truth));
    }
    assert!(compared > 50, "{compared}");
    [off_m, off_rad, gone_m]
}

/// Delays below, at and above the period, and not a multiple of it. Truth is told every 20 ms: at least
/// every fifth command takes effect then.
const TIMES_S: [(f64, f64); 7] =
    [(0.0, 0.1), (0.1, 0.1), (0.06, 0.1), (0.26, 0.1), (0.34, 0.02), (0.1, 0.01), (0.06, 0.025)];

/// At constant speeds the arcs are exact, and so is the prediction: but for rounding, whatever was held
/// back.
#[test]
fn velocities_at_once() {
    for (actuator_delay_s, period_s) in TIMES_S {
        for held_back in [0, 1, 2] {
            let plant = Plant { actuator_delay_s, ..Plant::default() };
            let [off_m, off_rad, gone_m] =
                errors("tandem-kinematic", scenario(plant), period_s, held_back);
            let name = format!("{actuator_delay_s} {period_s} {held_back}");
            assert!(off_m < 1e-9 && off_rad < 1e-9, "{name}: {off_m} m {off_rad} rad");
            let since_s = actuator_delay_s + period_s * held_back as f64;
            assert!(gone_m >= 0.2 * since_s, "{name}: only {gone_m} m");
        }
    }
}

/// At changing speeds the controller takes means over 20 ms: 4e-6 m each (`safety/motion.rs`).
#[test]
fn velocities_by_ramps_and_accelerations() {
    for (version, limits_acceleration, accel_max_mps2) in
        [("tandem-kinematic", true, 0.3), ("tandem-dynamic", false, 2.0)]
    {
        for (actuator_delay_s, period_s) in TIMES_S {
            for held_back in [0, 1, 2] {
                let plant = Plant {
                    actuator_delay_s,
                    limits_acceleration,
                    accel_max_mps2,
                    ..Plant::default()
                };
                let [off_m, off_rad, gone_m] =
                    errors(version, scenario(plant), period_s, held_back);
                let name = format!("{version} {actuator_delay_s} {period_s} {held_back}");
                let since_s = actuator_delay_s + period_s * held_back as f64;
                let tight_m = 4e-6 * (since_s / 0.02 + 1.0) + 1e-9;
                assert!(off_m < tight_m && off_rad < 1e-9, "{name}: {off_m} m {off_rad} rad");
                assert!(gone_m >= 0.2 * since_s, "{name}: only {gone_m} m");
            }
        }
    }
}
