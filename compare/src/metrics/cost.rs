//! What a step costs: `step_time_p50_us`, `step_time_p99_us`, `step_time_max_us`.
//!
//! Measured by a clock, so never part of a golden result, of "the same", or of a verdict.

use schemas::Timing;

use super::accumulate::Accumulate;
use super::quantile::Sketch;

/// A quantile, or the maximum, of the time that a step took, from `/timing`.
#[derive(Clone, Debug)]
pub(super) struct StepTime {
    /// `None` for the maximum.
    quantile: Option<f64>,
    sizes: Sketch,
    most_us: Option<f64>,
}

impl StepTime {
    pub(super) fn quantile(p: f64) -> Self {
        StepTime { quantile: Some(p), sizes: Sketch::default(), most_us: None }
    }

    pub(super) fn most() -> Self {
        StepTime { quantile: None, sizes: Sketch::default(), most_us: None }
    }
}

impl Accumulate for StepTime {
    fn timing(&mut self, timing: &Timing) {
        let cost_us = timing.step_cost_ns as f64 / 1000.0;
        self.most_us = Some(self.most_us.map_or(cost_us, |most| most.max(cost_us)));
        self.sizes.add(cost_us, 1.0);
    }

    fn value(&self) -> Option<f64> {
        match self.quantile {
            Some(p) => self.sizes.quantile(p),
            None => self.most_us,
        }
    }
}
