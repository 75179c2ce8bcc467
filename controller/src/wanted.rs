//! From measured distances and the target to what the feedback law regulates.
//!
//! In: distances to the edge along e1 and ±e2, the displacement to the target and its velocity in
//! that frame. Out: the distances as the law sees them, the wanted ones (`d_d`), and the admissible
//! wanted ones (`d_r`) with their rates, for either side (specification §6).
//!
//! `d_d1` = d1 − Δ1, `d_d2l` = d2l − Δ2, `d_d2r` = d2r + Δ2: no absolute position enters.

use crate::law::Axis;
use crate::law::admissible::{Admissible, admissible};

/// Least distance that the law ever sees, metres: ln 0 is not a number to steer by (specification
/// §6).
const FLOOR_M: f64 = 1e-4;

/// A distance as the law sees it: at most the cap B (remark 1), at least 0.1 mm; NaN stays NaN.
pub fn capped_m(distance_m: f64, cap_m: f64) -> f64 {
    if distance_m.is_nan() { distance_m } else { distance_m.min(cap_m).max(FLOOR_M) }
}

/// A wanted distance and how fast it changes. The target's acceleration is taken as 0.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Wanted {
    /// `d_d`, metres; negative where the target lies beyond the edge.
    pub d_d_m: f64,
    /// Its rate, m/s.
    pub d_d_rate_mps: f64,
    /// `d_r` and its slopes.
    pub admissible: Admissible,
}

impl Wanted {
    /// For a distance of which `displacement_m` is to be covered by the robot and which the target
    /// shortens at `approach_mps`.
    pub fn new(
        distance_m: f64,
        displacement_m: f64,
        approach_mps: f64,
        r_m: f64,
        epsilon_m: f64,
    ) -> Wanted {
        let d_d_m = distance_m - displacement_m;
        Wanted { d_d_m, d_d_rate_mps: -approach_mps, admissible: admissible(d_d_m, r_m, epsilon_m) }
    }

    /// Together with the distance itself: one axis of the law.
    pub fn axis(&self, distance_m: f64) -> Axis {
        Axis {
            d_m: distance_m,
            d_r_m: self.admissible.d_r_m,
            d_r_rate_mps: self.admissible.rate(self.d_d_rate_mps),
            d_r_accel_mps2: self.admissible.accel(self.d_d_rate_mps, 0.0),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_capped_but_never_invented() {
        assert_eq!(capped_m(3.0, 1.0), 1.0);
        assert_eq!(capped_m(f64::INFINITY, 1.0), 1.0);
        assert_eq!(capped_m(-0.5, 1.0), 1e-4);
        assert_eq!(capped_m(0.3, 1.0), 0.3);
        assert!(capped_m(f64::NAN, 1.0).is_nan());
    }

    /// A target 0.4 m ahead with the edge at 1 m is to be 0.6 m from it, and nearer as it moves on.
    #[test]
    fn the_wanted_distance_is_what_remains() {
        let wanted = Wanted::new(1.0, 0.4, 0.1, 0.5, 0.05);
        assert!((wanted.d_d_m - 0.6).abs() < 1e-12);
        let axis = wanted.axis(1.0);
        assert!((axis.d_r_m - 0.6).abs() < 1e-12);
        assert!((axis.d_r_rate_mps + 0.1).abs() < 1e-12);
        assert_eq!(axis.d_r_accel_mps2, 0.0);
        // Beyond the edge the robot is to stay ε before it, at rest.
        let beyond = Wanted::new(1.0, 1.4, 0.1, 0.5, 0.05).axis(1.0);
        assert_eq!((beyond.d_r_m, beyond.d_r_rate_mps), (0.05, 0.0));
    }
}
