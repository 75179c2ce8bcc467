//! The admissible wanted distance `d_r` (8): the wanted distance where that keeps clear of the
//! edge, ε where it does not, and an arc of radius r between.
//!
//! The paper prints both thresholds equal, which leaves no arc; the lower one used here,
//! ε − (√2−1) r, is the one at which the arc meets ε with slope 0 (specification §13, erratum 1).
//! `d_r` is continuously differentiable and monotone, never below ε nor below the wanted distance.
//! Its curvature jumps at both joints, where it is taken as 0 (erratum 2).

use std::f64::consts::{FRAC_1_SQRT_2, SQRT_2};

/// `d_r` and its first two derivatives with respect to the wanted distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Admissible {
    /// `d_r`, metres.
    pub d_r_m: f64,
    /// d(`d_r`)/d(`d_d`).
    pub slope: f64,
    /// d²(`d_r`)/d(`d_d`)², 1/m.
    pub curvature: f64,
}

/// `d_r` of the wanted distance `d_d_m` (any sign) for the arc's radius `r_m` and the least
/// distance `epsilon_m`.
pub fn admissible(d_d_m: f64, r_m: f64, epsilon_m: f64) -> Admissible {
    let s = d_d_m - epsilon_m + (SQRT_2 - 1.0) * r_m;
    if s <= 0.0 {
        Admissible { d_r_m: epsilon_m, slope: 0.0, curvature: 0.0 }
    } else if s < r_m * FRAC_1_SQRT_2 {
        let q = libm::sqrt(r_m * r_m - s * s);
        Admissible { d_r_m: r_m + epsilon_m - q, slope: s / q, curvature: r_m * r_m / (q * q * q) }
    } else {
        Admissible { d_r_m: d_d_m, slope: 1.0, curvature: 0.0 }
    }
}

impl Admissible {
    /// Rate of `d_r`, m/s, when the wanted distance changes at `d_d_rate_mps`.
    pub fn rate(&self, d_d_rate_mps: f64) -> f64 {
        self.slope * d_d_rate_mps
    }

    /// Second rate of `d_r`, m/s², when the wanted distance changes at `d_d_rate_mps` and
    /// `d_d_accel_mps2`.
    pub fn accel(&self, d_d_rate_mps: f64, d_d_accel_mps2: f64) -> f64 {
        self.curvature * d_d_rate_mps * d_d_rate_mps + self.slope * d_d_accel_mps2
    }
}
