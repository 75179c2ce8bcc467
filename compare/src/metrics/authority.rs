//! Who drives: `human_share`, `interventions_per_min`, `chatter_per_min`, `deadlock_s`.

use super::accumulate::{Accumulate, Mean};
use super::sample::{Decision, Limits, deviation};

/// ε: a deviation from the request counts as an intervention above this share of full speed. Our
/// choice: twice what a tremor of the hand makes, well below what a person feels.
pub(super) const INTERVENES_ABOVE: f64 = 0.05;

/// Interventions less than this apart are one, seconds.
pub(super) const MERGED_WITHIN_S: f64 = 0.3;

/// Two opposite switches of k this near to each other are chatter, seconds.
pub(super) const CHATTER_WITHIN_S: f64 = 0.5;

/// δ: the person asks for motion above this share of full speed. Our choice.
pub(super) const ASKS_ABOVE: f64 = 0.05;

/// The robot stands below this share of full speed (1.4 cm/s, 0.04 rad/s for the defaults).
/// Our choice.
pub(super) const MOVES_ABOVE: f64 = 0.02;

/// Times that were added one by one compare with a limit up to their rounding, seconds.
const ROUNDING_S: f64 = 1e-9;

/// `human_share` = Σ k Δt / Σ Δt over the steps: the mean of k.
#[derive(Debug, Default)]
pub(super) struct HumanShare {
    mean: Mean,
}

impl Accumulate for HumanShare {
    fn decision(&mut self, decision: &Decision) {
        if decision.k.is_finite() {
            self.mean.add(decision.k, decision.hold_s);
        }
    }

    fn value(&self) -> Option<f64> {
        self.mean.value()
    }

    fn total(&self) -> Option<f64> {
        self.value().map(|_| self.mean.sum)
    }
}

/// A count per minute of the time in which it could have happened.
#[derive(Clone, Copy, Debug, Default)]
struct Rate {
    count: u32,
    watched_s: f64,
}

impl Rate {
    fn per_min(self) -> Option<f64> {
        (self.watched_s > 0.0).then(|| f64::from(self.count) * 60.0 / self.watched_s)
    }

    fn count(self) -> Option<f64> {
        self.per_min().map(|_| f64::from(self.count))
    }
}

/// `interventions_per_min` = rising edges of ‖S(`u_s` − `u_h`)‖ > ε, those within 0.3 s of the end
/// of the one before taken as the same.
#[derive(Debug)]
pub(super) struct Interventions {
    limits: Limits,
    rate: Rate,
    active: bool,
    ended_s: f64,
}

impl Interventions {
    pub(super) fn new(limits: Limits) -> Self {
        Interventions { limits, rate: Rate::default(), active: false, ended_s: f64::NEG_INFINITY }
    }
}

impl Accumulate for Interventions {
    fn decision(&mut self, decision: &Decision) {
        let size = self.limits.scaled(deviation(decision));
        if size.is_nan() {
            return;
        }
        self.rate.watched_s += decision.hold_s;
        let intervenes = size > INTERVENES_ABOVE;
        if intervenes && !self.active {
            let apart_s = decision.t_s - self.ended_s;
            if apart_s >= MERGED_WITHIN_S - ROUNDING_S {
                self.rate.count += 1;
            }
        }
        if self.active && !intervenes {
            self.ended_s = decision.t_s;
        }
        self.active = intervenes;
    }

    fn value(&self) -> Option<f64> {
        self.rate.per_min()
    }

    fn total(&self) -> Option<f64> {
        self.rate.count()
    }
}

/// `chatter_per_min` = switches of k that undo the switch before within 0.5 s.
#[derive(Debug)]
pub(super) struct Chatter {
    rate: Rate,
    k: f64,
    switched_s: f64,
}

impl Chatter {
    pub(super) fn new() -> Self {
        Chatter { rate: Rate::default(), k: f64::NAN, switched_s: f64::NEG_INFINITY }
    }
}

impl Accumulate for Chatter {
    fn decision(&mut self, decision: &Decision) {
        if !decision.k.is_finite() {
            return;
        }
        self.rate.watched_s += decision.hold_s;
        if self.k.is_finite() && decision.k != self.k {
            if decision.t_s - self.switched_s <= CHATTER_WITHIN_S + ROUNDING_S {
                self.rate.count += 1;
            }
            self.switched_s = decision.t_s;
        }
        self.k = decision.k;
    }

    fn value(&self) -> Option<f64> {
        self.rate.per_min()
    }

    fn total(&self) -> Option<f64> {
        self.rate.count()
    }
}

/// `deadlock_s` = ∫ 1{‖S `u_h`‖ > δ and the robot does not move} dt.
#[derive(Debug)]
pub(super) struct Deadlock {
    limits: Limits,
    stuck_s: f64,
    known: bool,
}

impl Deadlock {
    pub(super) fn new(limits: Limits) -> Self {
        Deadlock { limits, stuck_s: 0.0, known: false }
    }
}

impl Accumulate for Deadlock {
    fn decision(&mut self, decision: &Decision) {
        let asked = self.limits.scaled(decision.requested);
        let moved = self.limits.scaled(decision.actual);
        if asked.is_nan() || moved.is_nan() {
            return;
        }
        self.known = true;
        if asked > ASKS_ABOVE && moved <= MOVES_ABOVE {
            self.stuck_s += decision.hold_s;
        }
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(self.stuck_s)
    }

    fn total(&self) -> Option<f64> {
        self.value()
    }
}
