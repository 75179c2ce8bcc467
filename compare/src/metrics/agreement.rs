//! How far the command is from the request: `override_m`, `override_rad`,
//! `disagreement`, `cosine`.
//!
//! Velocities on both sides, for kinematic and dynamic laws alike.

use super::accumulate::{Accumulate, Mean};
use super::authority::ASKS_ABOVE;
use super::sample::{Decision, Limits, deviation};

/// `override_m` = ∫ |`v_s` − `v_h`| dt, or `override_rad` = ∫ |`ω_s` − `ω_h`| dt.
#[derive(Clone, Debug)]
pub(super) struct Override {
    turning: bool,
    total: f64,
    known: bool,
}

impl Override {
    pub(super) fn travel() -> Self {
        Override { turning: false, total: 0.0, known: false }
    }

    pub(super) fn turning() -> Self {
        Override { turning: true, total: 0.0, known: false }
    }
}

impl Accumulate for Override {
    fn decision(&mut self, decision: &Decision) {
        let apart = deviation(decision);
        let size = libm::fabs(if self.turning { apart.omega_radps } else { apart.v_mps });
        if size.is_nan() {
            return;
        }
        self.known = true;
        self.total += size * decision.hold_s;
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(self.total)
    }

    fn total(&self) -> Option<f64> {
        self.value()
    }
}

/// `disagreement` = time mean of ‖S(`u_s` − `u_h`)‖.
#[derive(Clone, Debug)]
pub(super) struct Disagreement {
    limits: Limits,
    mean: Mean,
}

impl Disagreement {
    pub(super) fn new(limits: Limits) -> Self {
        Disagreement { limits, mean: Mean::default() }
    }
}

impl Accumulate for Disagreement {
    fn decision(&mut self, decision: &Decision) {
        let size = self.limits.scaled(deviation(decision));
        if !size.is_nan() {
            self.mean.add(size, decision.hold_s);
        }
    }

    fn value(&self) -> Option<f64> {
        self.mean.value()
    }
}

/// `cosine` = time mean of ⟨S `u_s`, S `u_h`⟩/(‖S `u_s`‖ ‖S `u_h`‖) where ‖S `u_h`‖ > δ; a robot that
/// is told to stand neither follows nor opposes, which counts as 0.
#[derive(Clone, Debug)]
pub(super) struct Cosine {
    limits: Limits,
    mean: Mean,
}

impl Cosine {
    pub(super) fn new(limits: Limits) -> Self {
        Cosine { limits, mean: Mean::default() }
    }
}

impl Accumulate for Cosine {
    fn decision(&mut self, decision: &Decision) {
        let (asked, done) =
            (self.limits.scaled(decision.requested), self.limits.scaled(decision.executed));
        // Also false where one of them is not known.
        if !(asked > ASKS_ABOVE && done >= 0.0) {
            return;
        }
        let [v_h, omega_h] = self.limits.shares(decision.requested);
        let [v_s, omega_s] = self.limits.shares(decision.executed);
        let cosine =
            if done > 0.0 { (v_s * v_h + omega_s * omega_h) / (asked * done) } else { 0.0 };
        self.mean.add(cosine, decision.hold_s);
    }

    fn value(&self) -> Option<f64> {
        self.mean.value()
    }
}
