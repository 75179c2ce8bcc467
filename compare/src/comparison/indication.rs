//! What a single log points at: indicative, never a verdict.

use std::collections::BTreeMap;

use super::result::{Indication, LevelResult};
use crate::metrics::CATALOGUE;

/// How many times the plant gap a change on one log must exceed.
const FLOORS: f64 = 3.0;

/// The primary metrics in which every level of the ladder says the same of one log, by more than three
/// times the gap between simulated and recorded A, where that is known.
pub(super) fn indication(levels: &[LevelResult], floor: &BTreeMap<String, f64>) -> Indication {
    let mut indication = Indication::default();
    for metric in CATALOGUE.iter().filter(|metric| metric.primary) {
        let least = FLOORS * floor.get(metric.name).copied().map_or(0.0, libm::fabs);
        let improvements: Option<Vec<f64>> = levels
            .iter()
            .map(|level| {
                let delta = level.metrics.get(metric.name)?.delta?;
                Some(metric.better.improvement(delta))
            })
            .collect();
        let Some(improvements) = improvements.filter(|all| !all.is_empty()) else { continue };
        if improvements.iter().all(|improvement| *improvement > least) {
            indication.better.push(metric.name.to_owned());
        } else if improvements.iter().all(|improvement| -improvement > least) {
            indication.worse.push(metric.name.to_owned());
        }
    }
    indication
}
