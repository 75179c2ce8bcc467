//! Who drives: `human_share`, `switches_per_min`, `chatter_per_min`, `deadlock_s`.

use super::accumulate::{Accumulate, Mean};
use super::sample::{Decision, Limits, Setting, deviation};

/// ε: a deviation from the request counts as an intervention above this share of full speed. Our
/// choice: twice what a tremor of the hand makes, well below what a person feels.
const INTERVENES_ABOVE: f64 = 0.05;

/// Two opposite switches of k this near to each other are chatter, seconds.
const CHATTER_WITHIN_S: f64 = 0.5;

/// δ: the person asks for motion above this share of full speed. Our choice.
pub(super) const ASKS_ABOVE: f64 = 0.05;

/// The robot stands below this share of full speed (1.4 cm/s, 0.04 rad/s for the defaults).
/// Our choice.
const MOVES_ABOVE: f64 = 0.02;

/// Times that were added one by one compare with a limit up to their rounding, seconds.
const ROUNDING_S: f64 = 1e-9;

/// Whether the controller intervenes: ‖S(`u_s` − `u_h`)‖ > ε, and the person's input did not go to
/// the actuators as it was (a dynamic law takes time to reach a requested speed also when nobody
/// interferes). `None` where the request or the command is not known.
pub(super) fn intervenes(limits: Limits, decision: &Decision) -> Option<bool> {
    let size = limits.scaled(deviation(decision));
    (!size.is_nan()).then_some(size > INTERVENES_ABOVE && !decision.passed)
}

/// `human_share` = Σ k Δt / Σ Δt over the steps: the mean of k.
#[derive(Clone, Debug, Default)]
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
pub(super) struct Rate {
    pub(super) count: u32,
    pub(super) watched_s: f64,
}

impl Rate {
    pub(super) fn per_min(self) -> Option<f64> {
        (self.watched_s > 0.0).then(|| f64::from(self.count) * 60.0 / self.watched_s)
    }

    pub(super) fn count(self) -> Option<f64> {
        self.per_min().map(|_| f64::from(self.count))
    }
}

/// `switches_per_min` = changes of k, either way, per minute.
#[derive(Clone, Debug)]
pub(super) struct Switches {
    rate: Rate,
    k: f64,
}

impl Switches {
    pub(super) fn new() -> Self {
        Switches { rate: Rate::default(), k: f64::NAN }
    }
}

impl Accumulate for Switches {
    fn decision(&mut self, decision: &Decision) {
        if !decision.k.is_finite() {
            return;
        }
        self.rate.watched_s += decision.hold_s;
        if self.k.is_finite() && decision.k != self.k {
            self.rate.count += 1;
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

/// `chatter_per_min` = switches of k that undo the switch before within 0.5 s.
#[derive(Clone, Debug)]
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

/// `deadlock_s` = ∫ 1{‖S `u_h`‖ > δ and the robot does not move} dt, where that has been asked for
/// longer than the actuators' delay: a robot that was at rest when the person began to ask has not
/// yet had the time to move.
#[derive(Clone, Debug)]
pub(super) struct Deadlock {
    limits: Limits,
    delay_s: f64,
    /// For how long the person has been asking for motion before the present step, seconds.
    asked_for_s: f64,
    stuck_s: f64,
    known: bool,
}

impl Deadlock {
    pub(super) fn new(setting: &Setting) -> Self {
        Deadlock {
            limits: setting.limits,
            delay_s: setting.plant.actuator_delay_s,
            asked_for_s: 0.0,
            stuck_s: 0.0,
            known: false,
        }
    }
}

impl Accumulate for Deadlock {
    fn decision(&mut self, decision: &Decision) {
        let asked = self.limits.scaled(decision.requested);
        let moved = self.limits.scaled(decision.actual);
        if asked.is_nan() || moved.is_nan() {
            self.asked_for_s = 0.0;
            return;
        }
        self.known = true;
        if asked <= ASKS_ABOVE {
            self.asked_for_s = 0.0;
            return;
        }
        if moved <= MOVES_ABOVE && self.asked_for_s > self.delay_s + ROUNDING_S {
            self.stuck_s += decision.hold_s;
        }
        self.asked_for_s += decision.hold_s;
    }

    fn value(&self) -> Option<f64> {
        self.known.then_some(self.stuck_s)
    }

    fn total(&self) -> Option<f64> {
        self.value()
    }
}
