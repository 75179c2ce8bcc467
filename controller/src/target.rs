//! The target `p_d`: where the robot should be.
//!
//! In: the task, or the person's request. Out: position and velocity of the target, and where it
//! will be a little later (specification §§5–7).

use schemas::{Pose, ReferenceSource, Task};

/// Displacements shorter than this have no direction, metres (specification §5).
pub const UNDERFOOT_M: f64 = 1e-3;

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
