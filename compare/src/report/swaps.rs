//! The cells of an attribution: which parameter makes the difference.

use std::cmp::Reverse;

use serde::Serialize;

use super::number::signed;
use super::table::Align;
use crate::comparison::{Comparison, MetricChange};

/// How many metrics a report goes into.
const MOST_METRICS: usize = 5;

/// How many parameters of each.
const MOST_PARAMETERS: usize = 6;

/// What one parameter does to one metric.
#[derive(Clone, Debug, Serialize)]
pub(super) struct SwapRow {
    pub(super) metric: String,
    pub(super) delta: String,
    pub(super) parameter: String,
    pub(super) a: String,
    pub(super) b: String,
    pub(super) forth: String,
    pub(super) back: String,
}

/// The head of a table of [`SwapRow::cells`].
pub(super) const SWAP_HEAD: [&str; 7] =
    ["metric", "B - A", "parameter", "in A", "in B", "alone to B", "alone back to A"];

/// How the columns of that table stand.
pub(super) const SWAP_ALIGNS: [Align; 7] = {
    use Align::{Left, Right};
    [Left, Right, Left, Right, Right, Right, Right]
};

impl SwapRow {
    /// The row for a table of text.
    pub(super) fn cells(&self) -> Vec<String> {
        let SwapRow { metric, delta, parameter, a, b, forth, back } = self;
        [metric, delta, parameter, a, b, forth, back].map(Clone::clone).to_vec()
    }
}

/// The rows: the metrics whose change is beyond chance, else the primary ones that change at all; of each
/// the parameters that do most.
pub(super) fn swap_rows(comparison: &Comparison) -> Vec<SwapRow> {
    if comparison.swaps.is_empty() {
        return Vec::new();
    }
    let primary = |metric: &&MetricChange| metric.primary && metric.delta.is_some_and(|d| d != 0.0);
    let mut metrics: Vec<&MetricChange> = comparison.metrics.iter().filter(primary).collect();
    metrics.sort_by_key(|metric| Reverse(metric.decidable));
    let decided = metrics.iter().filter(|metric| metric.decidable).count();
    metrics.truncate(if decided > 0 { decided.min(MOST_METRICS) } else { MOST_METRICS });
    metrics.into_iter().flat_map(|metric| of_metric(comparison, metric)).collect()
}

fn of_metric(comparison: &Comparison, metric: &MetricChange) -> Vec<SwapRow> {
    let mut effects: Vec<(&str, Option<f64>, Option<f64>)> = comparison
        .swaps
        .iter()
        .map(|swap| {
            let of = |values: &crate::Values| values.get(&metric.name).copied();
            (swap.key.as_str(), of(&swap.forth), of(&swap.back))
        })
        .collect();
    let size = |x: Option<f64>| libm::fabs(x.unwrap_or(0.0));
    let weight = |(_, forth, back): &(&str, Option<f64>, Option<f64>)| size(*forth) + size(*back);
    effects.retain(|effect| weight(effect) > 0.0);
    // The sort is stable: of equals the first by name stands first.
    effects.sort_by(|x, y| weight(y).total_cmp(&weight(x)));
    effects.truncate(MOST_PARAMETERS);
    let value = |key: &str, of: fn(&crate::ParameterChange) -> &Option<String>| {
        let change = comparison.provenance.parameters.iter().find(|change| change.key == key);
        change.and_then(|change| of(change).clone()).unwrap_or_else(|| "by log".to_owned())
    };
    effects
        .into_iter()
        .map(|(key, forth, back)| SwapRow {
            metric: metric.name.clone(),
            delta: signed(metric.delta),
            parameter: key.to_owned(),
            a: value(key, |change| &change.a),
            b: value(key, |change| &change.b),
            forth: signed(forth),
            back: signed(back),
        })
        .collect()
}
