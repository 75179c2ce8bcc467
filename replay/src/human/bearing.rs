//! The reaction law that recorded people are fitted with: steer by the bearing of a goal.
//!
//! With e the bearing of the goal from where the robot points (from its tail when backing up) and d
//! its distance,
//!
//! ```text
//! ω = clip(k_θ e, ω_cap)        v = ± cruise · max(cos e, 0) · min(d / d_slow, 1)
//! ```
//!
//! seen as it was one reaction time ago. It is a family to compare people with, not a claim about
//! them: what it leaves unexplained is carried as the residual.

use schemas::{Pose, Task, wrap};

/// A person with a task looks this far ahead of its target, seconds. The joystick does not tell how
/// far a person looks ahead; this is the usual preview of manual tracking.
const TASK_AHEAD_S: f64 = 2.0;

/// Nearer than this a goal has no bearing, metres.
const UNDERFOOT_M: f64 = 1e-6;

/// Farther than this along an axis a goal surely has one, metres.
const ASTRIDE_M: f64 = 1e-3;

/// More than this many slow distances away along an axis nobody slows down for a goal.
const FAR: f64 = 1.01;

/// How strongly and how late a person reacts. Pooled over logs: a single one says too little.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Turn rate asked for per radian of bearing, 1/s.
    pub k_theta: f64,
    /// Reaction time, seconds.
    pub delay_s: f64,
}

impl Gains {
    /// Where no log has been looked at: crossover models of manual steering have gains of 1 to 3
    /// per second and reaction times of 0.15 to 0.4 s.
    pub const PRIOR: Gains = Gains { k_theta: 1.5, delay_s: 0.2 };
}

impl Default for Gains {
    fn default() -> Self {
        Gains::PRIOR
    }
}

/// What is one person's own: their habits as their log shows them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Habits {
    /// Speed on a free way forwards, m/s.
    pub(super) forward_mps: f64,
    /// Speed backwards, m/s.
    pub(super) backward_mps: f64,
    /// Fastest turn that they ask for, rad/s.
    pub(super) turn_radps: f64,
    /// Distance from which they slow down for a goal, metres.
    pub(super) slow_m: f64,
}

/// What a person may be after.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Goal {
    /// To be at a point.
    At([f64; 2]),
    /// To back up to a point.
    BackTo([f64; 2]),
    /// To follow the task's target.
    Follow(Task),
    /// To stay.
    Rest,
}

/// What the law asks for, [m/s, rad/s], at `pose` for `goal`, `t_s` after the start.
pub(super) fn ask(gains: &Gains, habits: &Habits, goal: &Goal, pose: &Pose, t_s: f64) -> [f64; 2] {
    let (at_m, backwards) = match goal {
        Goal::At(at_m) => (*at_m, false),
        Goal::BackTo(at_m) => (*at_m, true),
        Goal::Follow(task) => (task.target(t_s + TASK_AHEAD_S).0, false),
        Goal::Rest => return [0.0; 2],
    };
    let way_m = [at_m[0] - pose.x_m, at_m[1] - pose.y_m];
    let distance_m = libm::hypot(way_m[0], way_m[1]);
    if distance_m.is_nan() || distance_m < UNDERFOOT_M {
        return [0.0; 2];
    }
    let ahead_rad = libm::atan2(way_m[1], way_m[0]) - pose.theta_rad;
    let near = (distance_m / habits.slow_m).min(1.0);
    let error_rad = error_rad(ahead_rad, backwards);
    [speed_mps(habits, error_rad, near, backwards), turn_radps(gains, habits, error_rad)]
}

/// The bearing from where the robot points, or from its tail.
fn error_rad(ahead_rad: f64, backwards: bool) -> f64 {
    wrap(if backwards { ahead_rad + core::f64::consts::PI } else { ahead_rad })
}

fn speed_mps(habits: &Habits, error_rad: f64, near: f64, backwards: bool) -> f64 {
    let facing = libm::cos(error_rad).max(0.0);
    let cruise_mps = if backwards { -habits.backward_mps } else { habits.forward_mps };
    cruise_mps * facing * near
}

fn turn_radps(gains: &Gains, habits: &Habits, error_rad: f64) -> f64 {
    let turn = gains.k_theta * error_rad;
    turn.clamp(-habits.turn_radps, habits.turn_radps)
}

/// What the law asks for at `pose` for a point ahead and for backing up to it, each as `judge` sees it:
/// the turn first, which often settles it, then the speed.
///
/// The same numbers as [`ask`] gives, with less work; `None` where only [`ask`] can tell.
pub(super) fn ask_both<A>(
    gains: &Gains,
    habits: &Habits,
    at_m: [f64; 2],
    pose: &Pose,
    judge: impl Fn(f64, &dyn Fn() -> f64) -> A,
) -> Option<[A; 2]> {
    let way_m = [at_m[0] - pose.x_m, at_m[1] - pose.y_m];
    let along_m = way_m[0].abs().max(way_m[1].abs());
    if along_m.is_nan() || along_m < ASTRIDE_M {
        return None;
    }
    let near = || {
        if along_m >= FAR * habits.slow_m {
            1.0
        } else {
            (libm::hypot(way_m[0], way_m[1]) / habits.slow_m).min(1.0)
        }
    };
    let ahead_rad = libm::atan2(way_m[1], way_m[0]) - pose.theta_rad;
    Some([false, true].map(|backwards| {
        let error_rad = error_rad(ahead_rad, backwards);
        let speed_mps = || speed_mps(habits, error_rad, near(), backwards);
        judge(turn_radps(gains, habits, error_rad), &speed_mps)
    }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        /// Both ways together are the law itself, to the bit.
        #[test]
        fn both_ways_together_are_the_law(
            at_m in prop::array::uniform2(prop_oneof![-4.0..4.0f64, -0.01..0.01f64, Just(0.0)]),
            (x_m, y_m, theta_rad) in (-0.5..0.5f64, -0.5..0.5f64, -9.0..9.0f64),
            (k_theta, slow_m) in (0.7..3.0f64, prop_oneof![Just(0.5), 0.001..2.0f64]),
        ) {
            let gains = Gains { k_theta, delay_s: 0.0 };
            let habits =
                Habits { forward_mps: 0.4, backward_mps: 0.2, turn_radps: 1.1, slow_m };
            let pose = Pose { x_m, y_m, theta_rad };
            let both = ask_both(&gains, &habits, at_m, &pose, |turn, speed| [speed(), turn]);
            let alone = [Goal::At(at_m), Goal::BackTo(at_m)]
                .map(|goal| ask(&gains, &habits, &goal, &pose, 0.0).map(f64::to_bits));
            if let Some(both) = both {
                prop_assert_eq!(both.map(|asked| asked.map(f64::to_bits)), alone);
            }
        }
    }

    /// Underfoot there is no bearing: that is left to the law.
    #[test]
    fn underfoot_is_left_to_the_law() {
        let habits = Habits { forward_mps: 0.4, backward_mps: 0.2, turn_radps: 1.1, slow_m: 0.5 };
        let of = |at_m| {
            ask_both(&Gains::PRIOR, &habits, at_m, &Pose::default(), |turn, _| turn).is_some()
        };
        assert!(of([0.0, 0.002]));
        assert!(!of([0.0, 0.0005]));
        assert!(!of([f64::NAN, f64::NAN]));
    }
}
