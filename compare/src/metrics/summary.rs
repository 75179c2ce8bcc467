//! Many runs at a glance: of each metric the mean, the range and the worst run.

use serde::{Deserialize, Serialize};

use super::catalogue::{Better, CATALOGUE};
use super::meter::Measured;
use crate::statistics::mean;

/// One metric over several runs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MetricSummary {
    /// Name.
    pub name: String,
    /// Unit; empty for shares and counts.
    pub unit: String,
    /// Which way it should go.
    pub better: Better,
    /// In how many runs it has a value.
    pub n: usize,
    /// Mean over these; `None` for none.
    pub mean: Option<f64>,
    /// Least of them.
    pub min: Option<f64>,
    /// Greatest of them.
    pub max: Option<f64>,
    /// The run with the worst value, the first of several; `None` where all have the same.
    pub worst: Option<String>,
}

/// Every metric of the catalogue over these runs.
pub fn summarize(runs: &[(String, Measured)]) -> Vec<MetricSummary> {
    CATALOGUE
        .iter()
        .enumerate()
        .map(|(i, metric)| {
            let named: Vec<(&str, f64)> = runs
                .iter()
                .filter_map(|(name, run)| Some((name.as_str(), run.metrics.values()[i]?)))
                .collect();
            let values: Vec<f64> = named.iter().map(|(_, value)| *value).collect();
            let min = values.iter().copied().reduce(f64::min);
            let max = values.iter().copied().reduce(f64::max);
            let worst = if metric.better == Better::Lower { max } else { min };
            MetricSummary {
                name: metric.name.to_owned(),
                unit: metric.unit.to_owned(),
                better: metric.better,
                n: values.len(),
                mean: mean(&values),
                min,
                max,
                worst: named
                    .iter()
                    .find(|(_, value)| Some(*value) == worst && min != max)
                    .map(|(name, _)| (*name).to_owned()),
            }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::synthetic::Run;

    #[test]
    fn the_worst_run_is_named_by_the_metrics_direction() {
        let run = |name: &str, clearances: &[f64]| {
            (name.to_owned(), Run::clearances(clearances).measured())
        };
        let runs = [run("far", &[0.8]), run("near", &[0.2]), run("hit", &[-0.1, 0.5])];
        let all = summarize(&runs);
        let of = |name: &str| all.iter().find(|row| row.name == name).expect("in the catalogue");
        let clearance = of("min_clearance_m");
        assert_eq!((clearance.n, clearance.worst.as_deref()), (3, Some("hit")));
        assert_eq!((clearance.min, clearance.max), (Some(-0.1), Some(0.8)));
        assert!((clearance.mean.expect("defined") - 0.3).abs() < 1e-12);
        assert_eq!(of("collisions").worst.as_deref(), Some("hit"));
        // One value only, and none at all.
        assert_eq!((of("contact_speed_mps").n, of("contact_speed_mps").worst.as_ref()), (1, None));
        assert_eq!((of("goal_time_s").n, of("goal_time_s").mean), (0, None));
    }
}
