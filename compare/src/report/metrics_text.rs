//! Metrics of single runs, and the catalogue, as text.

use std::fmt::Write;

use super::number::number;
use super::table::{Align, columns};
use crate::metrics::{Basis, CATALOGUE, Measured, Metric, summarize};

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

/// Many runs at a glance: a row for each metric that any of them has.
pub fn summary_text(runs: &[(String, Measured)]) -> String {
    use Align::{Left, Right};
    let head = ["metric", "unit", "better", "n", "mean", "min", "max", "worst in"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    for row in summarize(runs).into_iter().filter(|row| row.n > 0) {
        rows.push(vec![
            row.name,
            row.unit,
            row.better.name().to_owned(),
            row.n.to_string(),
            number(row.mean),
            number(row.min),
            number(row.max),
            row.worst.unwrap_or_default(),
        ]);
    }
    let from_truth = runs.iter().filter(|(_, run)| run.metrics.basis == Basis::Truth).count();
    format!(
        "{} runs, motion from the truth in {from_truth}; a column for each with --each\n\n{}",
        runs.len(),
        columns(&[Left, Left, Left, Right, Right, Right, Right, Left], &rows)
    )
}

/// Every metric with its unit, direction, formula and source.
pub fn catalogue_text() -> String {
    let mut text = String::new();
    for metric in CATALOGUE {
        let unit = if metric.unit.is_empty() { "no unit" } else { metric.unit };
        let Metric { name, formula, source, .. } = metric;
        let (better, group) = (metric.better.name(), metric.group.name());
        let primary = if metric.primary { "; verdicts rest on it" } else { "" };
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{name} ({unit}, {better} is better, {group}{primary})");
        let _ = writeln!(text, "    {formula}\n    from {source}");
    }
    text
}
