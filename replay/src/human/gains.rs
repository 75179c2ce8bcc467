//! Gains pooled over logs: the ones under which all their people together are explained most cheaply.

use std::sync::Arc;

use super::bearing::Gains;
use super::goals::explain;
use crate::recording::Recording;

/// What is tried, one after the other: the prior's neighbourhood.
const K_THETA: [f64; 5] = [0.7, 1.0, 1.5, 2.1, 3.0];
const DELAY_S: [f64; 5] = [0.0, 0.1, 0.2, 0.3, 0.4];

/// More logs than this, and more of each, tell hardly anything new about two numbers.
const MOST_LOGS: usize = 24;
const MOST_BLOCKS: usize = 600;

/// Goals need not be placed finely for their gains.
const GRID_M: f64 = 0.5;

impl Gains {
    /// Gains for a pool of logs. Of many, evenly spread ones are looked at; of long ones, the first
    /// minute. The prior stands where there are none.
    pub fn pooled(recordings: &[Arc<Recording>]) -> Gains {
        let every = recordings.len().div_ceil(MOST_LOGS).max(1);
        let pool: Vec<&Arc<Recording>> = recordings.iter().step_by(every).collect();
        let cost = |gains: &Gains| {
            pool.iter().map(|log| explain(log, gains, GRID_M, MOST_BLOCKS).cost).sum::<f64>()
        };
        let cheapest = |tried: [Gains; 5]| {
            let mut best = (Gains::PRIOR, f64::INFINITY);
            for gains in tried {
                let cost = cost(&gains);
                if cost < best.1 {
                    best = (gains, cost);
                }
            }
            best.0
        };
        if pool.is_empty() {
            return Gains::PRIOR;
        }
        // The two trade off against each other: a second round corrects the first.
        let mut gains = Gains::PRIOR;
        for _ in 0..2 {
            gains = cheapest(K_THETA.map(|k_theta| Gains { k_theta, ..gains }));
            gains = cheapest(DELAY_S.map(|delay_s| Gains { delay_s, ..gains }));
        }
        gains
    }
}
