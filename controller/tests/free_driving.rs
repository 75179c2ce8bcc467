//! Contract: in free driving (specification §5, §6, §13) the law in reverse is that of the mirrored
//! robot; a predicted target stays where it is told to; k = 1 comes back when it could have for a while;
//! and D is the way of the footprint.

use std::f64::consts::PI;

use controller::{Runner, Setup, Spec};
use proptest::prelude::*;
use schemas::{
    Driver, ExactPose, HalfPlane, JoystickSample, Plant, Pose, Reason, Region, Sample, Scenario,
    SensorSuite, Span, Start, Step, Time, World,
};

const START: Time = Time(1_000_000_000_000);

/// A room of 4 m × 4 m about the origin, a 0.5 m × 0.5 m robot, free driving.
fn scenario() -> Scenario {
    let walls = [[1.0, 0.0], [-1.0, 0.0], [0.0, 1.0], [0.0, -1.0]];
    Scenario {
        name: "test".to_owned(),
        summary: String::new(),
        duration_s: 10.0,
        sensors: SensorSuite::Exact,
        driver: Driver::Joystick,
        start: Start::default(),
        task: None,
        robot: schemas::Robot::default(),
        plant: Plant::default(),
        noise: schemas::Noise::default(),
        person: schemas::Person::default(),
        controller: schemas::Overrides::default(),
        world: World {
            room: walls.map(|normal| HalfPlane { normal, offset_m: 2.0 }).to_vec(),
            ..World::default()
        },
        explored: None,
    }
}

fn runner(version: &str, overrides: &str) -> Runner {
    let overrides = overrides.parse().expect("TOML");
    let spec = Spec::resolve(version, &[&overrides]).expect("a version of the list");
    let (scenario, sensors) = (scenario(), SensorSuite::Exact);
    Runner::new(&Setup { spec, scenario, sensors, start: START }).expect("they go together")
}

/// One step of 0.1 s, number `n`, at a pose and at speeds, with a request.
fn step(runner: &mut Runner, n: u32, pose: Pose, speeds: [f64; 2], request: [f64; 2]) -> Step {
    let stamp = START + Span::from_seconds(0.1 * f64::from(n));
    let ([v_mps, omega_radps], [v_h_mps, omega_h_radps]) = (speeds, request);
    runner.observe(&Sample::Exact(ExactPose { stamp, pose, v_mps, omega_radps }));
    runner.observe(&Sample::Joystick(JoystickSample {
        stamp,
        v_mps: v_h_mps,
        omega_radps: omega_h_radps,
        dead_man: true,
    }));
    runner.step(stamp).step
}

fn at(x_m: f64, theta_rad: f64) -> Pose {
    Pose { x_m, y_m: 0.0, theta_rad }
}

fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-9 * (1.0 + a.abs())
}

proptest! {
    /// Backwards towards something is forwards towards it with the body turned round: the same D, the
    /// same k, the opposite u1 and the same u2, for two steps in a row and for both laws.
    #[test]
    fn the_law_in_reverse_is_that_of_the_mirrored_robot(
        x_m in -1.7..1.7, y_m in -1.7..1.7, theta_rad in -3.0..3.0,
        v in 0.01..0.7_f64, omega in -1.5..1.5, now in prop::array::uniform2(-0.5..0.5_f64),
        dynamic in any::<bool>(),
    ) {
        let version = if dynamic { "tandem-dynamic" } else { "tandem-kinematic" };
        let overrides = if dynamic { "control_period_s = 0.1" } else { "" };
        let (mut back, mut forth) = (runner(version, overrides), runner(version, overrides));
        for n in 0..2 {
            let pose = Pose { x_m: x_m + 0.01 * f64::from(n), y_m, theta_rad };
            let turned = Pose { theta_rad: theta_rad + PI, ..pose };
            let reversed = step(&mut back, n, pose, now, [-v, omega]);
            let twin = step(&mut forth, n, turned, [-now[0], now[1]], [v, omega]);
            prop_assert_eq!((reversed.k, reversed.region), (twin.k, twin.region));
            prop_assert!(near(reversed.distance_human_m, twin.distance_human_m));
            prop_assert!(near(reversed.u_f[0], -twin.u_f[0]), "{:?} {:?}", reversed.u_f, twin.u_f);
            prop_assert!(near(reversed.u_f[1], twin.u_f[1]), "{:?} {:?}", reversed.u_f, twin.u_f);
        }
    }
}

/// Asked to go on backwards towards a wall 0.2 m behind it, the unmirrored robot turns round to it by
/// nearly half a turn, as fast as it may; the mirrored one has hardly to turn.
#[test]
fn backing_into_a_wall_does_not_turn_the_robot_round() {
    let turn_radps = |rule: &str| {
        let mut runner = runner("tandem-kinematic", &format!("reverse_law = \"{rule}\""));
        let step = step(&mut runner, 0, at(-1.55, 0.02), [0.0; 2], [-0.7, 0.0]);
        assert_eq!((step.k, step.reason), (0.0, Reason::Danger));
        step.u_f[1].abs()
    };
    // γ3 = 2 times the heading error.
    assert!(turn_radps("same") > 2.0 * 2.0, "{}", turn_radps("same"));
    assert!(turn_radps("mirrored") < 2.0 * 0.5, "{}", turn_radps("mirrored"));
}

/// The predicted target is 0.3 m/s · 1.5 s ahead of where the law took over, wherever the robot goes,
/// until the request changes by more than a quarter of full speed.
#[test]
fn a_predicted_target_may_stay() {
    for (rule, moved_m) in [("stays", 0.0), ("follows", 0.1)] {
        let mut runner = runner("tandem-kinematic", &format!("predicted_target = \"{rule}\""));
        let near_wall = at(1.6, 0.0);
        let first = step(&mut runner, 0, near_wall, [0.0; 2], [0.3, 0.0]);
        assert_eq!(first.k, 0.0);
        assert!(near(first.target_x_m, 1.6 + 0.45));
        let second = step(&mut runner, 1, at(1.7, 0.0), [0.0; 2], [0.31, 0.0]);
        let by_m = second.target_x_m - first.target_x_m;
        // 0.015 m more of the following one's is the greater request.
        assert!((by_m - moved_m - if moved_m > 0.0 { 0.015 } else { 0.0 }).abs() < 1e-12);
        let other = step(&mut runner, 2, at(1.7, 0.0), [0.0; 2], [0.5, 0.0]);
        assert!((other.target_x_m - (1.7 + 0.75)).abs() < 1e-12);
    }
}

/// With 0.2 s to wait: safe at steps 2, 3 and 4, the person drives from the fourth on; unsafe in
/// between, it begins again. Another request does not wait.
#[test]
fn control_comes_back_when_it_could_have_for_a_while() {
    let (open, blocked) = (at(0.0, 0.0), at(1.72, 0.0));
    let mut runner = runner("tandem-kinematic", "wait = \"always\"\ngrant_s = 0.2");
    let mut k = |n: u32, pose: Pose, v: f64| {
        let step = step(&mut runner, n, pose, [0.0; 2], [v, 0.0]);
        (step.k, step.region, step.reason)
    };
    assert_eq!(k(0, open, 0.3), (1.0, Region::Safe, Reason::Human), "the first time at once");
    assert_eq!(k(1, blocked, 0.3).0, 0.0);
    assert_eq!(k(2, open, 0.3), (0.0, Region::Safe, Reason::Hysteresis));
    assert_eq!(k(3, blocked, 0.3).0, 0.0);
    assert_eq!(k(4, open, 0.3).0, 0.0);
    assert_eq!(k(5, open, 0.3).0, 0.0);
    assert_eq!(k(6, open, 0.3), (1.0, Region::Safe, Reason::Human));
    assert_eq!(k(7, blocked, 0.3).0, 0.0);
    assert_eq!(
        k(8, open, -0.3),
        (1.0, Region::Safe, Reason::Human),
        "backwards is another request"
    );
}

/// Straight towards the wall at x = 2: the front of the footprint is 0.25 m ahead, the circle about it
/// 0.354 m. Beside a wall, 0.3 m off, the circle is in contact and the footprint is not.
#[test]
fn d_is_the_way_of_the_footprint() {
    for (body, ahead_m) in [("footprint", 1.75), ("disc", 2.0 - 0.125_f64.sqrt())] {
        let mut runner = runner("tandem-kinematic", &format!("d_body = \"{body}\""));
        let step = step(&mut runner, 0, at(0.0, 0.0), [0.0; 2], [0.3, 0.0]);
        assert!(near(step.distance_human_m, ahead_m), "{}", step.distance_human_m);
    }
}
