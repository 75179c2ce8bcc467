//! CSV of per-log metrics, for spreadsheets and statistics programs (RFC 4180).
//!
//! One row for each log, level of the ladder and metric; the level is empty for the estimate. Numbers
//! have all their digits, undefined ones are empty. A log that failed has one row without a metric.

use crate::comparison::{Change, Comparison, LogResult};

/// The columns.
const HEAD: [&str; 14] = [
    "log", "hash", "operator", "cluster", "status", "error", "level", "metric", "unit", "better",
    "a", "b", "delta", "floor",
];

/// The comparison's per-log metrics as CSV.
pub fn csv(comparison: &Comparison) -> String {
    let mut text = String::new();
    push(&mut text, &HEAD.map(str::to_owned));
    for log in &comparison.logs {
        let own = |level: &str, rest: [String; 7]| {
            let status = if log.error.is_some() { "failed" } else { "ok" };
            let mut row = [
                &log.log,
                &log.hash,
                &log.operator,
                &log.cluster,
                status,
                log.error.as_deref().unwrap_or_default(),
                level,
            ]
            .map(str::to_owned)
            .to_vec();
            row.extend(rest);
            row
        };
        if log.metrics.is_empty() {
            push(&mut text, &own("", [const { String::new() }; 7]));
        }
        let levels = log.levels.iter().map(|level| (level.human.as_str(), &level.metrics));
        for (level, metrics) in std::iter::once(("", &log.metrics)).chain(levels) {
            for metric in &comparison.metrics {
                let Some(change) = metrics.get(&metric.name) else { continue };
                let [a, b, delta] = numbers(change);
                let floor = if level.is_empty() { floor(log, &metric.name) } else { String::new() };
                let better = metric.better.name().to_owned();
                let cells = [metric.name.clone(), metric.unit.clone(), better, a, b, delta, floor];
                push(&mut text, &own(level, cells));
            }
        }
    }
    text
}

fn numbers(change: &Change) -> [String; 3] {
    [change.a, change.b, change.delta].map(digits)
}

fn floor(log: &LogResult, metric: &str) -> String {
    digits(log.floor.get(metric).copied())
}

/// All digits; empty for none.
fn digits(x: Option<f64>) -> String {
    x.map(|x| x.to_string()).unwrap_or_default()
}

/// Adds a row, with quotes where a cell needs them.
fn push(text: &mut String, row: &[String]) {
    for (i, cell) in row.iter().enumerate() {
        if i > 0 {
            text.push(',');
        }
        if cell.contains([',', '"', '\n', '\r']) {
            text.push('"');
            text.push_str(&cell.replace('"', "\"\""));
            text.push('"');
        } else {
            text.push_str(cell);
        }
    }
    text.push_str("\r\n");
}
