//! How near danger is, as a feedback signal to the person.

use schemas::Region;

use super::critical_distance_m;

/// 1 in the dangerous set and at its edge; falls linearly with the distance, to 0 at `band_m` beyond
/// the edge of the safe set. 1 where nothing is known.
///
/// The paper suggests k itself as a signal to the person (section II); k is binary here, so this is
/// the graded signal beside it.
pub fn danger(
    region: Region,
    d_effective_m: f64,
    v_mps: f64,
    b1_m: f64,
    b2_m: f64,
    band_m: f64,
) -> f64 {
    if region == Region::Danger || d_effective_m.is_nan() || !v_mps.is_finite() {
        return 1.0;
    }
    let near_m = critical_distance_m(v_mps, b1_m);
    let far_m = critical_distance_m(v_mps, b2_m) + band_m;
    ((far_m - d_effective_m) / (far_m - near_m)).clamp(0.0, 1.0)
}
