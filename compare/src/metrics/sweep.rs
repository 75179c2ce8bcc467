//! Where a body would be if it went on like that, and when it would touch something.
//!
//! The body follows a course of speeds; its clearance is asked for no more often than needed: no
//! point of it can come nearer to anything than its own speed and that of the fastest disc allow
//! (conservative advancement, Mirtich 1996), so that much time is safely skipped.

use schemas::{Footprint, Pose, Twist, World};

use super::certain::Certain;

/// Shortest stretch that is skipped, seconds: at 1 m/s contacts shallower than 2 mm may be passed
/// over.
pub(super) const SHORTEST_S: f64 = 2e-3;

/// Longest stretch over which changing speeds are taken at their middle, seconds.
const LONGEST_RAMP_S: f64 = 0.05;

/// Longest course that is looked at, seconds: braking from full speed at 0.3 m/s² takes three.
const LONGEST_S: f64 = 20.0;

/// How often the instant of a contact is halved down: to below a microsecond.
const HALVINGS: u32 = 12;

/// What a bound of a clearance is taken back by, metres: far above rounding.
const CLEAR_M: f64 = 1e-6;

/// What there is to touch, and what touches it.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    world: World,
    footprint: Footprint,
    reach_m: f64,
    fastest_disc_mps: f64,
    certain: Certain,
}

/// A body on its way, as far as it is known to be clear.
struct Way {
    here: Pose,
    /// Seconds from the start of the course.
    tau_s: f64,
    /// When the body is there, seconds from the start of the run.
    at_s: f64,
    /// Its clearance there, metres, or what it is at least.
    clearance_m: f64,
    exact: bool,
}

/// A stretch in which something is touched.
struct Touch {
    from: Pose,
    /// Seconds from the start of the course.
    tau_s: f64,
    twist: Twist,
    span_s: f64,
}

/// Speeds over time, from now on.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    /// Speeds now.
    pub(super) from: Twist,
    /// Speeds that are asked for.
    pub(super) to: Twist,
    /// When the request takes effect, seconds from now.
    pub(super) delay_s: f64,
    /// How long it is held after that, seconds; then the robot brakes to rest.
    pub(super) hold_s: f64,
    /// Largest accelerations, m/s² and rad/s²; `None` where speeds change at once.
    pub(super) accel: Option<[f64; 2]>,
}

impl Course {
    /// The same speeds for that long.
    pub(super) fn constant(twist: Twist, for_s: f64) -> Course {
        Course { from: twist, to: twist, delay_s: 0.0, hold_s: for_s, accel: None }
    }

    fn brakes_from_s(&self) -> f64 {
        self.delay_s + self.hold_s
    }

    /// When the robot is at rest, or the course over.
    fn end_s(&self) -> f64 {
        let Some([accel, alpha]) = self.accel else { return self.brakes_from_s() };
        let Twist { v_mps, omega_radps } = self.held(self.brakes_from_s());
        let braking_s = (libm::fabs(v_mps) / accel).max(libm::fabs(omega_radps) / alpha);
        self.brakes_from_s() + braking_s
    }

    /// Speeds at an instant before the braking.
    fn held(&self, tau_s: f64) -> Twist {
        if tau_s < self.delay_s {
            return self.from;
        }
        let Some([accel, alpha]) = self.accel else { return self.to };
        let since_s = tau_s - self.delay_s;
        Twist {
            v_mps: towards(self.from.v_mps, self.to.v_mps, accel * since_s),
            omega_radps: towards(self.from.omega_radps, self.to.omega_radps, alpha * since_s),
        }
    }

    fn twist(&self, tau_s: f64) -> Twist {
        let brakes_from_s = self.brakes_from_s();
        if tau_s < brakes_from_s {
            return self.held(tau_s);
        }
        let Some([accel, alpha]) = self.accel else { return Twist::default() };
        let since_s = tau_s - brakes_from_s;
        let held = self.held(brakes_from_s);
        Twist {
            v_mps: towards(held.v_mps, 0.0, accel * since_s),
            omega_radps: towards(held.omega_radps, 0.0, alpha * since_s),
        }
    }

    /// The next instant after `tau_s` at which speeds may jump.
    fn next_break_s(&self, tau_s: f64) -> f64 {
        [self.delay_s, self.brakes_from_s(), self.end_s()]
            .into_iter()
            .filter(|at_s| *at_s > tau_s)
            .fold(f64::INFINITY, f64::min)
    }
}

/// `value` moved towards `target` by at most `most`.
fn towards(value: f64, target: f64, most: f64) -> f64 {
    if target > value { (value + most).min(target) } else { (value - most).max(target) }
}

/// The pose after a stretch of constant speeds: along the chord of the circle.
pub(super) fn arc(pose: &Pose, twist: Twist, span_s: f64) -> Pose {
    let half_rad = 0.5 * twist.omega_radps * span_s;
    // sin x / x, by its series where the quotient would lose digits.
    let sinc = if libm::fabs(half_rad) < 1e-4 {
        1.0 - half_rad * half_rad / 6.0
    } else {
        libm::sin(half_rad) / half_rad
    };
    let chord_m = twist.v_mps * span_s * sinc;
    let (sin, cos) = libm::sincos(pose.theta_rad + half_rad);
    Pose {
        x_m: pose.x_m + chord_m * cos,
        y_m: pose.y_m + chord_m * sin,
        theta_rad: pose.theta_rad + 2.0 * half_rad,
    }
}

impl Surroundings {
    pub(super) fn new(world: World, footprint: Footprint) -> Surroundings {
        let discs = world.discs.iter().map(|disc| libm::fabs(disc.speed_mps));
        let paths = world.paths.iter().map(schemas::WalkedPath::speed_mps);
        let fastest_disc_mps = discs.chain(paths).fold(0.0, f64::max);
        let reach_m = footprint.circumscribed_radius_m();
        let certain = Certain::new(&world, footprint);
        Surroundings { world, footprint, reach_m, fastest_disc_mps, certain }
    }

    /// Whether there is anything to touch.
    pub(super) fn is_empty(&self) -> bool {
        self.world.is_empty()
    }

    /// Fastest that any point of the body moves, m/s.
    fn speed_mps(&self, twist: Twist) -> f64 {
        libm::fabs(twist.v_mps) + libm::fabs(twist.omega_radps) * self.reach_m
    }

    /// Signed clearance of the body at that pose and time, metres.
    pub(super) fn clearance_m(&self, pose: &Pose, t_s: f64) -> f64 {
        self.world.clearance_m(&self.footprint, pose, t_s)
    }

    /// The first instant of contact on a course that begins at `pose` and time `t_s`, seconds from
    /// then; `None` where there is none, or where the pose is not known.
    pub(super) fn first_contact_s(&self, pose: &Pose, t_s: f64, course: &Course) -> Option<f64> {
        let clearance_m = self.clearance_m(pose, t_s);
        if clearance_m <= 0.0 {
            return Some(0.0);
        }
        if self.certainly_touches(pose, t_s, course, clearance_m) == Some(false) {
            return None;
        }
        let touch = self.first_touch(pose, t_s, course, clearance_m)?;
        let since_s = t_s + touch.tau_s;
        let within_s = self.contact_within_s(&touch.from, since_s, touch.twist, touch.span_s);
        Some(touch.tau_s + within_s)
    }

    /// Whether there is a first contact on that course, where the clearance at its start is known.
    pub(super) fn touches(&self, pose: &Pose, t_s: f64, course: &Course, clearance_m: f64) -> bool {
        if clearance_m <= 0.0 {
            return true;
        }
        self.certainly_touches(pose, t_s, course, clearance_m)
            .unwrap_or_else(|| self.first_touch(pose, t_s, course, clearance_m).is_some())
    }

    /// Whether there is a contact, where that is certain without going step by step.
    fn certainly_touches(
        &self,
        pose: &Pose,
        t_s: f64,
        course: &Course,
        clearance_m: f64,
    ) -> Option<bool> {
        let ramps = course.accel.is_none_or(|accel| accel.iter().all(|most| *most > 0.0));
        if !self.certain.is_sound() || !ramps {
            return None;
        }
        let end_s = course.end_s().min(LONGEST_S);
        // Ramped speeds stay between those now and those asked for, or slow down.
        let speed_mps = self.speed_mps(course.from).max(self.speed_mps(course.to));
        if clearance_m > CLEAR_M + (speed_mps + self.fastest_disc_mps) * end_s {
            return Some(false);
        }
        if course.accel.is_some() || course.end_s() > LONGEST_S {
            return None;
        }
        let (mut here, mut since_s) = (*pose, t_s);
        for (twist, span_s) in [(course.from, course.delay_s), (course.to, course.hold_s)] {
            if span_s > 0.0 {
                if self.certain.touches(&self.world, &here, since_s, twist, span_s)? {
                    return Some(true);
                }
                (here, since_s) = (arc(&here, twist, span_s), since_s + span_s);
            }
        }
        Some(false)
    }

    /// The first stretch of a course that ends in contact.
    fn first_touch(
        &self,
        pose: &Pose,
        t_s: f64,
        course: &Course,
        clearance_m: f64,
    ) -> Option<Touch> {
        let end_s = course.end_s().min(LONGEST_S);
        let mut way = Way { here: *pose, tau_s: 0.0, at_s: t_s, clearance_m, exact: true };
        while way.tau_s < end_s {
            let Way { here, tau_s, .. } = way;
            let break_s = course.next_break_s(tau_s);
            let mut speed_mps = self.speed_mps(course.twist(tau_s));
            let mut longest_s = f64::INFINITY;
            if course.accel.is_some() {
                // On a ramp speeds stay below those at its two ends.
                longest_s = LONGEST_RAMP_S;
                speed_mps = speed_mps.max(self.speed_mps(course.twist(tau_s + longest_s)));
            }
            let closing_mps = speed_mps + self.fastest_disc_mps;
            let most_s = longest_s.min(break_s - tau_s);
            // How near anything is matters only where that shortens the stretch.
            if !way.exact && way.clearance_m <= CLEAR_M + closing_mps * most_s {
                way.clearance_m = self.clearance_m(&here, way.at_s);
            }
            if way.clearance_m.is_nan() {
                return None;
            }
            let free_s = way.clearance_m / closing_mps;
            let span_s = free_s.max(SHORTEST_S).min(longest_s).min(break_s - tau_s);
            let twist = course.twist(tau_s + 0.5 * span_s);
            let there = arc(&here, twist, span_s);
            let at_s = t_s + tau_s + span_s;
            let closed_m = (self.speed_mps(twist) + self.fastest_disc_mps) * span_s;
            let at_least_m = way.clearance_m - closed_m - CLEAR_M;
            let exact = !(at_least_m > 0.0 && there.is_finite() && self.certain.is_sound());
            let clearance_m = if exact { self.clearance_m(&there, at_s) } else { at_least_m };
            if clearance_m <= 0.0 {
                return Some(Touch { from: here, tau_s, twist, span_s });
            }
            let tau_s = if span_s < break_s - tau_s { tau_s + span_s } else { break_s };
            way = Way { here: there, tau_s, at_s, clearance_m, exact };
        }
        None
    }

    /// The instant of contact within a stretch that begins clear and ends in contact.
    fn contact_within_s(&self, pose: &Pose, t_s: f64, twist: Twist, span_s: f64) -> f64 {
        let (mut clear_s, mut contact_s) = (0.0, span_s);
        for _ in 0..HALVINGS {
            let middle_s = 0.5 * (clear_s + contact_s);
            if self.clearance_m(&arc(pose, twist, middle_s), t_s + middle_s) > 0.0 {
                clear_s = middle_s;
            } else {
                contact_s = middle_s;
            }
        }
        contact_s
    }
}

#[cfg(test)]
mod tests {
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
        close(
            room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(0.7, 0.0), 3.0)),
            2.5,
            1e-5,
        );
        // Backwards the same.
        close(
            room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(-0.7, 0.0), 3.0)),
            2.5,
            1e-5,
        );
        // Not within two seconds, and not at rest.
        assert_eq!(
            room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(0.7, 0.0), 2.0)),
            None
        );
        assert_eq!(
            room().first_contact_s(&MIDDLE, 0.0, &Course::constant(twist(0.0, 0.0), 9.0)),
            None
        );
    }

    #[test]
    fn turning_on_the_spot_a_corner_touches() {
        // 0.3 m from the wall y = 0; the corner at radius √2/4 reaches it when
        // cos(45° − θ) · √2/4 = 0.3, θ = 45° − acos(0.3 · 4/√2).
        let pose = Pose { x_m: 2.0, y_m: 0.3, theta_rad: 0.0 };
        let want = std::f64::consts::FRAC_PI_4 - (0.3 * 4.0 / 2f64.sqrt()).acos();
        close(
            room().first_contact_s(&pose, 0.0, &Course::constant(twist(0.0, 1.0), 3.0)),
            want,
            1e-5,
        );
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

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(1000))]
        /// Looking only where something may be near finds the very same instants, to the bit.
        #[test]
        fn shortcuts_change_nothing(
            (x_m, y_m, theta_rad) in (0.3..3.7f64, 0.3..1.7f64, -4.0..4.0f64),
            from in (-0.7..0.7f64, -2.0..2.0f64),
            to in (-0.7..0.7f64, -2.0..2.0f64),
            delay_s in prop_oneof![Just(0.0), Just(0.15)],
            hold_s in prop_oneof![Just(0.0), Just(1.0)],
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
            prop_assert_eq!(surroundings.first_contact_s(&pose, 0.3, &course), want);
            prop_assert_eq!(surroundings.touches(&pose, 0.3, &course, clearance_m), want.is_some());
        }
    }
}
