//! D: the distance to the edge of the admissible set along the direction of travel, which the sets
//! (12) are about (specification §5).
//!
//! In: where the robot looks and what is asked of it, and a way to measure along a ray. Out: D,
//! NaN if any ray that counts is unknown.

use std::f64::consts::PI;

use schemas::Pose;

use crate::params::choice;
use crate::target::{UNDERFOOT_M, direction_rad};

choice! {
    /// Along which directions D is measured.
    DMode {
        /// Along the heading; opposite to it in reverse. Jumps when the heading sweeps past a
        /// corner.
        Heading = "heading",
        /// Towards where the person wants to be in a while; along travel when that is underfoot.
        Intent = "intent",
        /// The lesser of both: for driving with a task.
        Both = "both",
        /// The least along the headings that the requested turn sweeps: for a joystick.
        Sweep = "sweep",
    }
}

/// Rays of a sweep (specification §5).
const SWEEP_RAYS: u32 = 9;

/// The request whose way is to be measured.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Travel {
    /// Where the robot is.
    pub pose: Pose,
    /// Requested speed, m/s: its sign says which way.
    pub v_mps: f64,
    /// Requested turn rate, rad/s.
    pub omega_radps: f64,
    /// Where the person wants to be in a while, metres.
    pub intent_m: [f64; 2],
    /// How long the requested turn is swept, seconds.
    pub sweep_s: f64,
}

/// World angle of the direction in which a robot with heading `heading_rad` moves at `v_mps`;
/// forward at rest.
pub fn direction_of_travel_rad(heading_rad: f64, v_mps: f64) -> f64 {
    if v_mps < 0.0 { heading_rad + PI } else { heading_rad }
}

/// The lesser of two distances; NaN if either is unknown.
pub(crate) fn lesser(a: f64, b: f64) -> f64 {
    if a.is_nan() || b.is_nan() { f64::NAN } else { a.min(b) }
}

impl Travel {
    /// D, measured by `ray_m` along world angles.
    pub fn distance_m(&self, mode: DMode, ray_m: impl Fn(f64) -> f64) -> f64 {
        let along_rad = direction_of_travel_rad(self.pose.theta_rad, self.v_mps);
        let intent_rad = || {
            let [x, y] = self.intent_m;
            direction_rad([x - self.pose.x_m, y - self.pose.y_m], UNDERFOOT_M)
        };
        match mode {
            DMode::Heading => ray_m(along_rad),
            DMode::Intent => ray_m(intent_rad().unwrap_or(along_rad)),
            DMode::Both => {
                let along_m = ray_m(along_rad);
                intent_rad().map_or(along_m, |angle_rad| lesser(along_m, ray_m(angle_rad)))
            }
            DMode::Sweep => {
                let turn_rad = self.omega_radps * self.sweep_s;
                (0..SWEEP_RAYS)
                    .map(|i| along_rad + turn_rad * f64::from(i) / f64::from(SWEEP_RAYS - 1))
                    .map(ray_m)
                    .fold(f64::INFINITY, lesser)
            }
        }
    }
}
