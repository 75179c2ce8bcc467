//! How far the command is from the request: `override_m`, `override_rad`, `disagreement`.
//!
//! Velocities on both sides, for kinematic and dynamic laws alike.

use super::accumulate::{Accumulate, Mean};
use super::sample::{Decision, Limits, deviation};

/// `override_m` = ∫ |`v_s` − `v_h`| dt, or `override_rad` = ∫ |`ω_s` − `ω_h`| dt.
#[derive(Debug)]
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
#[derive(Debug)]
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
