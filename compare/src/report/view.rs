//! The cells of a report: every number already printed, once for all forms.

use std::fmt::Write;

use serde::Serialize;

use super::number::{number, seconds, signed, with_unit};
use super::table::Align;
use crate::comparison::{Arm, Comparison, LogStatus, MetricChange, Moment, ViolationRecord};
use crate::metrics::metric;

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
}

/// One metric over all logs.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MetricRow {
    pub(super) name: String,
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
    pub(super) lasted: String,
    pub(super) depth: String,
    pub(super) speed: String,
    pub(super) new: bool,
}

/// One moment.
#[derive(Clone, Debug, Serialize)]
pub(super) struct MomentRow {
    pub(super) log: String,
    pub(super) t: String,
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

/// How the columns of that table stand.
pub(super) const METRIC_ALIGNS: [Align; 10] = {
    use Align::{Left, Right};
    [Left, Left, Left, Right, Right, Left, Right, Right, Right, Right]
};

impl MetricRow {
    /// The row for a table of text.
    pub(super) fn cells(&self) -> Vec<String> {
        let MetricRow { name, unit, better, a, b, mark, delta, ci, p, n, .. } = self;
        [name, unit, *better, a, b, *mark, delta, ci, p, n].map(str::to_owned).to_vec()
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
    facts.push((
        "logs",
        if failed > 0 { format!("{logs}, of which {failed} failed") } else { logs.to_string() },
    ));
    facts
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
        unit: change.unit.clone(),
        group: change.group.name(),
        better: change.better.name(),
        formula: metric(&change.name).map_or("", |metric| metric.formula),
        a: number(change.a),
        b: number(change.b),
        delta: signed(change.delta),
        ci: change.ci.map_or_else(
            || number(None),
            |ci| format!("[{}, {}]", signed(Some(ci.low)), signed(Some(ci.high))),
        ),
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
        lasted: seconds(violation.until_s - violation.t_s),
        depth: with_unit(&number(Some(violation.depth_m)), "m"),
        speed: with_unit(&number(Some(violation.speed_mps)), "m/s"),
        new: violation.new,
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
        metric: moment.metric.clone(),
        delta: with_unit(&signed(Some(moment.delta)), unit),
        share: format!("{:.0} %", 100.0 * moment.share),
        why: moment.why.clone(),
    }
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
