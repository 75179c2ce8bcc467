//! How one metric grows over a run.

use schemas::Timing;

use super::sample::{Decision, Motion, Request};

/// One metric, fed with a run from its start to its end.
pub(super) trait Accumulate: Fork {
    /// The robot was there until the next motion. May be called before or after the decision of
    /// the same instant.
    fn motion(&mut self, motion: &Motion) {
        let _ = motion;
    }

    /// The controller decided that.
    fn decision(&mut self, decision: &Decision) {
        let _ = decision;
    }

    /// The person asked for that.
    fn request(&mut self, request: &Request) {
        let _ = request;
    }

    /// A step took that long.
    fn timing(&mut self, timing: &Timing) {
        let _ = timing;
    }

    /// The metric so far; `None` where it has no meaning for this run.
    fn value(&self) -> Option<f64>;

    /// For a metric that adds up over time: the plain sum so far, before it is divided by anything.
    /// Its growth tells which moments carry the metric. Collisions and breaches leave it out: each
    /// of them is listed as a violation.
    fn total(&self) -> Option<f64> {
        None
    }
}

/// A copy of a metric as it stands, to be fed on its own.
pub(super) trait Fork {
    fn fork(&self) -> Box<dyn Accumulate>;
}

impl<T: Accumulate + Clone + 'static> Fork for T {
    fn fork(&self) -> Box<dyn Accumulate> {
        Box::new(self.clone())
    }
}

impl Clone for Box<dyn Accumulate> {
    fn clone(&self) -> Self {
        self.as_ref().fork()
    }
}

/// A weighted mean: Σ x·w / Σ w.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Mean {
    pub(super) sum: f64,
    pub(super) weight: f64,
}

impl Mean {
    pub(super) fn add(&mut self, x: f64, weight: f64) {
        self.sum += x * weight;
        self.weight += weight;
    }

    /// `None` before anything with a weight was added.
    pub(super) fn value(&self) -> Option<f64> {
        (self.weight > 0.0).then(|| self.sum / self.weight)
    }
}
