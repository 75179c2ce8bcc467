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
#[derive(Clone, Debug)]
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
#[derive(Clone, Debug)]
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

#[cfg(test)]
mod tests {
    use schemas::{LawBranch, Plant, Pose, ReferenceSource, Twist};

    use super::super::judge::Judgement;
    use super::super::sample::LawState;
    use super::*;

    fn limits() -> Limits {
        Limits::new(&Plant { v_max_mps: 0.5, omega_max_radps: 2.0, ..Plant::default() })
    }

    fn twist(v_mps: f64, omega_radps: f64) -> Twist {
        Twist { v_mps, omega_radps }
    }

    /// For 0.25 s.
    fn decision(requested: Twist, executed: Twist, judgement: Option<Judgement>) -> Decision {
        Decision {
            t_s: 0.0,
            hold_s: 0.25,
            k: 1.0,
            requested,
            executed,
            actual: executed,
            passed: requested == executed,
            accelerates: false,
            pose: Pose::default(),
            judgement,
            law: LawState {
                lyapunov: f64::NAN,
                branch: LawBranch::None,
                reference: ReferenceSource::Task,
                altered: false,
                psi_rad: f64::NAN,
                target_velocity_mps: [f64::NAN; 2],
                distances_m: [f64::NAN; 3],
            },
        }
    }

    /// The profile gets the time in which the controller was wrong.
    #[test]
    fn the_total_is_the_time_of_wrong_interventions() {
        let judged = |safe| Some(Judgement { safe, nearest_safe: None });
        let (asked, less) = (twist(0.5, 0.0), twist(0.1, 0.0));
        let mut unwarranted = Verdicts::unwarranted(limits());
        assert_eq!(unwarranted.total(), None);
        for (executed, judgement, total_s) in [
            (asked, None, None),
            (asked, judged(false), None),
            (asked, judged(true), Some(0.0)),
            (less, judged(true), Some(0.25)),
            (less, judged(false), Some(0.25)),
            (less, judged(true), Some(0.5)),
        ] {
            unwarranted.decision(&decision(asked, executed, judgement));
            assert_eq!(unwarranted.total(), total_s);
        }
        assert_eq!(unwarranted.value(), Some(2.0 / 3.0));
    }

    /// From (0.3, 0.5) to the safe (0.1, -0.5) it is 0.2 m/s of 0.5 and 1 rad/s of 2: shares of 0.4 and 0.5.
    /// From what was done, (0.1, 0), it is a quarter of the full turn rate.
    #[test]
    fn corrections_are_measured_in_shares_of_full_speed() {
        let nearest_safe = Some(twist(0.1, -0.5));
        let judgement = Some(Judgement { safe: false, nearest_safe });
        let step = decision(twist(0.3, 0.5), twist(0.1, 0.0), judgement);
        let [mut necessary, mut excess] =
            [Correction::necessary(limits()), Correction::excess(limits())];
        for correction in [&mut necessary, &mut excess] {
            correction.decision(&step);
            // Where nothing is safe, or nobody knows what was done, there is nothing to measure.
            let nowhere = Some(Judgement { safe: false, nearest_safe: None });
            correction.decision(&Decision { judgement: nowhere, ..step.clone() });
            correction.decision(&Decision { executed: twist(f64::NAN, 0.0), ..step.clone() });
        }
        let close = |got: Option<f64>, want: f64| (got.expect("measured") - want).abs() < 1e-12;
        assert!(close(necessary.value(), 0.41_f64.sqrt()));
        assert!(close(excess.value(), 0.25));
    }
}
