//! Text for a terminal.

use std::collections::{BTreeMap, BTreeSet};
use std::fmt::Write;

use schemas::Node;

use super::self_test::{MUTANT_ALIGNS, MUTANT_HEAD, MutantRow};
use super::swaps::{SWAP_ALIGNS, SWAP_HEAD, SwapRow};
use super::table::{Align, columns};
use super::view::{DECIDES, METRIC_ALIGNS, METRIC_HEAD, MomentRow, View, ViolationRow};
use crate::comparison::Comparison;

/// Most rows of a list; the number of those left out is said.
const MOST_ROWS: usize = 30;

/// Most logs whose first cause is spelt out; the stages are counted over all.
const MOST_CAUSES: usize = 3;

/// The comparison as aligned text, verdict first.
pub fn terminal(comparison: &Comparison) -> String {
    let view = View::new(comparison);
    let mut text = format!("{} {}: {}\n\n", view.mark, view.verdict, view.reason);
    let width = view.facts.iter().map(|(name, _)| name.len()).max().unwrap_or(0);
    for (name, value) in &view.facts {
        // Writing to a String cannot fail, here and below.
        let _ = writeln!(text, "{name:<width$} {value}");
    }
    text.push('\n');
    text.push_str(&metrics(&view));
    let undefined = view.undefined_metrics();
    if !undefined.is_empty() {
        let _ = writeln!(text, "undefined in these logs: {}", undefined.join(", "));
    }
    text.push_str("▲ better  ▼ worse  ○ within chance (the interval and a test corrected for the number of metrics must both speak)  = no change\n");
    let _ = writeln!(text, "{DECIDES}\n");

    text.push_str(&gate(&view));
    text.push_str(&levels(&view));
    text.push_str(&swaps(&view));
    text.push_str(&tested(&view));
    let (in_a, in_b, new) = view.violation_counts;
    let _ = writeln!(text, "violations: {in_a} in A, {in_b} in B, {new} held against B");
    text.push_str(&violations(&view.violations));
    if !view.moments.is_empty() {
        text.push_str(
            "\nthe moment that carries most of each change; more in the JSON and on the page\n",
        );
        text.push_str(&moments(&view.moments));
    }
    text.push_str("\nfirst cause\n");
    text.push_str(&causes(comparison));
    text.push_str(&logs(&view));
    if !comparison.report.is_empty() {
        let _ = writeln!(text, "\nreport: {}", comparison.report.join(", "));
    }
    text
}

fn row(cells: &[&str]) -> Vec<String> {
    cells.iter().map(|cell| (*cell).to_owned()).collect()
}

fn metrics(view: &View) -> String {
    let mut rows = vec![row(&METRIC_HEAD)];
    let mut group = "";
    for metric in view.defined_metrics() {
        if metric.group != group {
            group = metric.group;
            rows.push(row(&[&group.to_uppercase()]));
        }
        rows.push(metric.cells());
    }
    columns(&METRIC_ALIGNS, &rows)
}

/// What the gate says of each metric.
fn gate(view: &View) -> String {
    if view.gate.is_empty() {
        return String::new();
    }
    let rows: Vec<Vec<String>> =
        view.gate.iter().map(|g| row(&["", &g.metric, g.gate, &g.reason])).collect();
    format!("gate\n{}\n", columns(&[Align::Left; 4], &rows))
}

/// The primary metrics at each level of the ladder.
fn levels(view: &View) -> String {
    use Align::{Left, Right};
    if view.levels.is_empty() {
        return String::new();
    }
    let mut rows =
        vec![row(&["", "metric", "human", "counts as", "A", "B", "B - A", "95 % interval"])];
    rows.extend(
        view.levels
            .iter()
            .map(|l| row(&["", &l.metric, &l.human, l.estimates, &l.a, &l.b, &l.delta, &l.ci])),
    );
    let aligns = [Left, Left, Left, Left, Right, Right, Right, Right];
    format!("levels of the ladder\n{}\n", columns(&aligns, &rows))
}

/// Which parameter makes the difference.
fn swaps(view: &View) -> String {
    if view.swaps.is_empty() {
        return String::new();
    }
    let mut rows = vec![SWAP_HEAD.map(str::to_owned).to_vec()];
    rows.extend(view.swaps.iter().map(SwapRow::cells));
    format!("which parameter makes the difference\n{}\n", columns(&SWAP_ALIGNS, &rows))
}

/// What a test of the comparison itself found.
fn tested(view: &View) -> String {
    let Some(test) = &view.self_test else { return String::new() };
    let mut text = format!("self-test {} {}: {}\n", test.mark, test.state, test.reason);
    let facts: Vec<Vec<String>> =
        test.facts.iter().map(|(name, value)| row(&["", name, value])).collect();
    text.push_str(&columns(&[Align::Left; 3], &facts));
    let mut rows = vec![MUTANT_HEAD.map(str::to_owned).to_vec()];
    rows.extend(test.mutants.iter().map(MutantRow::cells));
    text.push_str(&columns(&MUTANT_ALIGNS, &rows));
    text.push('\n');
    text
}

fn violations(all: &[ViolationRow]) -> String {
    use Align::{Left, Right};
    let rows: Vec<Vec<String>> = all
        .iter()
        .take(MOST_ROWS)
        .map(|v| {
            row(&[
                if v.new {
                    "  ✕"
                } else if v.possible {
                    "  ?"
                } else {
                    "   "
                },
                v.arm,
                &v.log,
                &v.t,
                v.kind,
                &format!("for {}", v.lasted),
                &format!("{} deep", v.depth),
                &format!("at {}", v.speed),
            ])
        })
        .collect();
    let mut text = columns(&[Left, Left, Left, Right, Left, Left, Left, Left], &rows);
    text.push_str(&left_out(all.len(), MOST_ROWS));
    text
}

/// The strongest moment of each metric.
fn moments(all: &[MomentRow]) -> String {
    use Align::{Left, Right};
    let mut seen = BTreeSet::new();
    let rows: Vec<Vec<String>> = all
        .iter()
        .filter(|m| seen.insert(m.metric.as_str()))
        .map(|m| row(&["", &m.log, &m.t, &m.metric, &m.delta, &m.why]))
        .collect();
    columns(&[Left, Left, Right, Left, Right, Left], &rows)
}

/// In how many logs which stage of the data flow was the first to differ.
fn causes(comparison: &Comparison) -> String {
    let mut by_node: BTreeMap<&str, usize> = BTreeMap::new();
    for log in &comparison.logs {
        if let Some(cause) = &log.first_cause {
            *by_node.entry(cause.node.as_str()).or_default() += 1;
        }
    }
    let in_order = Node::ALL.iter().filter_map(|node| by_node.get_key_value(node.name()));
    let counts: Vec<String> = in_order
        .map(|(node, count)| format!("{node} in {count} of {}", comparison.logs.len()))
        .collect();
    if counts.is_empty() { String::new() } else { format!("  {}\n", counts.join(", ")) }
}

/// What differed first in the first few logs; every log that failed.
fn logs(view: &View) -> String {
    let (failed, compared): (Vec<_>, Vec<_>) = view.logs.iter().partition(|log| log.failed);
    let rows: Vec<Vec<String>> = failed
        .into_iter()
        .chain(compared.iter().take(MOST_CAUSES).copied())
        .map(|log| {
            let failed = format!("failed: {}", log.error);
            row(&["", &log.log, if log.failed { &failed } else { &log.first_cause }])
        })
        .collect();
    let mut text = columns(&[Align::Left; 3], &rows);
    text.push_str(&left_out(compared.len(), MOST_CAUSES));
    text
}

/// What is said of the rows that a list leaves out.
fn left_out(all: usize, shown: usize) -> String {
    if all > shown {
        format!("  … and {} more: see the JSON or the page\n", all - shown)
    } else {
        String::new()
    }
}
