//! How one metric grows over a run.

use schemas::Timing;

use super::sample::{Decision, Motion, Request};

/// One metric, fed with a run from its start to its end.
pub(super) trait Accumulate: Fork {
    /// The robot was there until the next motion. May be called before or after the decision of
    /// the same instant.
    fn motion(&mut self, _motion: &Motion) {}

    /// The controller decided that.
    fn decision(&mut self, _decision: &Decision) {}

    /// The person asked for that.
    fn request(&mut self, _request: &Request) {}

    /// A step took that long.
    fn timing(&mut self, _timing: &Timing) {}

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

#[cfg(test)]
mod tests {
    use super::*;

    /// 3 for 2 s and 9 for 1 s is 5 on average; what has no weight says nothing.
    #[test]
    fn a_mean_is_weighted_and_of_nothing_there_is_none() {
        let mut mean = Mean::default();
        mean.add(7.0, 0.0);
        assert_eq!(mean.value(), None);
        mean.add(3.0, 2.0);
        mean.add(9.0, 1.0);
        assert_eq!(mean.value(), Some(5.0));
    }
}
