//! The person who pursues a target: the `goal` model of specification §7.

use schemas::{GoalDriver, Task};

use super::{Human, HumanView, Request, wrap};

/// Nearer than this to the target the person asks for nothing, metres: the bearing of a point
/// underfoot says nothing.
const UNDERFOOT_M: f64 = 1e-6;

/// Steers for where the target will be in a while.
pub(super) struct Pursuit {
    task: Task,
    manner: GoalDriver,
}

impl Pursuit {
    pub(super) fn new(task: Task, manner: GoalDriver) -> Pursuit {
        Pursuit { task, manner }
    }
}

impl Human for Pursuit {
    /// v = min(dist / `T_la` · max(cos(bearing - θ), 0), cap), ω = `k_θ` · wrap(bearing - θ), to the
    /// target's place `T_la` ahead in time.
    fn joystick(&mut self, view: &HumanView) -> Option<Request> {
        let (target_m, _) = self.task.target(view.t_s + self.manner.look_ahead_s);
        let (dx_m, dy_m) = (target_m[0] - view.pose.x_m, target_m[1] - view.pose.y_m);
        let distance_m = libm::hypot(dx_m, dy_m);
        if distance_m.is_nan() || distance_m < UNDERFOOT_M {
            return Some(Request::REST);
        }
        let error_rad = wrap(libm::atan2(dy_m, dx_m) - view.pose.theta_rad);
        let facing = libm::cos(error_rad);
        let wanted_mps =
            if facing > 0.0 { distance_m / self.manner.look_ahead_s * facing } else { 0.0 };
        let v_mps =
            if wanted_mps < self.manner.v_cap_mps { wanted_mps } else { self.manner.v_cap_mps };
        Some(Request { v_mps, omega_radps: self.manner.k_theta * error_rad, dead_man: true })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::human::view;
    use core::f64::consts::{FRAC_PI_2, PI, TAU};
    use schemas::Pose;

    fn pursuit() -> Pursuit {
        Pursuit::new(
            Task { from_m: [0.0, 0.0], velocity_mps: [0.1, 0.0], until_s: 10.0 },
            GoalDriver { look_ahead_s: 2.0, v_cap_mps: 0.3, k_theta: 0.5 },
        )
    }

    fn ask(t_s: f64, x_m: f64, y_m: f64, theta_rad: f64) -> Request {
        pursuit()
            .joystick(&view(t_s, Pose { x_m, y_m, theta_rad }))
            .expect("the pursuer always holds the stick")
    }

    /// Hand-computed: the target two seconds ahead of t = 3 is (0.5, 0).
    #[test]
    fn asks_for_speed_and_turn_by_distance_and_bearing() {
        let close = |a: f64, b: f64| (a - b).abs() < 1e-12;
        let ahead = ask(3.0, 0.1, 0.0, 0.0);
        assert!(close(ahead.v_mps, 0.2) && ahead.omega_radps == 0.0 && ahead.dead_man);
        // 3-4-5: distance 0.5, bearing atan2(0.4, -0.3) against a heading straight up.
        let aside = ask(3.0, 0.8, -0.4, FRAC_PI_2);
        assert!(close(aside.v_mps, 0.25 * 0.8));
        assert!(close(aside.omega_radps, 0.5 * (libm::atan2(0.4, -0.3) - FRAC_PI_2)));
        // Behind: no backing up, turn as fast as the error says, the short way round.
        let behind = ask(3.0, 1.0, 0.0, 3.0 * TAU + 0.2);
        assert_eq!(behind.v_mps, 0.0);
        assert!(close(behind.omega_radps, 0.5 * (PI - 0.2)));
        // Far away the cap holds; after the task's end the target rests at (1, 0).
        assert_eq!(ask(3.0, -9.0, 0.0, 0.0).v_mps, 0.3);
        assert!(close(ask(99.0, 0.8, 0.0, 0.0).v_mps, 0.1));
        assert_eq!(ask(99.0, 1.0, 0.0, 2.0), Request::REST);
    }
}
