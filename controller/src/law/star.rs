//! θ* and v*: the heading and speed that the distances' errors ask for, and their rates.
//!
//! `a_j` = `d_j` (−`d_rj`'/`d_rj` + `γ_j` `z_j`), v* = |(a1, a2)|, θ* = A(σ a2, a1)
//! (text before (10), specification §3). The rates are analytic: no difference quotient, hence no
//! spike where the frame or the side jumps.

use super::arctangent::{TOLERANCE, continuous_atan2};
use super::{Axis, Gains, Situation};

/// v* below which θ*' and v*' are taken as 0, m/s: θ* is undefined at a = 0.
const RATE_FLOOR_MPS: f64 = 1e-4;

/// The wanted heading and speed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Star {
    /// a1 and a2, m/s.
    pub a: [f64; 2],
    /// θ*, the wanted θe, radians.
    pub theta_rad: f64,
    /// v*, m/s.
    pub v_mps: f64,
}

/// Their rates.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct StarRates {
    /// θ*', rad/s.
    pub theta_radps: f64,
    /// v*', m/s².
    pub v_mps2: f64,
}

/// −`d_rj`'/`d_rj` + `γ_j` `z_j`, 1/s: the relative rate at which `d_j` is to shrink.
fn pull(axis: &Axis, gamma: f64) -> f64 {
    -axis.d_r_rate_mps / axis.d_r_m + gamma * axis.z()
}

/// θ* on the branch nearest to `previous_rad`, and v*.
pub fn star(situation: &Situation, gains: &Gains, previous_rad: f64) -> Star {
    let a1 = situation.ahead.d_m * pull(&situation.ahead, gains.gamma1);
    let a2 = situation.aside.d_m * pull(&situation.aside, gains.gamma2);
    Star {
        a: [a1, a2],
        theta_rad: continuous_atan2(situation.sigma_law() * a2, a1, previous_rad, TOLERANCE),
        v_mps: libm::hypot(a1, a2),
    }
}

/// θ*' and v*' when the robot moves at `v_mps` in the model d1' = −v cosθe, d2' = −σ v sinθe.
pub fn star_rates(situation: &Situation, gains: &Gains, star: &Star, v_mps: f64) -> StarRates {
    if star.v_mps <= RATE_FLOOR_MPS {
        return StarRates { theta_radps: 0.0, v_mps2: 0.0 };
    }
    let (sin, cos) = libm::sincos(situation.theta_e_rad);
    let rate = |axis: &Axis, gamma: f64, d_rate: f64| {
        let relative = axis.d_r_rate_mps / axis.d_r_m;
        let z_rate = d_rate / axis.d_m - relative;
        d_rate * pull(axis, gamma)
            + axis.d_m * (-axis.d_r_accel_mps2 / axis.d_r_m + relative * relative + gamma * z_rate)
    };
    let [a1, a2] = star.a;
    let b1 = rate(&situation.ahead, gains.gamma1, -v_mps * cos);
    let b2 = rate(&situation.aside, gains.gamma2, -situation.sigma() * v_mps * sin);
    StarRates {
        theta_radps: situation.sigma_law() * (a1 * b2 - a2 * b1) / (star.v_mps * star.v_mps),
        v_mps2: (a1 * b1 + a2 * b2) / star.v_mps,
    }
}
