//! The target `p_d`: where the robot should be.
//!
//! In: the task, or the person's request. Out: position and velocity of the target, and where it
//! will be a little later (specification §§5–7).

use schemas::{Pose, ReferenceSource, Task};

use crate::params::choice;

/// Displacements shorter than this have no direction, metres (specification §5).
pub const UNDERFOOT_M: f64 = 1e-3;

choice! {
    /// What becomes of the target that is predicted from the joystick while the feedback law drives.
    PredictedTarget {
        /// It goes and turns with the robot.
        Follows = "follows",
        /// It stays where it was when the feedback law took over, until the person asks for something
        /// else.
        Stays = "stays",
    }
}

/// Where the robot should be.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Target {
    /// Where this came from.
    pub source: ReferenceSource,
    /// `p_d`, metres.
    pub position_m: [f64; 2],
    /// Its velocity, m/s.
    pub velocity_mps: [f64; 2],
    /// Where the person wants to be in a while: `p_d` of later.
    pub intent_m: [f64; 2],
}

impl Target {
    /// The task's target `t_s` seconds after the start; the intent is where it will be `intent_s`
    /// later.
    pub fn of_task(task: &Task, t_s: f64, intent_s: f64) -> Target {
        let (position_m, velocity_mps) = task.target(t_s);
        let (intent_m, _) = task.target(t_s + intent_s);
        Target { source: ReferenceSource::Task, position_m, velocity_mps, intent_m }
    }

    /// The end of the arc that the person asks for, driven for `prediction_s` from `pose`; at rest
    /// (Case III): Δ = v T sinc(ωT/2) at the angle θ + ωT/2.
    pub fn of_joystick(pose: &Pose, v_mps: f64, omega_radps: f64, prediction_s: f64) -> Target {
        let half_turn_rad = 0.5 * omega_radps * prediction_s;
        let sinc =
            if half_turn_rad == 0.0 { 1.0 } else { libm::sin(half_turn_rad) / half_turn_rad };
        let length_m = v_mps * prediction_s * sinc;
        let (sin, cos) = libm::sincos(pose.theta_rad + half_turn_rad);
        let position_m = [pose.x_m + length_m * cos, pose.y_m + length_m * sin];
        Target {
            source: ReferenceSource::Joystick,
            position_m,
            velocity_mps: [0.0; 2],
            intent_m: position_m,
        }
    }

    /// Where the robot is: nobody asks for anything.
    pub fn hold(pose: &Pose) -> Target {
        let position_m = pose.position_m();
        Target {
            source: ReferenceSource::Hold,
            position_m,
            velocity_mps: [0.0; 2],
            intent_m: position_m,
        }
    }

    /// Whether it follows from what the person asks for and not from a task.
    pub fn predicted(&self) -> bool {
        self.source == ReferenceSource::Joystick
    }

    /// Displacement from `pose` to the target, metres, world axes.
    pub fn displacement_m(&self, pose: &Pose) -> [f64; 2] {
        [self.position_m[0] - pose.x_m, self.position_m[1] - pose.y_m]
    }
}

/// World angle of a vector, radians; `None` if it is no longer than `least`.
pub fn direction_rad(vector: [f64; 2], least: f64) -> Option<f64> {
    let [x, y] = vector;
    (libm::hypot(x, y) > least).then(|| libm::atan2(y, x))
}

#[cfg(test)]
mod tests {
    use std::f64::consts::FRAC_PI_2;

    use super::*;

    const POSE: Pose = Pose { x_m: 1.0, y_m: 2.0, theta_rad: FRAC_PI_2 };

    fn near(a: [f64; 2], b: [f64; 2]) -> bool {
        libm::hypot(a[0] - b[0], a[1] - b[1]) < 1e-12
    }

    /// Straight on: v T ahead. A quarter turn: the corner of the square about the turning circle.
    #[test]
    fn the_joystick_predicts_the_end_of_its_arc() {
        let straight = Target::of_joystick(&POSE, 0.4, 0.0, 1.5);
        assert!(near(straight.position_m, [1.0, 2.6]), "{straight:?}");
        assert_eq!(straight.velocity_mps, [0.0; 2]);
        let omega = FRAC_PI_2 / 1.5;
        let left = Target::of_joystick(&POSE, 0.5 * omega, omega, 1.5);
        assert!(near(left.position_m, [0.5, 2.5]), "{left:?}");
        let back = Target::of_joystick(&POSE, -0.4, 0.0, 1.5);
        assert!(near(back.position_m, [1.0, 1.4]), "{back:?}");
        assert!(straight.predicted());
    }

    /// The intent runs ahead of the target and stops where it stops.
    #[test]
    fn the_tasks_intent_runs_ahead() {
        let task = Task { from_m: [0.0, 0.0], velocity_mps: [0.1, 0.0], until_s: 10.0 };
        let moving = Target::of_task(&task, 5.0, 2.0);
        assert!(near(moving.position_m, [0.5, 0.0]) && near(moving.intent_m, [0.7, 0.0]));
        assert_eq!(moving.velocity_mps, [0.1, 0.0]);
        let ending = Target::of_task(&task, 9.0, 2.0);
        assert!(near(ending.intent_m, [1.0, 0.0]));
        let ended = Target::of_task(&task, 11.0, 2.0);
        assert!(near(ended.position_m, [1.0, 0.0]));
        assert_eq!(ended.velocity_mps, [0.0; 2]);
        assert!(!ended.predicted());
    }

    #[test]
    fn what_is_underfoot_has_no_direction() {
        assert_eq!(direction_rad([0.0, 0.0], 0.0), None);
        assert_eq!(direction_rad([0.0, 9e-4], UNDERFOOT_M), None);
        assert_eq!(direction_rad([0.0, 2e-3], UNDERFOOT_M), Some(FRAC_PI_2));
        assert_eq!(direction_rad([f64::NAN, 1.0], UNDERFOOT_M), None);
        assert_eq!(Target::hold(&POSE).displacement_m(&POSE), [0.0; 2]);
    }
}
