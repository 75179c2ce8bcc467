//! The cells of a report: every number already printed, once for all forms.

use std::fmt::Write;

use serde::Serialize;

use super::number::{number, seconds, signed, with_unit};
use super::self_test::{SelfTestView, self_test};
use super::swaps::{SwapRow, swap_rows};
use super::table::Align;
use super::warned;
use crate::comparison::{
    Arm, Comparison, Gate, Indication, LogStatus, MetricChange, Moment, ViolationRecord,
};
use crate::metrics::metric;
use crate::statistics::Interval;

/// How many moments of each metric a summary lists.
const STRONGEST_PER_METRIC: usize = 3;

/// A comparison, printed.
#[derive(Clone, Debug, Serialize)]
pub(super) struct View {
    pub(super) verdict: &'static str,
    pub(super) mark: &'static str,
    pub(super) reason: String,
    pub(super) a: String,
    pub(super) b: String,
    /// Facts about the comparison as a whole: name, value.
    pub(super) facts: Vec<(&'static str, String)>,
    pub(super) metrics: Vec<MetricRow>,
    pub(super) violations: Vec<ViolationRow>,
    /// Numbers of violations of A, of B, and of those held against B.
    pub(super) violation_counts: (usize, usize, usize),
    /// The strongest ones over all logs.
    pub(super) moments: Vec<MomentRow>,
    pub(super) logs: Vec<LogRow>,
    /// What the gate says of each metric that it looks at; empty without a gate.
    pub(super) gate: Vec<GateRow>,
    /// Each level of the ladder, where there are several: the primary metrics.
    pub(super) levels: Vec<LevelRow>,
    /// Which parameter makes the difference.
    pub(super) swaps: Vec<SwapRow>,
    /// What a test of the comparison itself found.
    pub(super) self_test: Option<SelfTestView>,
}

/// One gated metric.
#[derive(Clone, Debug, Serialize)]
pub(super) struct GateRow {
    pub(super) metric: String,
    pub(super) gate: &'static str,
    pub(super) reason: String,
}

/// One metric at one level of the ladder.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LevelRow {
    pub(super) metric: String,
    pub(super) human: String,
    pub(super) estimates: &'static str,
    pub(super) a: String,
    pub(super) b: String,
    pub(super) delta: String,
    pub(super) ci: String,
}

/// One metric over all logs.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MetricRow {
    pub(super) name: String,
    /// Whether the verdict may rest on it; the others are told beside it.
    pub(super) decides: bool,
    pub(super) unit: String,
    pub(super) group: &'static str,
    pub(super) better: &'static str,
    pub(super) formula: &'static str,
    pub(super) a: String,
    pub(super) b: String,
    pub(super) delta: String,
    pub(super) ci: String,
    pub(super) p: String,
    pub(super) n: String,
    /// A sign that tells without colour which way it went.
    pub(super) mark: &'static str,
    /// The same in words.
    pub(super) meaning: &'static str,
}

/// One violation.
#[derive(Clone, Debug, Serialize)]
pub(super) struct ViolationRow {
    pub(super) log: String,
    pub(super) arm: &'static str,
    pub(super) kind: &'static str,
    pub(super) t: String,
    /// The same, seconds, to jump to.
    pub(super) at_s: f64,
    pub(super) lasted: String,
    pub(super) depth: String,
    pub(super) speed: String,
    pub(super) new: bool,
    /// Whether only some levels of the ladder show it.
    pub(super) possible: bool,
}

/// One moment.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MomentRow {
    pub(super) log: String,
    pub(super) t: String,
    /// The same, seconds, to jump to.
    pub(super) at_s: f64,
    pub(super) metric: String,
    pub(super) delta: String,
    pub(super) share: String,
    pub(super) why: String,
}

/// One log.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LogRow {
    pub(super) log: String,
    pub(super) failed: bool,
    pub(super) error: String,
    pub(super) operator: String,
    pub(super) horizon: String,
    pub(super) first_cause: String,
    /// What this log points at; empty where at nothing.
    pub(super) indicative: String,
    /// When that was, seconds, to jump to.
    pub(super) first_cause_s: Option<f64>,
    /// The log in which both arms stand side by side, as a link; empty without one.
    pub(super) side_by_side: String,
    pub(super) metrics: Vec<LogMetricRow>,
    pub(super) moments: Vec<MomentRow>,
}

/// One metric of one log.
#[derive(Clone, Debug, Serialize)]
pub(super) struct LogMetricRow {
    pub(super) name: String,
    pub(super) unit: String,
    pub(super) a: String,
    pub(super) b: String,
    pub(super) delta: String,
}

/// The head of a table of [`MetricRow::cells`].
pub(super) const METRIC_HEAD: [&str; 10] =
    ["metric", "unit", "better", "A", "B", "", "B - A", "95 % interval", "p", "n"];

/// What the star behind some names means.
pub(super) const DECIDES: &str =
    "* the metrics that the verdict rests on; a gate looks at those that its file names";

/// How the columns of that table stand.
pub(super) const METRIC_ALIGNS: [Align; 10] = {
    use Align::{Left, Right};
    [Left, Left, Left, Right, Right, Left, Right, Right, Right, Right]
};

impl MetricRow {
    /// The row for a table of text.
    pub(super) fn cells(&self) -> Vec<String> {
        let MetricRow { unit, better, a, b, mark, delta, ci, p, n, .. } = self;
        let name = if self.decides { format!("{} *", self.name) } else { self.name.clone() };
        [&name, unit, *better, a, b, *mark, delta, ci, p, n].map(str::to_owned).to_vec()
    }
}

impl View {
    pub(super) fn new(comparison: &Comparison) -> View {
        let violations = &comparison.violations;
        let of = |arm| violations.iter().filter(|v| v.arm == arm).count();
        View {
            verdict: comparison.verdict.name(),
            mark: comparison.verdict.mark(),
            reason: comparison.reason.clone(),
            a: comparison.a.clone(),
            b: comparison.b.clone(),
            facts: facts(comparison),
            metrics: comparison.metrics.iter().map(metric_row).collect(),
            // What is held against B decides the verdict: it stands first and is never cut off.
            violations: {
                let (held, listed): (Vec<_>, Vec<_>) = violations.iter().partition(|v| v.new);
                held.into_iter().chain(listed).map(violation_row).collect()
            },
            violation_counts: (of(Arm::A), of(Arm::B), violations.iter().filter(|v| v.new).count()),
            moments: strongest(comparison).into_iter().map(moment_row).collect(),
            logs: log_rows(comparison),
            gate: gate_rows(comparison),
            levels: level_rows(comparison),
            swaps: swap_rows(comparison),
            self_test: comparison.self_test.as_ref().map(self_test),
        }
    }

    /// The metrics that any log gives a value for; the others would be rows of dashes.
    pub(super) fn defined_metrics(&self) -> impl Iterator<Item = &MetricRow> {
        self.metrics.iter().filter(|row| row.n != "0")
    }

    /// The names of the metrics without a value in both arms of any log.
    pub(super) fn undefined_metrics(&self) -> Vec<&str> {
        self.metrics.iter().filter(|row| row.n == "0").map(|row| row.name.as_str()).collect()
    }
}

fn facts(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let failed = comparison.failed_logs();
    let logs = comparison.logs.len();
    let mut facts = vec![
        ("A", comparison.a.clone()),
        ("B", comparison.b.clone()),
        ("mode", format!("{} loop", comparison.mode)),
    ];
    if !comparison.human.is_empty() {
        facts.push(("human", comparison.human.join(", ")));
    }
    if let Some(doubts) = comparison.plant_doubts() {
        facts.push(("plant", warned(&doubts)));
    } else if comparison.plant == "identified" {
        facts.push(("plant", "identified from each log".to_owned()));
    }
    if !comparison.faults.is_empty() {
        facts.push(("both under", comparison.faults.join(", ")));
    }
    facts.push((
        "logs",
        if failed > 0 { format!("{logs}, of which {failed} failed") } else { logs.to_string() },
    ));
    facts.extend(more_facts(comparison));
    facts
}

/// The controllers' parameters, the program, the evidence, the gate.
fn more_facts(comparison: &Comparison) -> Vec<(&'static str, String)> {
    let made_by = &comparison.provenance;
    let mut facts = Vec::new();
    let changes: Vec<String> = made_by
        .parameters
        .iter()
        .map(|change| {
            let of = |value: &Option<String>| value.clone().unwrap_or_else(|| "none".to_owned());
            format!("{} {} in A, {} in B", change.key, of(&change.a), of(&change.b))
        })
        .collect();
    let hash = |hash: &str| hash.get(..12).unwrap_or(hash).to_owned();
    if !made_by.a.params_hash.is_empty() {
        let differ = if changes.is_empty() { "none".to_owned() } else { changes.join("; ") };
        facts.push(("parameters that differ", differ));
        let hashes =
            format!("{} in A, {} in B", hash(&made_by.a.params_hash), hash(&made_by.b.params_hash));
        facts.push(("parameter hashes", hashes));
    }
    if !made_by.version.is_empty() {
        let commit =
            if made_by.commit.is_empty() { "unknown commit" } else { &hash(&made_by.commit) };
        let dirty = if made_by.dirty { ", with uncommitted changes" } else { "" };
        facts.push(("program", format!("{}, {commit}{dirty}", made_by.version)));
    }
    if comparison.clustered_by != "log" {
        facts.push(("clustered by", comparison.clustered_by.clone()));
    }
    let possible = comparison.violations.iter().filter(|v| v.possible).count();
    if possible > 0 {
        let text = format!("{possible} at some levels only: confirm live");
        facts.push(("possible violations of B", text));
    }
    if let Some(gate) = &comparison.gate {
        let mut text = gate.outcome.name().to_owned();
        if !gate.reasons.is_empty() {
            let _ = write!(text, ": {}", gate.reasons.join("; "));
        }
        facts.push(("gate", text));
    }
    facts
}

fn gate_rows(comparison: &Comparison) -> Vec<GateRow> {
    let gated = comparison.metrics.iter().filter(|metric| metric.gate != Gate::None);
    gated
        .map(|metric| GateRow {
            metric: metric.name.clone(),
            gate: metric.gate.name(),
            reason: metric.gate_reason.clone(),
        })
        .collect()
}

fn level_rows(comparison: &Comparison) -> Vec<LevelRow> {
    let rows = |metric: &MetricChange| {
        metric
            .levels
            .iter()
            .filter(|level| level.n > 0)
            .map(|level| LevelRow {
                metric: metric.name.clone(),
                human: level.human.clone(),
                estimates: if level.estimates { "estimate" } else { "stress" },
                a: number(level.a),
                b: number(level.b),
                delta: signed(level.delta),
                ci: interval(level.ci),
            })
            .collect::<Vec<_>>()
    };
    comparison.metrics.iter().filter(|metric| metric.primary).flat_map(rows).collect()
}

fn interval(ci: Option<Interval>) -> String {
    ci.map_or_else(
        || number(None),
        |ci| format!("[{}, {}]", signed(Some(ci.low)), signed(Some(ci.high))),
    )
}

fn metric_row(change: &MetricChange) -> MetricRow {
    let (mark, meaning) = mark(change);
    // A log in which only one arm has a value is no pair, but it is not hidden either.
    let mut n = change.n.to_string();
    if change.only_a > 0 {
        // Writing to a String cannot fail, here and below.
        let _ = write!(n, " (+{} A only)", change.only_a);
    }
    if change.only_b > 0 {
        let _ = write!(n, " (+{} B only)", change.only_b);
    }
    MetricRow {
        name: change.name.clone(),
        decides: change.decides(),
        unit: change.unit.clone(),
        group: change.group.name(),
        better: change.better.name(),
        formula: metric(&change.name).map_or("", |metric| metric.formula),
        a: number(change.a),
        b: number(change.b),
        delta: signed(change.delta),
        ci: interval(change.ci),
        p: number(change.p),
        n,
        mark,
        meaning,
    }
}

/// Which way a metric went, as a sign and in words.
fn mark(change: &MetricChange) -> (&'static str, &'static str) {
    match change.delta {
        None => ("", "undefined"),
        Some(0.0) if change.ci.is_none_or(|ci| ci.low == ci.high) => ("=", "no change"),
        Some(_) if !change.decidable => ("○", "within chance"),
        Some(delta) if change.better.improvement(delta) > 0.0 => ("▲", "better"),
        Some(_) => ("▼", "worse"),
    }
}

fn violation_row(violation: &ViolationRecord) -> ViolationRow {
    ViolationRow {
        log: violation.log.clone(),
        arm: violation.arm.letter(),
        kind: violation.kind.words(),
        t: seconds(violation.t_s),
        at_s: violation.t_s,
        lasted: seconds(violation.until_s - violation.t_s),
        depth: with_unit(&number(Some(violation.depth_m)), "m"),
        speed: with_unit(&number(Some(violation.speed_mps)), "m/s"),
        new: violation.new,
        possible: violation.possible,
    }
}

/// The moments that carry most, over all logs: a few of each metric, metrics whose change is
/// beyond chance first.
fn strongest(comparison: &Comparison) -> Vec<&Moment> {
    let mut metrics: Vec<&MetricChange> = comparison.metrics.iter().collect();
    // The sort is stable: otherwise the order of the catalogue stays.
    metrics.sort_by_key(|metric| !metric.decidable);
    let mut all = Vec::new();
    for metric in metrics {
        // A moment explains a change only if it points the way the change went.
        let change = metric.delta.unwrap_or(0.0);
        let mut of_metric: Vec<&Moment> = comparison
            .moments
            .iter()
            .filter(|moment| moment.metric == metric.name && moment.delta * change > 0.0)
            .collect();
        of_metric.sort_by(|x, y| libm::fabs(y.delta).total_cmp(&libm::fabs(x.delta)));
        all.extend(of_metric.into_iter().take(STRONGEST_PER_METRIC));
    }
    all
}

fn of_log<'a>(comparison: &'a Comparison, log: &'a str) -> impl Iterator<Item = &'a Moment> {
    comparison.moments.iter().filter(move |moment| moment.log == log)
}

fn moment_row(moment: &Moment) -> MomentRow {
    let unit = metric(&moment.metric).map_or("", |metric| metric.unit);
    MomentRow {
        log: moment.log.clone(),
        t: seconds(moment.t_s),
        at_s: moment.t_s,
        metric: moment.metric.clone(),
        delta: with_unit(&signed(Some(moment.delta)), unit),
        share: format!("{:.0} %", 100.0 * moment.share),
        why: moment.why.clone(),
    }
}

/// `better in override_m; worse in min_clearance_m`; empty for nothing.
fn indicative(indication: &Indication) -> String {
    let of = |what: &str, names: &[String]| {
        (!names.is_empty()).then(|| format!("{what} in {}", names.join(", ")))
    };
    let parts = [of("better", &indication.better), of("worse", &indication.worse)];
    parts.into_iter().flatten().collect::<Vec<_>>().join("; ")
}

fn log_rows(comparison: &Comparison) -> Vec<LogRow> {
    comparison
        .logs
        .iter()
        .map(|log| LogRow {
            log: log.log.clone(),
            failed: log.status == LogStatus::Failed,
            error: log.error.clone().unwrap_or_default(),
            operator: log.operator.clone(),
            horizon: with_unit(&number(log.horizon_s), "s"),
            first_cause: match (&log.first_cause, log.status) {
                (Some(cause), _) => cause.reason.clone(),
                (None, LogStatus::Ok) => "A and B agree throughout".to_owned(),
                (None, LogStatus::Failed) => String::new(),
            },
            indicative: indicative(&log.indicative),
            side_by_side: log.side_by_side.clone().unwrap_or_default(),
            first_cause_s: log.first_cause.as_ref().map(|cause| cause.t_s),
            metrics: comparison
                .metrics
                .iter()
                .filter_map(|row| {
                    let change = log.metrics.get(&row.name)?;
                    Some(LogMetricRow {
                        name: row.name.clone(),
                        unit: row.unit.clone(),
                        a: number(change.a),
                        b: number(change.b),
                        delta: signed(change.delta),
                    })
                })
                .collect(),
            moments: of_log(comparison, &log.log).map(moment_row).collect(),
        })
        .collect()
}
