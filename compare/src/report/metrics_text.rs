//! Metrics of single runs, and the catalogue, as text.

use std::fmt::Write;

use super::number::number;
use super::table::{Align, columns};
use crate::metrics::{Basis, CATALOGUE, Measured, Metric};

/// Runs side by side: a row for each metric, a column for each run.
pub fn metrics_text(runs: &[(String, Measured)]) -> String {
    let mut aligns = vec![Align::Left, Align::Left];
    let mut head = vec!["metric".to_owned(), "unit".to_owned()];
    let mut from = vec!["motion from".to_owned(), String::new()];
    let mut steps = vec!["steps (k = 0)".to_owned(), String::new()];
    for (name, run) in runs {
        aligns.push(Align::Right);
        head.push(name.clone());
        from.push(match run.metrics.basis {
            Basis::Truth => "truth".to_owned(),
            Basis::Estimate => "estimate".to_owned(),
        });
        steps.push(format!("{} ({})", run.metrics.steps, run.metrics.engaged_steps));
    }
    let mut rows = vec![head];
    for (i, metric) in CATALOGUE.iter().enumerate() {
        let mut row = vec![metric.name.to_owned(), metric.unit.to_owned()];
        row.extend(runs.iter().map(|(_, run)| number(run.metrics.values()[i])));
        rows.push(row);
    }
    rows.extend([from, steps]);
    columns(&aligns, &rows)
}

/// Every metric with its unit, direction, formula and source.
pub fn catalogue_text() -> String {
    let mut text = String::new();
    for metric in CATALOGUE {
        let unit = if metric.unit.is_empty() { "no unit" } else { metric.unit };
        let Metric { name, formula, source, .. } = metric;
        let (better, group) = (metric.better.name(), metric.group.name());
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name} ({unit}, {better} is better, {group})");
        let _ = writeln!(text, "    {formula}\n    from {source}");
    }
    text
}
