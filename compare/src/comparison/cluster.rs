//! Which logs belong together.
//!
//! Sessions of one operator are alike, and so are sessions of one scenario: they are no independent
//! pieces of evidence. Logs are clustered by operator where every log names one and there are at least
//! two; otherwise by scenario where there are at least two of them; otherwise each stands alone.

use std::collections::{BTreeMap, BTreeSet};

use super::build::LogPair;
use crate::statistics::Cluster;

/// What the logs are clustered by, and each log's cluster.
pub(super) fn clusters(logs: &[LogPair]) -> (&'static str, Vec<String>) {
    let scenario_of = |log: &LogPair| {
        log.scenario.as_ref().map_or_else(|| log.log.clone(), |scenario| scenario.name.clone())
    };
    let several = |names: &[String]| names.iter().collect::<BTreeSet<_>>().len() > 1;
    let operators: Vec<String> = logs.iter().map(|log| log.operator.clone()).collect();
    // A log that could not be read names nobody and counts in no metric.
    let named = logs.iter().all(|log| !log.operator.is_empty() || log.scenario.is_none());
    if named && several(&operators) {
        return ("operator", operators);
    }
    let scenarios: Vec<String> = logs.iter().map(scenario_of).collect();
    if several(&scenarios) {
        return ("scenario", scenarios);
    }
    ("log", logs.iter().map(|log| log.log.clone()).collect())
}

/// Differences by cluster, in an order that does not depend on that of the logs.
pub(super) fn pooled<'a>(differences: impl Iterator<Item = (&'a str, f64)>) -> Vec<Cluster> {
    let mut by_name: BTreeMap<&str, Vec<f64>> = BTreeMap::new();
    for (cluster, difference) in differences {
        by_name.entry(cluster).or_default().push(difference);
    }
    let mut clusters: Vec<Cluster> = by_name
        .into_values()
        .map(|mut differences| {
            differences.sort_by(f64::total_cmp);
            Cluster { sum: differences.iter().sum(), n: differences.len() }
        })
        .collect();
    clusters.sort_by(|a, b| a.sum.total_cmp(&b.sum).then(a.n.cmp(&b.n)));
    clusters
}
