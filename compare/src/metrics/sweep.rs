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
    target.max(value - most).min(value + most)
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
mod tests;
