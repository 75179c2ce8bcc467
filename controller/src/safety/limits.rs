//! The plant's limits, and S1: how an input is brought within them.

use schemas::Plant;

/// Largest absolute value of either component of an input: m/s and rad/s, or m/s² and rad/s².
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits(pub [f64; 2]);

impl Limits {
    /// Of velocities.
    pub fn of_velocity(plant: &Plant) -> Limits {
        Limits([plant.v_max_mps, plant.omega_max_radps])
    }

    /// Of accelerations.
    pub fn of_acceleration(plant: &Plant) -> Limits {
        Limits([plant.accel_max_mps2, plant.alpha_max_radps2])
    }
}

/// Each component clipped to its limit; unchanged, bit for bit, where within.
pub fn clip(u: [f64; 2], limits: &Limits) -> [f64; 2] {
    let ([u1, u2], Limits([l1, l2])) = (u, limits);
    [u1.clamp(-l1, *l1), u2.clamp(-l2, *l2)]
}

/// S1: both components divided by the same number ≥ 1, so that both are within their limits and the
/// curvature stays; unchanged, bit for bit, where within.
pub fn scale(u: [f64; 2], limits: &Limits) -> [f64; 2] {
    let ([u1, u2], Limits([l1, l2])) = (u, limits);
    let excess = (libm::fabs(u1) / l1).max(libm::fabs(u2) / l2).max(1.0);
    if excess > 1.0 {
        // Clipped as well: the quotient may round up past the limit.
        clip([u1 / excess, u2 / excess], limits)
    } else {
        u
    }
}
