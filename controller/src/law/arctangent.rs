//! The continuous arctangent A of definition 3: the angle of (x, y) on the branch nearest to the
//! previous one (specification §3 and §13, erratum 20).

use std::f64::consts::TAU;

/// Length of (a1, a2) below which its direction means nothing and the previous angle is kept, m/s.
pub const TOLERANCE: f64 = 1e-6;

/// The angle among `angle_rad` + 2nπ nearest to `near_rad`.
pub fn nearest_branch(angle_rad: f64, near_rad: f64) -> f64 {
    angle_rad + TAU * libm::round((near_rad - angle_rad) / TAU)
}

/// The angle of (x, y) on the branch nearest to `previous_rad`, or `previous_rad` itself where
/// (x, y) is no longer than `tolerance`.
pub fn continuous_atan2(y: f64, x: f64, previous_rad: f64, tolerance: f64) -> f64 {
    if libm::hypot(x, y) <= tolerance {
        return previous_rad;
    }
    nearest_branch(libm::atan2(y, x), previous_rad)
}

/// The angle in (−π, π] that differs from `angle_rad` by whole turns; NaN for what is not finite.
pub fn wrap(angle_rad: f64) -> f64 {
    let wrapped = angle_rad - TAU * libm::round(angle_rad / TAU);
    if wrapped <= -std::f64::consts::PI { wrapped + TAU } else { wrapped }
}
