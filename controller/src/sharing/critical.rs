//! The critical distance.

/// Dc(v, b) = b·b|v|/(1+b|v|), metres: the distance at which |v| = 1/(b−D) − 1/b, the curves that
/// bound the sets (12) (specification §5). Increasing in |v| and in b, and less than b.
pub fn critical_distance_m(v_mps: f64, b_m: f64) -> f64 {
    let speed = libm::fabs(v_mps);
    b_m * b_m * speed / (1.0 + b_m * speed)
}
