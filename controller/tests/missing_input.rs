//! Contract: three rows of the bad-input policy (specification §10) in which something is missing
//! while the rest is well: a joystick that was never heard, a side that is unknown while the way
//! ahead is known, a feedback that is not finite. Each ends in a stop that says why.

use controller::{Runner, Setup, Spec};
use schemas::{
    Driver, EncoderSample, ExactPose, HalfPlane, JoystickSample, Noise, Overrides, Person, Plant,
    Pose, Reason, Region, Robot, Sample, Scenario, SensorSuite, SonarEcho, SonarScan, Span, Start,
    Step, Task, Time, World,
};

const START: Time = Time(1_000_000_000_000);
const LAWS: [&str; 4] = ["paper-kinematic", "tandem-kinematic", "paper-dynamic", "tandem-dynamic"];

/// A room of 4 m × 4 m about the origin.
fn runner(version: &str, sensors: SensorSuite, task: Option<Task>) -> Runner {
    let walls = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    let scenario = Scenario {
        name: "test".to_owned(),
        summary: String::new(),
        duration_s: 10.0,
        sensors,
        driver: Driver::Joystick,
        start: Start::default(),
        task,
        robot: Robot::default(),
        plant: Plant::default(),
        noise: Noise::default(),
        person: Person::default(),
        controller: Overrides::default(),
        world: World {
            room: walls.map(|normal| HalfPlane { normal, offset_m: 2.0 }).to_vec(),
            ..World::default()
        },
        explored: None,
    };
    let overrides = "control_period_s = 0.1".parse().expect("TOML");
    let spec = Spec::resolve(version, &[&overrides]).expect("a version of the list");
    Runner::new(&Setup { spec, scenario, sensors, start: START }).expect("defaults go together")
}

fn at(t_s: f64) -> Time {
    START + Span::from_seconds(t_s)
}

fn exact(t_s: f64, x_m: f64) -> Sample {
    let pose = Pose { x_m, y_m: 0.0, theta_rad: 0.0 };
    Sample::Exact(ExactPose { stamp: at(t_s), pose, v_mps: 0.0, omega_radps: 0.0 })
}

fn joystick(t_s: f64, v_mps: f64) -> Sample {
    Sample::Joystick(JoystickSample { stamp: at(t_s), v_mps, omega_radps: 0.0, dead_man: true })
}

fn step(runner: &mut Runner, t_s: f64, samples: &[Sample]) -> Step {
    for sample in samples {
        runner.observe(sample);
    }
    runner.step(at(t_s)).step
}

/// Row "joystick never heard": the input is 0 with the target underfoot. In the middle of the room nothing
/// is near enough for the law to back out of, so the robot rests.
#[test]
fn a_joystick_that_was_never_heard_asks_for_nothing() {
    for version in LAWS {
        let mut runner = runner(version, SensorSuite::Exact, None);
        for tick in 0..5 {
            let t_s = 0.1 * f64::from(tick);
            let step = step(&mut runner, t_s, &[exact(t_s, 0.0)]);
            assert_eq!((step.k, step.reason), (0.0, Reason::JoystickSilent), "{version}");
            assert_eq!((step.u_h, step.u_s), ([0.0; 2], [0.0; 2]), "{version}");
            assert!(step.joystick_age_s.is_nan());
            assert_eq!([step.target_x_m, step.target_y_m], [0.0, 0.0]);
        }
        // It is not held against the person: once they are heard, they drive.
        let heard = step(&mut runner, 0.5, &[exact(0.5, 0.0), joystick(0.5, 0.2)]);
        assert_eq!((heard.k, heard.reason), (1.0, Reason::Human), "{version}");
    }
}

/// Row "selected d2 unknown": only the six sonars ahead speak, so D is known and small, and neither
/// side is. The law would have to guess a distance; it stops instead.
#[test]
fn an_unknown_side_stops_the_feedback() {
    for version in LAWS {
        let mut runner = runner(version, SensorSuite::Sonar, None);
        let mut last = None;
        for tick in 0..20 {
            let t_s = 0.1 * f64::from(tick);
            // 0.35 m before the transducers, which stand up to 0.245 m before the centre: the body's
            // circle of 0.354 m has less than 0.3 m left, and Dc(0.7 m/s, 1 m) is 0.41 m.
            let echoes =
                (1..=6).map(|id| SonarEcho { id, range_m: 0.35, echo: true, fired: at(t_s) });
            let samples = [
                Sample::Sonar(SonarScan { stamp: at(t_s), echoes: echoes.collect() }),
                Sample::Encoders(EncoderSample { stamp: at(t_s), ..EncoderSample::default() }),
                joystick(t_s, 0.7),
            ];
            last = Some(step(&mut runner, t_s, &samples));
        }
        let step = last.expect("twenty steps");
        assert!((0.0..0.3).contains(&step.distance_human_m), "{version}: {step:?}");
        assert!(step.d1_m.is_finite(), "{version}: the way ahead is known");
        assert!(step.d2l_m.is_nan() && step.d2r_m.is_nan(), "{version}: {step:?}");
        assert_eq!((step.k, step.region), (0.0, Region::Danger), "{version}");
        assert_eq!(step.reason, Reason::DistanceUnknown, "{version}");
        assert_eq!(step.u_s, [0.0; 2], "{version}");
    }
}

/// Row "feedback not finite": a target so fast that its square overflows, near a wall so that the person
/// does not drive.
#[test]
fn a_feedback_that_is_not_finite_stops() {
    let task = Task { from_m: [0.0; 2], velocity_mps: [1e200, 0.0], until_s: 1.0 };
    for version in LAWS {
        let mut runner = runner(version, SensorSuite::Exact, Some(task));
        // 0.05 m of free travel ahead: DANGER at any speed.
        let x_m = 2.0 - 0.25 * std::f64::consts::SQRT_2 - 0.05;
        let step = step(&mut runner, 0.0, &[exact(0.0, x_m), joystick(0.0, 0.7)]);
        assert!(!step.omega_star_radps.is_finite(), "{version}: {step:?}");
        assert_eq!(step.u_f, [0.0; 2], "{version}: what is not a number is never asked for");
        assert!(step.distance_human_m.is_finite());
        assert_eq!((step.k, step.reason), (0.0, Reason::FeedbackInvalid), "{version}");
        assert_eq!(step.u_s, [0.0; 2], "{version}");
    }
}
