//! Where a body would be if it went on like that, and when it would touch something.
//!
//! The body follows a course of speeds; its clearance is asked for no more often than needed: no
//! point of it can come nearer to anything than its own speed and that of the fastest disc allow
//! (conservative advancement, Mirtich 1996), so that much time is safely skipped.

use schemas::{Footprint, Pose, Twist, World};

/// Shortest stretch that is skipped, seconds: at 1 m/s contacts shallower than 2 mm may be passed
/// over.
const SHORTEST_S: f64 = 2e-3;

/// Longest stretch over which changing speeds are taken at their middle, seconds.
const LONGEST_RAMP_S: f64 = 0.05;

/// Longest course that is looked at, seconds: braking from full speed at 0.3 m/s² takes three.
const LONGEST_S: f64 = 20.0;

/// How often the instant of a contact is halved down: to below a microsecond.
const HALVINGS: u32 = 12;

/// What there is to touch, and what touches it.
#[derive(Clone, Debug)]
pub(super) struct Surroundings {
    world: World,
    footprint: Footprint,
    reach_m: f64,
    fastest_disc_mps: f64,
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
fn arc(pose: &Pose, twist: Twist, span_s: f64) -> Pose {
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
        Surroundings { world, footprint, reach_m, fastest_disc_mps }
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
        let end_s = course.end_s().min(LONGEST_S);
        let (mut here, mut tau_s) = (*pose, 0.0);
        let mut clearance_m = self.clearance_m(&here, t_s);
        if clearance_m <= 0.0 {
            return Some(0.0);
        }
        while tau_s < end_s && !clearance_m.is_nan() {
            let break_s = course.next_break_s(tau_s);
            let mut speed_mps = self.speed_mps(course.twist(tau_s));
            let mut longest_s = f64::INFINITY;
            if course.accel.is_some() {
                // On a ramp speeds stay below those at its two ends.
                longest_s = LONGEST_RAMP_S;
                speed_mps = speed_mps.max(self.speed_mps(course.twist(tau_s + longest_s)));
            }
            let free_s = clearance_m / (speed_mps + self.fastest_disc_mps);
            let span_s = free_s.max(SHORTEST_S).min(longest_s).min(break_s - tau_s);
            let twist = course.twist(tau_s + 0.5 * span_s);
            let there = arc(&here, twist, span_s);
            clearance_m = self.clearance_m(&there, t_s + tau_s + span_s);
            if clearance_m <= 0.0 {
                return Some(tau_s + self.contact_within_s(&here, t_s + tau_s, twist, span_s));
            }
            here = there;
            tau_s = if span_s < break_s - tau_s { tau_s + span_s } else { break_s };
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
    use crate::synthetic::scenario;
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
    fn contact_now_and_unknown_poses() {
        let outside = Pose { x_m: 0.1, ..MIDDLE };
        let course = Course::constant(twist(0.5, 0.0), 3.0);
        assert_eq!(room().first_contact_s(&outside, 0.0, &course), Some(0.0));
        let unknown = Pose { x_m: f64::NAN, ..MIDDLE };
        assert_eq!(room().first_contact_s(&unknown, 0.0, &course), None);
    }
}
