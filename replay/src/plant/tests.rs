//! The contract: what the simulated plant was given is what its log gives back.

use super::*;
use crate::session::{record, scenario};
use schemas::SensorSuite;

fn identified(plant: Plant, controller: &str, sensors: SensorSuite) -> PlantEstimate {
    let mut scenario = scenario("random:rect:joystick:3", 30.0);
    scenario.plant = Plant { ..plant };
    PlantEstimate::of_log(record(&scenario, controller, sensors).open())
}

fn holds(estimate: Option<Estimate>, truth: f64, tolerance: f64, what: &str) {
    let estimate = estimate.unwrap_or_else(|| panic!("{what} is identified"));
    assert!((estimate.value - truth).abs() <= tolerance, "{what}: {estimate:?}, not {truth}");
    assert!(estimate.low <= estimate.value && estimate.value <= estimate.high, "{estimate:?}");
    assert!(
        estimate.low <= truth + tolerance && truth - tolerance <= estimate.high,
        "{estimate:?}"
    );
}

const WORSE: Plant = Plant {
    v_max_mps: 0.7,
    omega_max_radps: 2.0,
    accel_max_mps2: 0.6,
    alpha_max_radps2: 2.0,
    limits_acceleration: true,
    actuator_delay_s: 0.12,
    slip: 0.08,
};

/// From encoders and gyro, under people who drive alone.
#[test]
fn a_worse_plant_is_found_from_encoders() {
    let found = identified(WORSE, "human", SensorSuite::Sonar);
    holds(found.delay_s, 0.12, 0.015, "delay");
    holds(found.accel_mps2, 0.6, 0.06, "acceleration");
    holds(found.alpha_radps2, 2.0, 0.2, "angular acceleration");
    holds(found.slip, 0.08, 0.01, "slip");
    holds(found.gain_v, 1.0, 0.02, "gain");
    let applied = found.applied_to(Plant::default());
    assert!(applied.limits_acceleration && (applied.slip - 0.08).abs() < 0.01);
}

/// With exact rays nobody sees the wheels: slip is what the robot lacks of its command.
#[test]
fn a_worse_plant_is_found_from_exact_poses() {
    let found = identified(WORSE, "human", SensorSuite::Exact);
    holds(found.slip, 0.08, 0.02, "slip");
    holds(found.delay_s, 0.12, 0.05, "delay");
    holds(found.accel_mps2, 0.6, 0.1, "acceleration");
}

/// The paper's own plant follows at once: no delay, no limit that was felt.
#[test]
fn an_ideal_plant_is_found_to_be_ideal() {
    let found = identified(Plant::default(), "human", SensorSuite::Sonar);
    holds(found.delay_s, 0.0, 0.011, "delay");
    assert!(found.accel_mps2.is_some_and(|limit| limit.high.is_infinite()), "{found:?}");
    holds(found.slip, 0.0, 0.01, "slip");
}

/// Under a law that commands accelerations the delay is found; a limit that the law keeps to by
/// itself is not felt.
#[test]
fn delays_show_under_accelerations_too() {
    let plant = Plant { actuator_delay_s: 0.1, ..Plant::default() };
    let found = identified(plant, "tandem-dynamic", SensorSuite::Sonar);
    holds(found.delay_s, 0.1, 0.03, "delay");
    assert!(found.accel_mps2.is_some_and(|limit| limit.high.is_infinite()), "{found:?}");
}

/// A log without commands, or in which nothing was asked for, says nothing.
#[test]
fn a_robot_at_rest_says_nothing() {
    let mut still = scenario("case3", 5.0);
    still.person.script = vec![schemas::Stroke { v_mps: 0.0, omega_radps: 0.0, duration_s: 9.0 }];
    let found = PlantEstimate::of_log(record(&still, "human", SensorSuite::Sonar).open());
    let nothing = PlantEstimate { untold: Some(Untold::AtRest), ..PlantEstimate::default() };
    assert_eq!(found, nothing);
    assert_eq!(found.applied_to(WORSE), WORSE);
}

/// Why nothing is said, and that a claim of which nothing is said is untested, which is not that it stands.
#[test]
fn a_log_that_says_nothing_says_why() {
    use schemas::log::Topic;
    let mut still = scenario("case3", 5.0);
    still.person.script = vec![schemas::Stroke { v_mps: 0.0, omega_radps: 0.0, duration_s: 9.0 }];
    let moving = scenario("random:rect:joystick:3", 5.0);
    let without = |scenario: &schemas::Scenario, sensors, gone: &[Topic]| {
        let mut log = record(scenario, "human", sensors);
        log.events.retain(|event| !gone.contains(&Topic::of(&event.value)));
        log.rewrite(scenario);
        (PlantEstimate::of_log(log.open()).untold, PlantClaim::of_log(log.open()))
    };
    let suites = [SensorSuite::Sonar, SensorSuite::Exact];
    for sensors in suites {
        let short = scenario("random:rect:joystick:3", 0.5);
        for (scenario, gone, untold) in [
            (&still, &[][..], Untold::AtRest),
            (&short, &[], Untold::Short),
            (&moving, &[Topic::Command, Topic::Imu], Untold::NoCommand),
            (&moving, &[Topic::Encoders, Topic::Exact], Untold::NoMotion),
        ] {
            let (why, claim) = without(scenario, sensors, gone);
            assert_eq!(why, Some(untold), "{sensors:?} {gone:?}");
            assert_eq!(claim, PlantClaim::Untested(untold), "{sensors:?} {gone:?}");
        }
        assert_eq!(without(&moving, sensors, &[]), (None, PlantClaim::Stands), "{sensors:?}");
    }
    // Wheels and gyro tell of slip without any command.
    let (why, claim) = without(&moving, SensorSuite::Sonar, &[Topic::Command]);
    assert_eq!((why, claim), (None, PlantClaim::Stands));
}

/// What a log is at odds with that was recorded on one plant and claims another.
fn doubted(
    plant: Plant,
    claimed: Plant,
    controller: &str,
    sensors: SensorSuite,
) -> Option<PlantDoubt> {
    let mut scenario = scenario("random:rect:joystick:3", 20.0);
    scenario.plant = plant;
    let mut log = record(&scenario, controller, sensors);
    scenario.plant = claimed;
    log.rewrite(&scenario);
    PlantClaim::of_log(log.open()).doubt()
}

/// No session whose plant is what it claims to be is doubted, whatever its sensors get wrong: dead encoders,
/// bursts of slip, a bias that jumps, under every controller.
#[test]
fn a_claim_that_holds_is_not_doubted() {
    for number in 0..crate::exactness::SESSIONS + 14 {
        let (mut scenario, controller, sensors) = crate::exactness::session(number);
        scenario.duration_s = 8.0;
        let log = crate::session::record_seeded(&scenario, controller, sensors, number as u64);
        let what = format!("{number}: {} with {controller}, {sensors:?}", scenario.name);
        if let Some(doubt) = PlantClaim::of_log(log.open()).doubt() {
            panic!("{what}: {doubt}");
        }
    }
}

/// A robot that answers late, accelerates slowly or slips is not the one that follows at once, nor the other
/// way round; what is said of it names what it is about.
#[test]
fn a_claim_that_does_not_hold_is_doubted() {
    let ideal = Plant::default();
    let late = Plant { actuator_delay_s: 0.2, ..ideal };
    let limits_acceleration = true;
    let slow = Plant { limits_acceleration, accel_max_mps2: 0.4, alpha_max_radps2: 1.5, ..ideal };
    let slipping = Plant { slip: 0.1, ..ideal };
    let plants = [
        (late, "delay "),
        (slow, "acceleration 0."),
        (WORSE, "acceleration 0."),
        (slipping, "slip 0.1"),
    ];
    for (plant, said) in plants {
        for sensors in [SensorSuite::Sonar, SensorSuite::Exact] {
            for controller in ["human", "tandem-kinematic"] {
                let what = format!("{plant:?} {controller} {sensors:?}");
                let doubt = doubted(plant, ideal, controller, sensors).expect(&what);
                assert!(doubt.to_string().contains(said), "{what}: {doubt}");
                assert_eq!(doubt.claimed, ideal);
                doubted(ideal, plant, controller, sensors).expect(&what);
            }
        }
    }
    // Under a law that commands accelerations too; but what keeps to a limit does not show it.
    let doubt = doubted(late, ideal, "tandem-dynamic", SensorSuite::Sonar).expect("late");
    assert!(doubt.to_string().contains("delay 0.2"), "{doubt}");
    assert_eq!(doubted(slow, ideal, "tandem-dynamic", SensorSuite::Sonar), None);
}

/// What is driven instead is not doubted.
#[test]
fn what_the_log_shows_does_what_the_log_shows() {
    for sensors in [SensorSuite::Sonar, SensorSuite::Exact] {
        let doubt = doubted(WORSE, Plant::default(), "human", sensors).expect("another plant");
        let mended = doubt.found.applied_to(Plant::default());
        assert_eq!(doubted(WORSE, mended, "human", sensors), None, "{mended:?}");
    }
}
