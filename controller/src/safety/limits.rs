//! The plant's limits, and S1: how a velocity input is brought within them.

use schemas::Plant;

/// What the plant can do.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Largest forward speed, m/s.
    pub v_mps: f64,
    /// Largest turn rate, rad/s.
    pub omega_radps: f64,
}

impl From<&Plant> for Limits {
    fn from(plant: &Plant) -> Limits {
        Limits { v_mps: plant.v_max_mps, omega_radps: plant.omega_max_radps }
    }
}

/// Each component clipped to its limit; unchanged, bit for bit, where within.
pub fn clip(u: [f64; 2], limits: &Limits) -> [f64; 2] {
    let [v, omega] = u;
    [v.clamp(-limits.v_mps, limits.v_mps), omega.clamp(-limits.omega_radps, limits.omega_radps)]
}

/// S1: both components divided by the same number ≥ 1, so that both are within their limits and the
/// curvature stays; unchanged, bit for bit, where within.
pub fn scale(u: [f64; 2], limits: &Limits) -> [f64; 2] {
    let [v, omega] = u;
    let excess =
        (libm::fabs(v) / limits.v_mps).max(libm::fabs(omega) / limits.omega_radps).max(1.0);
    if excess > 1.0 {
        // Clipped as well: the quotient may round up past the limit.
        clip([v / excess, omega / excess], limits)
    } else {
        u
    }
}
