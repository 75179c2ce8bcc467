use super::*;
use core::f64::consts::PI;
use proptest::prelude::*;

fn ns(seconds: f64) -> u64 {
    schemas::Span::from_seconds(seconds).0
}

fn velocities(v_mps: f64, omega_radps: f64) -> Command {
    Command { twist: Twist { v_mps, omega_radps }, ..Command::default() }
}

fn accelerations(forward_mps2: f64, turn_radps2: f64) -> Command {
    Command { accel: Some([forward_mps2, turn_radps2]), ..Command::default() }
}

fn at(x_m: f64, y_m: f64, theta_rad: f64) -> Pose {
    Pose { x_m, y_m, theta_rad }
}

fn start(pose: Pose, v_mps: f64, omega_radps: f64) -> Start {
    Start { pose, v_mps, omega_radps }
}

fn apart_m(a: Pose, b: Pose) -> f64 {
    libm::hypot(a.x_m - b.x_m, a.y_m - b.y_m) + (a.theta_rad - b.theta_rad).abs()
}

/// The unicycle with speeds given as functions of time, by many small steps of RK4 on all three
/// equations of (1): independent of arcs, ramps and Simpson's rule.
fn integrate(from: Pose, span_s: f64, v: impl Fn(f64) -> f64, omega: impl Fn(f64) -> f64) -> Pose {
    let steps = 20_000;
    let h = span_s / f64::from(steps);
    let rate = |t: f64, theta: f64| {
        let (sin, cos) = libm::sincos(theta);
        [v(t) * cos, v(t) * sin, omega(t)]
    };
    let mut state = [from.x_m, from.y_m, from.theta_rad];
    for step in 0..steps {
        let t = f64::from(step) * h;
        let k1 = rate(t, state[2]);
        let k2 = rate(t + 0.5 * h, state[2] + 0.5 * h * k1[2]);
        let k3 = rate(t + 0.5 * h, state[2] + 0.5 * h * k2[2]);
        let k4 = rate(t + h, state[2] + h * k3[2]);
        for i in 0..3 {
            state[i] += h / 6.0 * (k1[i] + 2.0 * k2[i] + 2.0 * k3[i] + k4[i]);
        }
    }
    at(state[0], state[1], state[2])
}

/// Closed form: at v, ω the robot is on a circle of radius v/ω; after half a turn it stands
/// opposite, looking back.
#[test]
fn half_a_circle() {
    let mut plant = Plant::new(Limits::default(), &start(at(1.0, 2.0, 0.0), 0.0, 0.0));
    plant.command(&velocities(0.5, 1.0));
    let half_turn_ns = ns(PI);
    plant.advance_to(half_turn_ns);
    let wanted = at(1.0, 3.0, PI);
    assert!(apart_m(plant.pose(), wanted) < 1e-8, "{:?}", plant.pose());
    assert_eq!(plant.twist(), Twist { v_mps: 0.5, omega_radps: 1.0 });
    let (travelled_m, turned_rad) = plant.wheel_travel();
    assert!((travelled_m - 0.5 * PI).abs() < 1e-8 && (turned_rad - PI).abs() < 1e-8);
}

/// Straight ahead is straight, exactly, and a hair of a turn rate changes nothing visible: the
/// series of the sinc joins the quotient.
#[test]
fn straight_and_almost_straight() {
    let ahead = |omega_radps| {
        let mut plant = Plant::new(Limits::default(), &start(at(0.0, 0.0, 0.0), 0.0, 0.0));
        plant.command(&velocities(0.5, omega_radps));
        plant.advance_to(ns(2.0));
        plant.pose()
    };
    assert_eq!(ahead(0.0), at(1.0, 0.0, 0.0));
    for omega_radps in [1e-12, 1e-6, 9.99e-4, 1.001e-3] {
        // y = v (1 - cos ωt)/ω = v ω t²/2 (1 - (ωt)²/12 + …)
        let turned = 2.0 * omega_radps;
        let wanted_y_m = omega_radps * (1.0 - turned * turned / 12.0);
        let pose = ahead(omega_radps);
        assert!((pose.y_m / wanted_y_m - 1.0).abs() < 1e-11);
        assert!((pose.x_m - (1.0 - turned * turned / 6.0)).abs() < 1e-11);
    }
}

/// Cutting a motion into pieces does not change where it leads.
#[test]
fn pieces_add_up() {
    let run = |times: &[f64]| {
        let mut plant = Plant::new(Limits::default(), &start(at(0.0, 0.0, 0.3), 0.2, -0.4));
        plant.command(&accelerations(0.7, 1.1));
        for &t_s in times {
            plant.advance_to(ns(t_s));
        }
        plant.pose()
    };
    let whole = run(&[0.6]);
    let cut = run(&[0.001, 0.1, 0.1, 0.35, 0.59, 0.6]);
    assert!(apart_m(whole, cut) < 1e-10);
}

/// Dynamic model (2): v = v0 + u1 t, ω = ω0 + u2 t; the pose against fine RK4.
#[test]
fn constant_accelerations() {
    let from = at(0.3, -0.2, 1.0);
    let mut plant = Plant::new(Limits::default(), &start(from, 0.1, -0.5));
    plant.command(&accelerations(0.4, 1.5));
    plant.advance_to(ns(1.2));
    let wanted = integrate(from, 1.2, |t| 0.1 + 0.4 * t, |t| -0.5 + 1.5 * t);
    assert!(apart_m(plant.pose(), wanted) < 1e-9);
    let twist = plant.twist();
    assert!((twist.v_mps - 0.58).abs() < 1e-12 && (twist.omega_radps - 1.3).abs() < 1e-12);
    // v0 t + u1 t²/2, and likewise for the turn.
    let (travelled_m, turned_rad) = plant.wheel_travel();
    assert!((travelled_m - 0.408).abs() < 1e-12 && (turned_rad - 0.48).abs() < 1e-12);
}

/// Accelerations are clipped, and speeds stop at their limits exactly, each when it gets there.
#[test]
fn accelerations_and_speeds_are_limited() {
    let from = at(0.0, 0.0, 0.0);
    let mut plant = Plant::new(Limits::default(), &start(from, 0.0, 0.0));
    plant.command(&accelerations(50.0, -50.0));
    plant.advance_to(ns(1.0));
    // 2 m/s² up to 0.7 m/s takes 0.35 s; 6 rad/s² down to -2 rad/s takes 1/3 s.
    let wanted = integrate(
        from,
        1.0,
        |t| if t < 0.35 { 2.0 * t } else { 0.7 },
        |t| if t < 1.0 / 3.0 { -6.0 * t } else { -2.0 },
    );
    assert_eq!(plant.twist(), Twist { v_mps: 0.7, omega_radps: -2.0 });
    // The reference steps over the kinks, which costs it the square of its step.
    assert!(apart_m(plant.pose(), wanted) < 1e-7);
}

/// A velocity command acts at once in the kinematic model, and at the limit of the acceleration
/// where the plant has one; either way clipped to the limits.
#[test]
fn velocity_commands_jump_or_ramp() {
    let mut plant = Plant::new(Limits::default(), &Start::default());
    plant.command(&velocities(9.0, -9.0));
    plant.advance_to(ns(0.001));
    assert_eq!(plant.twist(), Twist { v_mps: 0.7, omega_radps: -2.0 });

    let limits = Limits { limits_acceleration: true, ..Limits::default() };
    let mut plant = Plant::new(limits, &Start::default());
    plant.command(&velocities(0.5, 1.0));
    plant.advance_to(ns(0.1));
    assert!((plant.twist().v_mps - 0.2).abs() < 1e-12);
    assert!((plant.twist().omega_radps - 0.6).abs() < 1e-12);
    plant.advance_to(ns(0.5));
    assert_eq!(plant.twist(), Twist { v_mps: 0.5, omega_radps: 1.0 });
    let wanted = integrate(
        Pose::default(),
        0.5,
        |t| if t < 0.25 { 2.0 * t } else { 0.5 },
        |t| if t < 1.0 / 6.0 { 6.0 * t } else { 1.0 },
    );
    assert!(apart_m(plant.pose(), wanted) < 1e-7);
}

/// A command acts after the delay, each in its turn; before the first the start speeds go on. At
/// the instant itself the speeds have not yet jumped.
#[test]
fn commands_act_after_the_delay() {
    let limits = Limits { actuator_delay_s: 0.1, ..Limits::default() };
    let mut plant = Plant::new(limits, &start(Pose::default(), 0.2, 0.0));
    plant.command(&velocities(0.4, 0.0));
    plant.advance_to(ns(0.04));
    plant.command(&velocities(0.6, 0.0));
    plant.advance_to(ns(0.1));
    assert_eq!(plant.twist().v_mps, 0.2);
    plant.advance_to(ns(0.14));
    assert_eq!(plant.twist().v_mps, 0.4);
    plant.advance_to(ns(0.2));
    assert_eq!(plant.twist().v_mps, 0.6);
    assert!((plant.pose().x_m - (0.2 * 0.1 + 0.4 * 0.04 + 0.6 * 0.06)).abs() < 1e-12);
}

/// Slip: the robot moves and turns by (1 - slip) of what its wheels do, from the given start speed.
#[test]
fn slip_loses_travel() {
    let limits = Limits { slip: 0.2, ..Limits::default() };
    let mut plant = Plant::new(limits, &start(Pose::default(), 0.4, 0.0));
    assert!((plant.twist().v_mps - 0.4).abs() < 1e-12);
    plant.command(&velocities(0.5, 1.0));
    plant.advance_to(ns(1.0));
    let wanted = integrate(Pose::default(), 1.0, |_| 0.4, |_| 0.8);
    assert!(apart_m(plant.pose(), wanted) < 1e-9);
    let (travelled_m, turned_rad) = plant.wheel_travel();
    assert!((travelled_m - 0.5).abs() < 1e-12 && (turned_rad - 1.0).abs() < 1e-12);
}

/// Numbers that are none stop the robot instead of spreading.
#[test]
fn commands_that_are_not_numbers_count_as_zero() {
    let mut plant = Plant::new(Limits::default(), &start(Pose::default(), 0.3, 0.1));
    plant.command(&velocities(f64::NAN, f64::INFINITY));
    plant.advance_to(ns(0.1));
    assert_eq!(plant.twist(), Twist::default());
    plant.command(&accelerations(f64::NAN, f64::NEG_INFINITY));
    plant.advance_to(ns(0.2));
    assert_eq!(plant.pose(), Pose::default());
    let endless = Limits {
        accel_max_mps2: f64::INFINITY,
        alpha_max_radps2: f64::INFINITY,
        limits_acceleration: true,
        ..Limits::default()
    };
    let mut plant = Plant::new(endless, &Start::default());
    plant.command(&velocities(0.5, 0.0));
    plant.advance_to(ns(1.0));
    assert_eq!(plant.pose(), at(0.5, 0.0, 0.0));
}

proptest! {
    /// Any sequence of commands at any times agrees with fine RK4 over the same piecewise linear
    /// speeds, which are found here by the plain formulas.
    #[test]
    fn agrees_with_fine_rk4(
        v0 in -0.7..0.7, omega0 in -2.0..2.0,
        forward in -2.0..2.0, turn in -6.0..6.0,
        span_s in 0.01..0.5,
    ) {
        let from = at(0.0, 0.0, 0.7);
        let mut plant = Plant::new(Limits::default(), &start(from, v0, omega0));
        plant.command(&accelerations(forward, turn));
        let span_ns = ns(span_s);
        plant.advance_to(span_ns);
        let span_s = schemas::Span(span_ns).seconds();
        let v = |t: f64| clip(v0 + forward * t, 0.7);
        let omega = |t: f64| clip(omega0 + turn * t, 2.0);
        prop_assert!((plant.twist().v_mps - v(span_s)).abs() < 1e-12);
        prop_assert!((plant.twist().omega_radps - omega(span_s)).abs() < 1e-12);
        prop_assert!(apart_m(plant.pose(), integrate(from, span_s, v, omega)) < 1e-7);
    }

    /// Speeds never leave the limits, whatever is commanded.
    #[test]
    fn never_faster_than_the_limits(
        commands in prop::collection::vec((any::<f64>(), any::<f64>(), any::<bool>()), 1..20),
        limits_acceleration in any::<bool>(),
        delay_s in 0.0..0.3,
    ) {
        let limits = Limits { limits_acceleration, actuator_delay_s: delay_s, ..Limits::default() };
        let mut plant = Plant::new(limits, &Start::default());
        for (i, (a, b, accelerate)) in commands.into_iter().enumerate() {
            plant.command(&if accelerate { accelerations(a, b) } else { velocities(a, b) });
            plant.advance_to((i as u64 + 1) * 50_000_000);
            prop_assert!(plant.twist().v_mps.abs() <= 0.7);
            prop_assert!(plant.twist().omega_radps.abs() <= 2.0);
            prop_assert!(plant.pose().is_finite());
        }
    }
}
