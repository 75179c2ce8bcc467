//! Courses of speeds, and when a body that follows one touches something.

use super::*;
use crate::synthetic::{block, scenario};
use proptest::prelude::*;
use schemas::MovingDisc;

/// The room of 4 m × 2 m with a body of 0.5 m × 0.5 m.
fn room() -> Surroundings {
    let scenario = scenario();
    Surroundings::new(scenario.world, scenario.robot.footprint)
}

fn twist(v_mps: f64, omega_radps: f64) -> Twist {
    Twist { v_mps, omega_radps }
}

#[track_caller]
fn close(got: Option<f64>, want: f64, tolerance: f64) {
    let got = got.expect("a contact");
    assert!((got - want).abs() < tolerance, "{got} instead of {want}");
}

const MIDDLE: Pose = Pose { x_m: 2.0, y_m: 1.0, theta_rad: 0.0 };

/// From 0.4 m/s and −1 rad/s towards 0.8 m/s and 1 rad/s from 0.1 s to 0.4 s, by 2 m/s² and 4 rad/s²;
/// then 0.4 s from 0.8 m/s to rest, the turn of 0.2 rad/s ends before.
#[test]
fn a_course_ramps_holds_and_brakes() {
    let course = Course {
        from: twist(0.4, -1.0),
        to: twist(0.8, 1.0),
        delay_s: 0.1,
        hold_s: 0.3,
        accel: Some([2.0, 4.0]),
    };
    for (tau_s, v_mps, omega_radps) in [
        (0.0, 0.4, -1.0),
        (0.099, 0.4, -1.0),
        (0.2, 0.6, -0.6),
        (0.375, 0.8, 0.1),
        (0.4, 0.8, 0.2),
        (0.425, 0.75, 0.1),
        (0.6, 0.4, 0.0),
        (0.9, 0.0, 0.0),
    ] {
        let Twist { v_mps: v, omega_radps: omega } = course.twist(tau_s);
        let off = (v - v_mps).abs().max((omega - omega_radps).abs());
        assert!(off < 1e-12, "{tau_s} s: {v} m/s, {omega} rad/s");
    }
    assert!((course.end_s() - 0.8).abs() < 1e-12);
    // Where the turn takes longer to end: 0.6 s of 4 rad/s² lead to its 1 rad/s, 0.25 s end it.
    let turning = Course { to: twist(0.0, 1.0), hold_s: 0.6, ..course };
    assert!((turning.end_s() - (0.7 + 0.25)).abs() < 1e-12);
}

/// Without a limit speeds jump, and at the instant of the jump they are the new ones.
#[test]
fn without_limits_speeds_jump() {
    let course = Course {
        from: twist(0.4, -1.0),
        to: twist(0.8, 1.0),
        delay_s: 0.125,
        hold_s: 0.25,
        accel: None,
    };
    assert_eq!([0.12, 0.125].map(|tau_s| course.twist(tau_s)), [course.from, course.to]);
    assert_eq!([0.37, 0.375].map(|tau_s| course.twist(tau_s)), [course.to, Twist::default()]);
    assert_eq!(course.end_s(), 0.375);
}

/// The chord of a circle of radius v/ω over an angle φ is 2 v/ω sin(φ/2), in the direction φ/2; also where
/// the turn is so slight that the quotient would lose digits.
#[test]
fn an_arc_ends_where_its_chord_does() {
    for omega_radps in [1.9e-4_f64, 1e-5, 2.1e-4, 0.5] {
        let Pose { x_m, y_m, theta_rad } = arc(&Pose::default(), twist(2.0, omega_radps), 1.0);
        let chord_m = 4.0 / omega_radps * (0.5 * omega_radps).sin();
        let (sin, cos) = (0.5 * omega_radps).sin_cos();
        let off_m = (x_m - chord_m * cos).abs().max((y_m - chord_m * sin).abs());
        assert!(off_m < 1e-14, "{omega_radps} rad/s: {off_m}");
        assert_eq!(theta_rad, omega_radps);
    }
}

/// No point of a body of 0.5 m × 0.5 m is farther from its middle than half its diagonal.
#[test]
fn no_point_of_the_body_is_faster() {
    let fastest_mps = room().speed_mps(twist(-0.3, -2.0));
    assert!((fastest_mps - (0.3 + 2.0 * 0.125_f64.sqrt())).abs() < 1e-12, "{fastest_mps}");
}

#[test]
fn straight_ahead_the_front_edge_touches_first() {
    // 4 − 2 − 0.25 = 1.75 m at 0.7 m/s.
    close(room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(0.7, 0.0), 3.0)), 2.5, 1e-5);
    // Backwards the same.
    close(
        room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(-0.7, 0.0), 3.0)),
        2.5,
        1e-5,
    );
    // Not within two seconds, and not at rest.
    assert_eq!(room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(0.7, 0.0), 2.0)), None);
    assert_eq!(room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(0.0, 0.0), 9.0)), None);
}

#[test]
fn turning_on_the_spot_a_corner_touches() {
    // 0.3 m from the wall y = 0; the corner at radius √2/4 reaches it when
    // cos(45° − θ) · √2/4 = 0.3, θ = 45° − acos(0.3 · 4/√2).
    let pose = Pose { x_m: 2.0, y_m: 0.3, theta_rad: 0.0 };
    let want = std::f64::consts::FRAC_PI_4 - (0.3 * 4.0 / 2f64.sqrt()).acos();
    close(room().first_contact_s(&pose, 0.0, &Course::constant(twist(0.0, 1.0), 3.0)), want, 1e-5);
}

#[test]
fn a_circle_of_half_a_metre_meets_the_side_wall() {
    // v = 0.5, ω = 1: the left corners sweep circles about (2, 1.5); the front right corner is
    // at distance hypot(0.75, 0.25) from that centre, the farthest, and y = 2 is met when
    // 1.5 + 0.790569 sin φ = 2, φ from atan2(−0.75, 0.25): after φ rises to asin(0.632456).
    let want = (0.5f64 / 0.75f64.hypot(0.25)).asin() - (-0.75f64).atan2(0.25);
    close(
        room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(0.5, 1.0), 3.0)),
        want,
        1e-5,
    );
}

#[test]
fn braking_needs_its_distance() {
    // 0.7 m/s held for 1 s and braked at 2 m/s²: 0.7 + 0.1225 m.
    let course = Course {
        from: twist(0.7, 0.0),
        to: twist(0.7, 0.0),
        delay_s: 0.0,
        hold_s: 1.0,
        accel: Some([2.0, 6.0]),
    };
    let before = |gap_m: f64| Pose { x_m: 3.75 - gap_m, ..MIDDLE };
    assert_eq!(room().first_contact_s(&before(0.8235), 0.0, &course), None);
    assert!(room().first_contact_s(&before(0.8205), 0.0, &course).is_some());
    // From rest the ramp takes 0.35 s and half of that way: 0.1225 m less.
    let started = Course { from: twist(0.0, 0.0), ..course };
    assert_eq!(room().first_contact_s(&before(0.701), 0.0, &started), None);
    assert!(room().first_contact_s(&before(0.698), 0.0, &started).is_some());
    // A delay of 0.1 s at the old speed, 0.7 m/s, is 0.07 m more for a request to stop.
    let stop = Course { to: twist(0.0, 0.0), delay_s: 0.1, ..course };
    assert_eq!(room().first_contact_s(&before(0.194), 0.0, &stop), None);
    assert!(room().first_contact_s(&before(0.191), 0.0, &stop).is_some());
}

#[test]
fn a_disc_that_comes_is_met_halfway() {
    let mut scenario = scenario();
    scenario.world.discs = vec![MovingDisc {
        radius_m: 0.2,
        from_m: [3.45, 1.0],
        to_m: [0.5, 1.0],
        speed_mps: 0.5,
        start_s: 0.0,
        to_and_fro: false,
    }];
    let surroundings = Surroundings::new(scenario.world, scenario.robot.footprint);
    // 3.45 − 0.2 − 2.25 = 1 m closed at 0.5 + 0.5 m/s.
    let course = Course::constant(twist(0.5, 0.0), 3.0);
    close(surroundings.first_contact_s(&MIDDLE, 0.0, &course), 1.0, 1e-5);
    // A second later the disc is half a metre nearer.
    close(surroundings.first_contact_s(&MIDDLE, 1.0, &course), 0.5, 1e-5);
}

#[test]
fn who_appears_close_by_is_seen() {
    let mut scenario = scenario();
    // There from 0.5 s on, before the robot's nose, and gone at 0.6 s.
    let points = vec![[0.5, 2.4, 1.0], [0.6, 2.4, 1.0]];
    scenario.world.paths = vec![schemas::WalkedPath { radius_m: 0.1, points }];
    let surroundings = Surroundings::new(scenario.world, scenario.robot.footprint);
    let course = Course { accel: Some([2.0, 6.0]), ..Course::constant(twist(0.1, 0.0), 1.0) };
    assert!(surroundings.touches(&MIDDLE, 0.0, &course, 0.75));
}

#[test]
fn contact_now_and_unknown_poses() {
    let outside = Pose { x_m: 0.1, ..MIDDLE };
    let course = Course::constant(twist(0.5, 0.0), 3.0);
    assert_eq!(room().first_contact_s(&outside, 0.0, &course), Some(0.0));
    let unknown = Pose { x_m: f64::NAN, ..MIDDLE };
    assert_eq!(room().first_contact_s(&unknown, 0.0, &course), None);
}

/// Every look that the shortcuts leave out, taken: the first instant of contact, or none.
fn look_everywhere(at: &Surroundings, pose: &Pose, t_s: f64, course: &Course) -> Option<f64> {
    let (end_s, mut here, mut tau_s) = (course.end_s().min(LONGEST_S), *pose, 0.0);
    let mut clearance_m = at.clearance_m(&here, t_s);
    while tau_s < end_s {
        let break_s = course.next_break_s(tau_s);
        let speeds = [tau_s, tau_s + LONGEST_RAMP_S].map(|s| at.speed_mps(course.twist(s)));
        let ramps = course.accel.is_some();
        let speed_mps = if ramps { speeds[0].max(speeds[1]) } else { speeds[0] };
        let longest_s = if ramps { LONGEST_RAMP_S } else { f64::INFINITY };
        let free_s = clearance_m / (speed_mps + at.fastest_disc_mps);
        let span_s = free_s.max(SHORTEST_S).min(longest_s).min(break_s - tau_s);
        let twist = course.twist(tau_s + 0.5 * span_s);
        let there = arc(&here, twist, span_s);
        clearance_m = at.clearance_m(&there, t_s + tau_s + span_s);
        if clearance_m <= 0.0 {
            return Some(tau_s + at.contact_within_s(&here, t_s + tau_s, twist, span_s));
        }
        here = there;
        tau_s = if span_s < break_s - tau_s { tau_s + span_s } else { break_s };
    }
    None
}

/// The contact that a stretch holds, found one by one.
fn step_by_step(at: &Surroundings, pose: &Pose, t_s: f64, course: &Course) -> Option<f64> {
    let touch = at.first_touch(pose, t_s, course, at.clearance_m(pose, t_s))?;
    let since_s = t_s + touch.tau_s;
    let within_s = at.contact_within_s(&touch.from, since_s, touch.twist, touch.span_s);
    Some(touch.tau_s + within_s)
}

/// In a hall 20 m from the wall, 3 m/s for 4 s and then for 4 s more; and in the room 0.7 m from it, 0.05 m/s
/// for 2 s and 0.16 m/s for 4 s, which lead there in 2 s and 0.6/0.16 s; and after 4 s of rest at 0.24 m/s 1.75 m
/// along a wall that is as near all the way, so that the body goes on before it has reached the other. On the
/// way the distance is not worked out where nothing can have come near.
#[test]
fn looks_that_are_left_out_change_nothing_later() {
    let mut hall = scenario();
    for (wall, offset_m) in hall.world.room.iter_mut().zip([30.0, 30.0, 20.25, 30.0]) {
        wall.offset_m = offset_m;
    }
    let hall = Surroundings::new(hall.world, hall.robot.footprint);
    let fast = twist(3.0, 0.0);
    let there = Course { from: fast, to: fast, delay_s: 4.0, hold_s: 4.0, accel: None };
    let (from, to) = (twist(0.05, 0.0), twist(0.16, 0.0));
    let slowly = Course { from, to, delay_s: 2.0, hold_s: 4.0, accel: None };
    let before = Pose { x_m: 3.05, ..MIDDLE };
    let (from, to) = (Twist::default(), twist(0.24, 0.0));
    let along = Course { from, to, delay_s: 4.0, hold_s: 8.0, accel: None };
    for (at, pose, course, want_s) in [
        (&hall, Pose::default(), there, 20.0 / 3.0),
        (&room(), before, slowly, 5.75),
        (&room(), MIDDLE, along, 4.0 + 1.75 / 0.24),
    ] {
        let got = step_by_step(at, &pose, 0.0, &course);
        close(got, want_s, 1e-6);
        assert_eq!(got, look_everywhere(at, &pose, 0.0, &course));
    }
}

/// At rest what was known to be clear by no more than the bound is taken back by is clear by nothing in the
/// end: that is looked at, and no contact.
#[test]
fn a_bound_that_is_used_up_is_no_contact() {
    let rest = Course::constant(Twist::default(), 1.0);
    assert!(room().first_touch(&MIDDLE, 0.0, &rest, CLEAR_M).is_none());
}

/// 1.75 m ahead is the wall: at 1 m/s the body touches it in the very middle of 3.5 s.
#[test]
fn to_reach_is_to_touch() {
    assert_eq!(room().contact_within_s(&MIDDLE, 0.0, twist(1.0, 0.0), 3.5), 1.75);
}

proptest! {
    #![proptest_config(ProptestConfig::with_cases(1000))]
    /// Looking only where something may be near finds the very same instants, to the bit.
    #[test]
    fn shortcuts_change_nothing(
        (x_m, y_m, theta_rad) in (0.3..3.7f64, 0.3..1.7f64, -4.0..4.0f64),
        from in (-0.7..0.7f64, -2.0..2.0f64),
        to in (-0.7..0.7f64, -2.0..2.0f64),
        delay_s in prop_oneof![Just(0.0), Just(0.15), Just(2.0)],
        hold_s in prop_oneof![Just(0.0), Just(1.0), Just(4.0)],
        accel in prop_oneof![Just(None), Just(Some([0.3, 1.0])), Just(Some([2.0, 6.0]))],
        disc in prop::option::of((0.5..3.5f64, 0.5..1.5f64, 0.0..1.0f64)),
        stands in prop::option::of((0.5..3.5f64, 0.5..1.5f64)),
    ) {
        let mut scenario = scenario();
        scenario.world.discs = disc.into_iter().map(|(x, y, speed_mps)| MovingDisc {
            radius_m: 0.2,
            from_m: [x, y],
            to_m: [2.0, 1.0],
            speed_mps,
            start_s: 0.0,
            to_and_fro: true,
        }).collect();
        scenario.world.obstacles = stands.into_iter().map(|(x, y)| block(x, y)).collect();
        let surroundings = Surroundings::new(scenario.world, scenario.robot.footprint);
        let pose = Pose { x_m, y_m, theta_rad };
        let (from, to) = (twist(from.0, from.1), twist(to.0, to.1));
        let course = Course { from, to, delay_s, hold_s, accel };
        let clearance_m = surroundings.clearance_m(&pose, 0.3);
        prop_assume!(clearance_m > 0.0);
        let want = look_everywhere(&surroundings, &pose, 0.3, &course);
        // Also where nothing is certain beforehand.
        prop_assert_eq!(step_by_step(&surroundings, &pose, 0.3, &course), want);
        prop_assert_eq!(surroundings.first_contact_s(&pose, 0.3, &course), want);
        prop_assert_eq!(surroundings.touches(&pose, 0.3, &course, clearance_m), want.is_some());
    }
}

/// The clearance of 0.75 m is not used up by 0.5 m/s within 1.49 s, and is within 1.51; half of that where a
/// disc comes at 0.5 m/s. A quarter of a second of it is braking.
#[test]
fn what_is_too_far_away_is_certainly_clear() {
    let certain = |discs: Vec<MovingDisc>, from: Twist, to: Twist, hold_s: f64, accel: [f64; 2]| {
        let mut scenario = scenario();
        scenario.world.discs = discs;
        let at = Surroundings::new(scenario.world, scenario.robot.footprint);
        let course = Course { from, to, delay_s: 0.0, hold_s, accel: Some(accel) };
        at.certainly_touches(&MIDDLE, 0.0, &course, 0.75)
    };
    let (ahead, rest) = (twist(0.5, 0.0), Twist::default());
    let disc = MovingDisc {
        radius_m: 0.1,
        from_m: [0.3, 0.3],
        to_m: [0.3, 1.7],
        speed_mps: 0.5,
        start_s: 0.0,
        to_and_fro: true,
    };
    for (less_s, want) in [(0.01, Some(false)), (-0.01, None)] {
        assert_eq!(certain(vec![], ahead, ahead, 1.25 - less_s, [2.0, 6.0]), want);
        // The faster of the speeds now and those asked for, to which the ramp takes a quarter of a second.
        assert_eq!(certain(vec![], rest, ahead, 1.25 - less_s, [2.0, 6.0]), want);
        assert_eq!(certain(vec![], ahead, rest, 1.5 - less_s, [2.0, 6.0]), want);
        assert_eq!(certain(vec![disc], ahead, ahead, 0.5 - less_s, [2.0, 6.0]), want);
    }
    // What is just used up is not certain.
    let course = Course { accel: Some([2.0, 6.0]), ..Course::constant(ahead, 1.25) };
    let border = room().certainly_touches(&MIDDLE, 0.0, &course, CLEAR_M + 0.5 * 1.5);
    assert_eq!(border, None);
    // Who cannot brake is not spoken of.
    assert_eq!(certain(vec![], rest, twist(0.01, 0.0), 1.0, [0.0, 6.0]), None);
}

/// 1.75 m ahead is a wall: 0.7 m/s lead there in 2.5 s, 0.1 m/s in 17.5 s. Nobody looks farther than 20 s.
#[test]
fn speeds_that_jump_are_certain_one_after_the_other() {
    let certain = |from: Twist, delay_s: f64, to: Twist, hold_s: f64| {
        let course = Course { from, to, delay_s, hold_s, accel: None };
        room().certainly_touches(&MIDDLE, 0.0, &course, 0.75)
    };
    let (fast, slow, rest) = (twist(0.7, 0.0), twist(0.1, 0.0), Twist::default());
    for (hold_s, want) in [(1.49, Some(false)), (1.51, Some(true))] {
        assert_eq!(certain(fast, 1.0, fast, hold_s), want);
        assert_eq!(certain(fast, 1.0 + hold_s, rest, 0.0), want);
        assert_eq!(certain(rest, 1.0, fast, 1.0 + hold_s), want);
    }
    assert_eq!(certain(rest, 0.0, slow, 20.0), Some(true));
    assert_eq!(certain(rest, 0.0, slow, 20.5), None);
}

/// The body waits for a second, then drives at 0.5 m/s at a disc that comes at 0.5 m/s from 1.15 m ahead: they
/// meet at 1.65 s.
#[test]
fn who_waits_is_met_by_those_who_come() {
    let mut scenario = scenario();
    scenario.world.discs = vec![MovingDisc {
        radius_m: 0.2,
        from_m: [3.6, 1.0],
        to_m: [0.5, 1.0],
        speed_mps: 0.5,
        start_s: 0.0,
        to_and_fro: false,
    }];
    let at = Surroundings::new(scenario.world, scenario.robot.footprint);
    for (hold_s, want) in [(0.64, false), (0.66, true)] {
        let to = twist(0.5, 0.0);
        let course = Course { from: Twist::default(), to, delay_s: 1.0, hold_s, accel: None };
        assert_eq!(at.certainly_touches(&MIDDLE, 0.0, &course, 0.75), Some(want));
    }
}

/// A disc that would be met half a millisecond after the course is over is not met.
#[test]
fn what_comes_after_the_end_does_not_count() {
    let mut scenario = scenario();
    scenario.world.discs = vec![MovingDisc {
        radius_m: 0.2,
        from_m: [2.7, 1.0],
        to_m: [0.5, 1.0],
        speed_mps: 0.5,
        start_s: 0.5,
        to_and_fro: false,
    }];
    let at = Surroundings::new(scenario.world, scenario.robot.footprint);
    let until = |end_s: f64| {
        let rest = Course::constant(Twist::default(), end_s);
        at.first_contact_s(&MIDDLE, 0.0, &Course { accel: Some([2.0, 6.0]), ..rest })
    };
    assert_eq!(until(0.9995), None);
    close(until(1.0005), 1.0, 1e-5);
}

/// Who appears out of nothing may do so anywhere.
#[test]
fn what_cannot_be_vouched_for_is_not_certain() {
    let mut scenario = scenario();
    let points = vec![[0.5, 2.4, 1.0], [0.6, 2.4, 1.0]];
    scenario.world.paths = vec![schemas::WalkedPath { radius_m: 0.1, points }];
    let at = Surroundings::new(scenario.world, scenario.robot.footprint);
    assert_eq!(
        at.certainly_touches(&MIDDLE, 0.0, &Course::constant(twist(0.1, 0.0), 0.1), 0.75),
        None
    );
}
