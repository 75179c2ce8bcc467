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

/// S1 for accelerations: both components divided by the same number ≥ 1, so that both are within their limits and
/// their ratio stays; unchanged, bit for bit, where within.
pub fn scale(u: [f64; 2], limits: &Limits) -> [f64; 2] {
    scale_but_keep(0.0, u, limits)
}

/// S1 for velocities: the same, so that the curvature stays, but the speed is divided by 10 at most. Where a
/// distance is at its floor the kinematic law asks for thousands of rad/s; scaled alike with that the speed is
/// nothing, and where the safety layer then takes the turn away the robot stands though it is asked to go on.
pub fn scale_velocities(u: [f64; 2], limits: &Limits) -> [f64; 2] {
    // Chosen: with 0.3 and 0.5 it stands as little.
    const LEAST_SHARE: f64 = 0.1;
    scale_but_keep(LEAST_SHARE, u, limits)
}

/// `least_share`: what the first component is scaled down to at most.
fn scale_but_keep(least_share: f64, u: [f64; 2], limits: &Limits) -> [f64; 2] {
    let ([u1, u2], Limits([l1, l2])) = (u, limits);
    let excess = (libm::fabs(u1) / l1).max(libm::fabs(u2) / l2).max(1.0);
    if excess > 1.0 {
        // Clipped as well: the quotient may round up past the limit.
        clip([u1 / excess.min(1.0 / least_share), u2 / excess], limits)
    } else {
        u
    }
}
