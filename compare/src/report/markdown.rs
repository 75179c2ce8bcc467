//! Markdown for a merge request's comment or a step summary.

use std::fmt::Write;

use super::self_test::{MUTANT_ALIGNS, MUTANT_HEAD, MutantRow};
use super::swaps::{SWAP_ALIGNS, SWAP_HEAD, SwapRow};
use super::table::{Align, in_cell, markdown as table};
use super::view::{DECIDES, METRIC_ALIGNS, METRIC_HEAD, MetricRow, View};
use crate::comparison::Comparison;

/// Most rows of a list; the number of those left out is said. Keeps a comment far below the
/// 1 MiB at which GitHub drops a summary whole.
const MOST_ROWS: usize = 50;

/// The comparison as Markdown, verdict first.
pub fn markdown(comparison: &Comparison) -> String {
    use Align::{Left, Right};
    let view = View::new(comparison);
    let mut text = format!(
        "## {} {}: {} against {}\n\n{}\n\n",
        view.mark,
        view.verdict,
        in_cell(&view.b),
        in_cell(&view.a),
        in_cell(&view.reason)
    );
    for (name, value) in &view.facts {
        // Writing to a String cannot fail, here and below.
        let _ = writeln!(text, "- **{name}**: {}", in_cell(value));
    }
    text.push('\n');

    let mut rows = vec![METRIC_HEAD.map(str::to_owned).to_vec()];
    rows.extend(view.defined_metrics().map(MetricRow::cells));
    text.push_str(&table(&METRIC_ALIGNS, &rows));
    text.push_str("\n▲ better, ▼ worse, ○ within chance (the interval and a test corrected for the number of metrics must both speak), = no change");
    let undefined = view.undefined_metrics();
    if !undefined.is_empty() {
        let _ = write!(text, ". Undefined in these logs: {}", in_cell(&undefined.join(", ")));
    }
    let _ = writeln!(text, ". {}.", in_cell(DECIDES));

    text.push_str(&gate(&view));
    text.push_str(&levels(&view));
    text.push_str(&swaps(&view));
    text.push_str(&tested(&view));
    let (in_a, in_b, new) = view.violation_counts;
    let _ = writeln!(text, "\n### Violations: {in_a} in A, {in_b} in B, {new} held against B\n");
    if !view.violations.is_empty() {
        let head = ["", "arm", "log", "at", "what", "for", "depth", "speed"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(view.violations.iter().take(MOST_ROWS).map(|v| {
            vec![
                if v.new {
                    "✕"
                } else if v.possible {
                    "?"
                } else {
                    ""
                }
                .to_owned(),
                v.arm.to_owned(),
                v.log.clone(),
                v.t.clone(),
                v.kind.to_owned(),
                v.lasted.clone(),
                v.depth.clone(),
                v.speed.clone(),
            ]
        }));
        text.push_str(&table(&[Left, Left, Left, Right, Left, Right, Right, Right], &rows));
        text.push_str(&left_out(view.violations.len()));
    }
    if !view.moments.is_empty() {
        text.push_str("\n### Moments that carry most of the change\n\n");
        let head = ["log", "at", "metric", "B - A", "share", "what happened"];
        let mut rows = vec![head.map(str::to_owned).to_vec()];
        rows.extend(view.moments.iter().take(MOST_ROWS).map(|m| {
            [&m.log, &m.t, &m.metric, &m.delta, &m.share, &m.why].map(Clone::clone).to_vec()
        }));
        text.push_str(&table(&[Left, Right, Left, Right, Right, Left], &rows));
        text.push_str(&left_out(view.moments.len()));
    }
    text.push_str("\n### Logs\n\n");
    let head = ["log", "status", "indicative only", "first cause"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(view.logs.iter().take(MOST_ROWS).map(|log| {
        let (status, what) =
            if log.failed { ("failed", &log.error) } else { ("ok", &log.first_cause) };
        vec![log.log.clone(), status.to_owned(), log.indicative.clone(), what.clone()]
    }));
    text.push_str(&table(&[Left; 4], &rows));
    text.push_str(&left_out(view.logs.len()));
    text
}

/// What the gate says of each metric.
fn gate(view: &View) -> String {
    if view.gate.is_empty() {
        return String::new();
    }
    let mut rows = vec![["metric", "gate", "why"].map(str::to_owned).to_vec()];
    rows.extend(
        view.gate.iter().map(|g| vec![g.metric.clone(), g.gate.to_owned(), g.reason.clone()]),
    );
    format!("\n### Gate\n\n{}", table(&[Align::Left; 3], &rows))
}

/// The primary metrics at each level of the ladder.
fn levels(view: &View) -> String {
    use Align::{Left, Right};
    if view.levels.is_empty() {
        return String::new();
    }
    let head = ["metric", "human", "counts as", "A", "B", "B - A", "95 % interval"];
    let mut rows = vec![head.map(str::to_owned).to_vec()];
    rows.extend(view.levels.iter().map(|l| {
        let counts = l.estimates.to_owned();
        [&l.metric, &l.human, &counts, &l.a, &l.b, &l.delta, &l.ci].map(Clone::clone).to_vec()
    }));
    let aligns = [Left, Left, Left, Right, Right, Right, Right];
    format!("\n### Levels of the ladder\n\n{}", table(&aligns, &rows))
}

/// Which parameter makes the difference.
fn swaps(view: &View) -> String {
    if view.swaps.is_empty() {
        return String::new();
    }
    let mut rows = vec![SWAP_HEAD.map(str::to_owned).to_vec()];
    rows.extend(view.swaps.iter().map(SwapRow::cells));
    format!("\n### Which parameter makes the difference\n\n{}", table(&SWAP_ALIGNS, &rows))
}

/// What a test of the comparison itself found.
fn tested(view: &View) -> String {
    let Some(test) = &view.self_test else { return String::new() };
    let mut text =
        format!("\n### Self-test {} {}\n\n{}\n\n", test.mark, test.state, in_cell(&test.reason));
    for (name, value) in &test.facts {
        let _ = writeln!(text, "- **{name}**: {}", in_cell(value));
    }
    text.push('\n');
    let mut rows = vec![MUTANT_HEAD.map(str::to_owned).to_vec()];
    rows.extend(test.mutants.iter().map(MutantRow::cells));
    text.push_str(&table(&MUTANT_ALIGNS, &rows));
    text
}

/// What is said of the rows that a list leaves out.
fn left_out(all: usize) -> String {
    if all > MOST_ROWS {
        format!("\n… and {} more: see the JSON or the page.\n", all - MOST_ROWS)
    } else {
        String::new()
    }
}
