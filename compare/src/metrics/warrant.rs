//! Whether interventions were needed: `unwarranted`, `missed`, `necessary`, `excess`.
//!
//! An input is safe when it could have been held for a second and braked from without contact, by the
//! truth ([`super::judge`]); an input is overridden where the controller intervenes
//! ([`super::authority`]).

use super::accumulate::{Accumulate, Mean};
use super::authority::intervenes;
use super::sample::{Decision, Limits};

/// `unwarranted` = time with safe input that was overridden / time with safe input.
/// `missed` = time with unsafe input that was not overridden / time with unsafe input.
#[derive(Debug)]
pub(super) struct Verdicts {
    limits: Limits,
    /// The kind of input that is counted.
    safe: bool,
    /// What is wrong with it: being overridden (true), or not.
    overridden: bool,
    wrong: Mean,
}

impl Verdicts {
    pub(super) fn unwarranted(limits: Limits) -> Self {
        Verdicts { limits, safe: true, overridden: true, wrong: Mean::default() }
    }

    pub(super) fn missed(limits: Limits) -> Self {
        Verdicts { limits, safe: false, overridden: false, wrong: Mean::default() }
    }
}

impl Accumulate for Verdicts {
    fn decision(&mut self, decision: &Decision) {
        let Some(judgement) = decision.judgement else { return };
        let Some(overridden) = intervenes(self.limits, decision) else { return };
        if judgement.safe == self.safe {
            let wrong = overridden == self.overridden;
            self.wrong.add(f64::from(u8::from(wrong)), decision.hold_s);
        }
    }

    fn value(&self) -> Option<f64> {
        self.wrong.value()
    }

    fn total(&self) -> Option<f64> {
        self.value().map(|_| self.wrong.sum)
    }
}

/// `necessary` = time mean of ‖S(u* − `u_h`)‖, `excess` = time mean of ‖S(`u_s` − u*)‖, with u* the
/// safe input nearest to the person's.
#[derive(Debug)]
pub(super) struct Correction {
    limits: Limits,
    excess: bool,
    mean: Mean,
}

impl Correction {
    pub(super) fn necessary(limits: Limits) -> Self {
        Correction { limits, excess: false, mean: Mean::default() }
    }

    pub(super) fn excess(limits: Limits) -> Self {
        Correction { limits, excess: true, mean: Mean::default() }
    }
}

impl Accumulate for Correction {
    fn decision(&mut self, decision: &Decision) {
        let Some(nearest) = decision.judgement.and_then(|judgement| judgement.nearest_safe) else {
            return;
        };
        // Both means are over the same steps, so that they can be laid side by side.
        if self.limits.scaled(decision.executed).is_nan() {
            return;
        }
        let from = if self.excess { decision.executed } else { decision.requested };
        let size = self.limits.scaled(schemas::Twist {
            v_mps: from.v_mps - nearest.v_mps,
            omega_radps: from.omega_radps - nearest.omega_radps,
        });
        if !size.is_nan() {
            self.mean.add(size, decision.hold_s);
        }
    }

    fn value(&self) -> Option<f64> {
        self.mean.value()
    }
}
