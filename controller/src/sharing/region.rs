//! The sets (12): dangerous, hysteresis, safe.

use schemas::Region;

use super::critical_distance_m;

/// Class of the state by critical distances (specification §5): total and disjoint for every D,
/// also negative, infinite and NaN, and for a speed of either sign.
///
/// `d_m` is the distance D itself, which decides about contact; `d_effective_m` is what the
/// critical distances are compared with: `D_eff`.
pub fn classify_total(d_m: f64, d_effective_m: f64, v_mps: f64, b1_m: f64, b2_m: f64) -> Region {
    // "Clear" is what must hold, so that what is not a number is never clear.
    let clear = d_effective_m > critical_distance_m(v_mps, b1_m);
    let resting = v_mps == 0.0 && !d_effective_m.is_nan();
    let dangerous = d_m.is_nan() || d_m <= 0.0 || !v_mps.is_finite() || !(clear || resting);
    if dangerous {
        Region::Danger
    } else if d_effective_m >= critical_distance_m(v_mps, b2_m) {
        Region::Safe
    } else {
        Region::Hysteresis
    }
}

/// Class of the state by (12) as printed: v < 0 is safe whatever is behind; else, with
/// t(b) = 1/(b−D) − 1/b, and +∞ for D ≥ b, dangerous if v ≥ t(b1) and D ≤ b1, safe if v ≤ t(b2) or
/// D > b2. Not a number is dangerous.
pub fn classify_printed(d_m: f64, v_mps: f64, b1_m: f64, b2_m: f64) -> Region {
    if d_m.is_nan() || v_mps.is_nan() {
        return Region::Danger;
    }
    if v_mps < 0.0 {
        return Region::Safe;
    }
    let t = |b_m: f64| if d_m >= b_m { f64::INFINITY } else { 1.0 / (b_m - d_m) - 1.0 / b_m };
    if v_mps >= t(b1_m) && d_m <= b1_m {
        Region::Danger
    } else if v_mps <= t(b2_m) || d_m > b2_m {
        Region::Safe
    } else {
        Region::Hysteresis
    }
}
