//! Where a robot is and how it moves (REP 103: x forward, y left, counter-clockwise positive).

use serde::{Deserialize, Serialize};

/// A position and a heading in the plane.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Pose {
    /// Position along x, metres.
    pub x_m: f64,
    /// Position along y, metres.
    pub y_m: f64,
    /// Heading, radians from +x, counter-clockwise; any real number, not wrapped.
    pub theta_rad: f64,
}

impl Pose {
    /// The position alone, metres.
    pub fn position_m(&self) -> [f64; 2] {
        [self.x_m, self.y_m]
    }

    /// The point with body coordinates `(forward_m, left_m)`, in the frame this pose is given in.
    pub fn transform(&self, forward_m: f64, left_m: f64) -> [f64; 2] {
        let (sin, cos) = libm::sincos(self.theta_rad);
        [self.x_m + forward_m * cos - left_m * sin, self.y_m + forward_m * sin + left_m * cos]
    }

    /// Whether every component is a finite number.
    pub fn is_finite(&self) -> bool {
        self.x_m.is_finite() && self.y_m.is_finite() && self.theta_rad.is_finite()
    }
}

/// Forward speed and turn rate of a unicycle.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Twist {
    /// Forward speed, m/s; negative backwards.
    pub v_mps: f64,
    /// Turn rate, rad/s, counter-clockwise positive.
    pub omega_radps: f64,
}
