//! The feedback law of the dynamic model: (17) with its Lyapunov function (16), mass and moment of
//! inertia 1 (assumption 3).

use super::arctangent::nearest_branch;
use super::star::{Star, StarRates, star, star_rates};
use super::{Axis, Gains, Situation, coupling};

/// Half the time over which ωe* is differentiated along the model's flow, seconds.
const FLOW_STEP_S: f64 = 1e-5;

/// The speeds of the robot: states of the dynamic model.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Speeds {
    /// Forward speed, m/s.
    pub v_mps: f64,
    /// Turn rate relative to the frame, ωe = ω − `ω_r`, rad/s.
    pub omega_e_radps: f64,
}

/// ωe* = θ*' − γ5 e + X, rad/s. `theta_star_rate_radps` is that at the actual speed.
pub fn omega_e_star(
    situation: &Situation,
    gains: &Gains,
    theta_star_rad: f64,
    theta_star_rate_radps: f64,
    v_star_mps: f64,
) -> f64 {
    let e = situation.theta_e_rad - theta_star_rad;
    theta_star_rate_radps - gains.gamma5 * e + coupling(situation, theta_star_rad, v_star_mps)
}

/// u1 of (17), m/s²: v*' + λ(z1 cosθe/d1 + σ z2 sinθe/d2) − γ3 (v − v*).
pub fn acceleration(
    situation: &Situation,
    gains: &Gains,
    v_star_mps: f64,
    v_star_rate_mps2: f64,
    v_mps: f64,
) -> f64 {
    let Situation { ahead, aside, theta_e_rad, .. } = situation;
    let (sin, cos) = libm::sincos(*theta_e_rad);
    v_star_rate_mps2
        + gains.lambda
            * (ahead.z() * cos / ahead.d_m + situation.sigma_law() * aside.z() * sin / aside.d_m)
        - gains.gamma3 * (v_mps - v_star_mps)
}

/// u2 of (17), rad/s²: `ω_r`' + ωe*' − e − γ4 (ωe − ωe*).
pub fn angular_acceleration(
    e_rad: f64,
    gains: &Gains,
    omega_e_radps: f64,
    omega_e_star_radps: f64,
    omega_e_star_rate_radps2: f64,
    omega_r_rate_radps2: f64,
) -> f64 {
    omega_r_rate_radps2 + omega_e_star_rate_radps2
        - e_rad
        - gains.gamma4 * (omega_e_radps - omega_e_star_radps)
}

/// Lyapunov function (16): ½(z1² + z2² + e² + (v−v*)² + (ωe−ωe*)²).
pub fn lyapunov(
    situation: &Situation,
    speeds: &Speeds,
    theta_star_rad: f64,
    v_star_mps: f64,
    omega_e_star_radps: f64,
) -> f64 {
    let dv = speeds.v_mps - v_star_mps;
    let domega = speeds.omega_e_radps - omega_e_star_radps;
    super::kinematic::lyapunov(situation, theta_star_rad) + 0.5 * (dv * dv + domega * domega)
}

/// What the dynamic law computes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Feedback {
    /// u1 m/s² and u2 rad/s².
    pub u: [f64; 2],
    /// Rates of θ* and v* at the actual speed.
    pub rates: StarRates,
    /// ωe*, rad/s.
    pub omega_e_star_radps: f64,
    /// (16).
    pub lyapunov: f64,
}

/// Input (17), for θ* and v* of `star`.
pub fn feedback(
    situation: &Situation,
    gains: &Gains,
    star: &Star,
    speeds: &Speeds,
    omega_r_rate_radps2: f64,
) -> Feedback {
    let rates = star_rates(situation, gains, star, speeds.v_mps);
    let omega_e_star_radps =
        omega_e_star(situation, gains, star.theta_rad, rates.theta_radps, star.v_mps);
    let u1 = acceleration(situation, gains, star.v_mps, rates.v_mps2, speeds.v_mps);
    let ahead = flow(situation, gains, star, speeds, u1, FLOW_STEP_S);
    let behind = flow(situation, gains, star, speeds, u1, -FLOW_STEP_S);
    let u2 = angular_acceleration(
        situation.theta_e_rad - star.theta_rad,
        gains,
        speeds.omega_e_radps,
        omega_e_star_radps,
        (ahead - behind) / (2.0 * FLOW_STEP_S),
        omega_r_rate_radps2,
    );
    Feedback {
        u: [u1, u2],
        rates,
        omega_e_star_radps,
        lyapunov: lyapunov(situation, speeds, star.theta_rad, star.v_mps, omega_e_star_radps),
    }
}

/// ωe* after `dt_s` along the model's flow. Differentiating along the flow and not along time
/// samples leaves jumps of frame, side and rays out of it.
fn flow(
    situation: &Situation,
    gains: &Gains,
    at: &Star,
    speeds: &Speeds,
    u1_mps2: f64,
    dt_s: f64,
) -> f64 {
    let moved = |axis: &Axis, d_rate: f64, d_accel: f64| Axis {
        d_m: axis.d_m + d_rate * dt_s + 0.5 * d_accel * dt_s * dt_s,
        d_r_m: axis.d_r_m + axis.d_r_rate_mps * dt_s + 0.5 * axis.d_r_accel_mps2 * dt_s * dt_s,
        d_r_rate_mps: axis.d_r_rate_mps + axis.d_r_accel_mps2 * dt_s,
        d_r_accel_mps2: axis.d_r_accel_mps2,
    };
    let (sin, cos) = libm::sincos(situation.theta_e_rad);
    let (v, omega_e, sigma) = (speeds.v_mps, speeds.omega_e_radps, situation.sigma());
    let later = Situation {
        ahead: moved(&situation.ahead, -v * cos, -u1_mps2 * cos + v * omega_e * sin),
        aside: moved(
            &situation.aside,
            -sigma * v * sin,
            -sigma * (u1_mps2 * sin + v * omega_e * cos),
        ),
        // The acceleration of θe changes the difference quotient in third order only.
        theta_e_rad: situation.theta_e_rad + omega_e * dt_s,
        ..*situation
    };
    let v_later = v + u1_mps2 * dt_s;
    let mut star = star(&later, gains, at.theta_rad);
    star.theta_rad = nearest_branch(star.theta_rad, at.theta_rad);
    let rates = star_rates(&later, gains, &star, v_later);
    omega_e_star(&later, gains, star.theta_rad, rates.theta_radps, star.v_mps)
}
