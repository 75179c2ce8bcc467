//! The feedback law of the kinematic model: (11) with its Lyapunov function (10).

use super::{Gains, Situation, coupling};

/// Input (11): forward speed v* and turn rate `ω_r` + θ*' − γ3 e + X, [m/s, rad/s].
///
/// `theta_star_rad` and `v_star_mps` come from [`super::star::star`], `theta_star_rate_radps` from
/// [`super::star::star_rates`] with v = v*.
pub fn feedback(
    situation: &Situation,
    gains: &Gains,
    theta_star_rad: f64,
    theta_star_rate_radps: f64,
    v_star_mps: f64,
    omega_r_radps: f64,
) -> [f64; 2] {
    let e = situation.theta_e_rad - theta_star_rad;
    let x = coupling(situation, theta_star_rad, v_star_mps);
    [v_star_mps, omega_r_radps + theta_star_rate_radps - gains.gamma3 * e + x]
}

/// Lyapunov function (10): ½(z1² + z2² + e²).
pub fn lyapunov(situation: &Situation, theta_star_rad: f64) -> f64 {
    let (z1, z2) = (situation.ahead.z(), situation.aside.z());
    let e = situation.theta_e_rad - theta_star_rad;
    0.5 * (z1 * z1 + z2 * z2 + e * e)
}
