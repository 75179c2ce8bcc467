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

use schemas::{Pose, Task};

use crate::angle::wrap;

/// A person with a task looks this far ahead of its target, seconds. The joystick does not tell how
/// far a person looks ahead; this is the usual preview of manual tracking.
const TASK_AHEAD_S: f64 = 2.0;

/// Nearer than this a goal has no bearing, metres.
const UNDERFOOT_M: f64 = 1e-6;

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
    let error_rad = wrap(if backwards { ahead_rad + core::f64::consts::PI } else { ahead_rad });
    let facing = libm::cos(error_rad).max(0.0);
    let near = (distance_m / habits.slow_m).min(1.0);
    let cruise_mps = if backwards { -habits.backward_mps } else { habits.forward_mps };
    let turn = gains.k_theta * error_rad;
    [cruise_mps * facing * near, turn.clamp(-habits.turn_radps, habits.turn_radps)]
}
