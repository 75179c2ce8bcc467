//! The feedback law: what the robot would do on its own.
//!
//! In: a [`Situation`] — the distances ahead and on the selected side, the wanted distances with
//! their rates, the heading in the distance frame — and [`Gains`]. Out: the input (11) of the
//! kinematic model or (17) of the dynamic one, with the quantities on the way to it.
//!
//! Plain functions from data to data, one noun per file:
//! [`admissible`] (8), [`arctangent`] (definition 3), [`star`] (θ*, v* and their rates),
//! [`kinematic`] (10), (11), [`dynamic`] (16), (17).

pub mod admissible;
pub mod arctangent;
pub mod dynamic;
pub mod kinematic;
pub mod star;

use crate::params::{Params, choice};

choice! {
    /// Which signs the right-hand side of the feedback law has.
    BranchSigns {
        /// σ in θ*, X and u1: exact on both sides (specification §13, erratum 7).
        Sigma = "sigma",
        /// The left-hand signs on both sides, as printed.
        Left = "left",
    }
}

/// A side of the robot, as seen along e1.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// σ = +1, d2 = d2l.
    Left,
    /// σ = −1, d2 = d2r.
    Right,
}

impl Side {
    /// σ.
    pub fn sigma(self) -> f64 {
        match self {
            Side::Left => 1.0,
            Side::Right => -1.0,
        }
    }
}

/// One of the two distances that the law regulates, and the admissible wanted distance it is to
/// follow.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Axis {
    /// `d_j`, metres, positive.
    pub d_m: f64,
    /// `d_rj` (8), metres, positive.
    pub d_r_m: f64,
    /// Its rate, m/s.
    pub d_r_rate_mps: f64,
    /// Its second rate, m/s².
    pub d_r_accel_mps2: f64,
}

impl Axis {
    /// `z_j` = ln(`d_j`/`d_rj`) (7).
    pub fn z(&self) -> f64 {
        libm::log(self.d_m / self.d_r_m)
    }
}

/// What the feedback law sees.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Situation {
    /// Along e1.
    pub ahead: Axis,
    /// On the selected side.
    pub aside: Axis,
    /// The selected side, which the model goes by: d2' = −σ v sinθe.
    pub side: Side,
    /// Which signs the law has on the right.
    pub signs: BranchSigns,
    /// Heading relative to e1, radians.
    pub theta_e_rad: f64,
}

impl Situation {
    /// σ of the model.
    pub fn sigma(&self) -> f64 {
        self.side.sigma()
    }

    /// σ where it stands in the law: +1 on both sides when the law is taken as printed.
    pub fn sigma_law(&self) -> f64 {
        match self.signs {
            BranchSigns::Sigma => self.side.sigma(),
            BranchSigns::Left => 1.0,
        }
    }
}

/// The law's gains.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// γ1, 1/s.
    pub gamma1: f64,
    /// γ2, 1/s.
    pub gamma2: f64,
    /// γ3, 1/s.
    pub gamma3: f64,
    /// γ4, 1/s (dynamic law).
    pub gamma4: f64,
    /// γ5, 1/s (dynamic law).
    pub gamma5: f64,
    /// λ (dynamic law).
    pub lambda: f64,
}

impl From<&Params> for Gains {
    fn from(params: &Params) -> Gains {
        Gains {
            gamma1: params.gamma1,
            gamma2: params.gamma2,
            gamma3: params.gamma3,
            gamma4: params.gamma4,
            gamma5: params.gamma5,
            lambda: params.lambda,
        }
    }
}

/// sin x / x, 1 at 0.
fn sinc(x: f64) -> f64 {
    if x == 0.0 { 1.0 } else { libm::sin(x) / x }
}

/// The coupling term X of (11) and of ωe* (17), rad/s: what the distances' errors ask of the turn
/// rate so that their share in the Lyapunov function's rate cancels.
///
/// X = −(z1 v*/d1) sin m · S + σ (z2 v*/d2) cos m · S, m = (θe+θ*)/2, S = sinc(e/2).
pub fn coupling(situation: &Situation, theta_star_rad: f64, v_star_mps: f64) -> f64 {
    let Situation { ahead, aside, theta_e_rad, .. } = situation;
    let (sin, cos) = libm::sincos(0.5 * (theta_e_rad + theta_star_rad));
    let s = sinc(0.5 * (theta_e_rad - theta_star_rad));
    -(ahead.z() * v_star_mps / ahead.d_m) * sin * s
        + situation.sigma_law() * (aside.z() * v_star_mps / aside.d_m) * cos * s
}
