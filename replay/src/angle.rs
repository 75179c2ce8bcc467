//! Angles on the circle.

use core::f64::consts::{PI, TAU};

/// The same angle in [-π, π).
pub(crate) fn wrap(angle_rad: f64) -> f64 {
    (angle_rad + PI).rem_euclid(TAU) - PI
}
