//! The gate: which changes a team accepts, as a TOML file.
//!
//! ```toml
//! [violations]
//! new = 0                       # held against B, at every level of the ladder [default: 0]
//! possible = 3                  # at some levels only [default: any number]
//!
//! [metrics.min_clearance_m]
//! margin = 0.02                 # B may be worse by at most this, in the metric's unit
//! required_n = 30               # logs (clusters of them) without which nothing is decided [default: 8]
//! mean_limit = 0.10             # hard limit of B's mean
//! log_limit = 0.0               # hard limit of B in every single log
//! ```
//!
//! A metric **passes** where the 95 % interval of B − A lies within its margin: B is not inferior. It
//! **fails** where B is worse than the margin beyond chance: the whole interval lies beyond it and the
//! randomisation test against the margin, adjusted by Holm over the gated metrics, gives at most 0.05;
//! or where a hard limit is broken. Everything else is **undecided**. With several levels of the ladder
//! each level's interval has to lie on the same side.
//!
//! All of it has to pass, each at its own level: that needs no adjustment (Berger, "Multiparameter
//! hypothesis testing and acceptance sampling", Technometrics 24, 1982). One failure is enough, and
//! that does.

use std::collections::BTreeMap;

use toml::{Table, Value};

use super::cluster::pooled;
use super::result::{Arm, Comparison, Gate, GateResult, LogStatus, MetricChange};
use crate::CompareError;
use crate::metrics::{Better, CATALOGUE, metric};
use crate::report::{number, signed};
use crate::statistics::{Interval, holm, sign_flip};

/// Largest chance that the gate as a whole fails by chance alone.
const ALPHA: f64 = 0.05;

/// Fewer clusters than this decide nothing unless the file says so: seven of one sign have p = 0.016,
/// which Holm over four metrics takes above 0.05.
const REQUIRED_N: u64 = 8;

/// What is asked of one metric.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MetricGate {
    /// B may be worse than A by at most this, in the metric's unit; `None` where only limits count.
    pub margin: Option<f64>,
    /// How many clusters of logs there must be.
    pub required_n: usize,
    /// B's mean must be at least, or at most, this.
    pub mean_limit: Option<f64>,
    /// B must be at least, or at most, this in every log.
    pub log_limit: Option<f64>,
}

/// A gate file.
#[derive(Clone, Debug, PartialEq)]
pub struct GateFile {
    /// Most violations held against B.
    pub new_violations: usize,
    /// Most violations that only some levels of the ladder show; `None` for any number.
    pub possible_violations: Option<usize>,
    /// By metric.
    pub metrics: BTreeMap<String, MetricGate>,
}

fn invalid(what: String) -> CompareError {
    CompareError::Gate(what)
}

/// A table's value under a key, with the key's full name.
fn table<'a>(parent: &'a Table, key: &str) -> Result<Option<&'a Table>, CompareError> {
    match parent.get(key) {
        None => Ok(None),
        Some(Value::Table(table)) => Ok(Some(table)),
        Some(other) => Err(invalid(format!("`{key}` = {other}: expected a table"))),
    }
}

fn only(table: &Table, prefix: &str, known: &[&str]) -> Result<(), CompareError> {
    match table.keys().find(|key| !known.contains(&key.as_str())) {
        None => Ok(()),
        Some(key) => Err(invalid(format!("`{prefix}{key}`: expected one of {}", known.join(", ")))),
    }
}

fn real(table: &Table, prefix: &str, key: &str, least: f64) -> Result<Option<f64>, CompareError> {
    let Some(value) = table.get(key) else { return Ok(None) };
    let x = match value {
        Value::Float(x) => *x,
        Value::Integer(n) => *n as f64,
        _ => f64::NAN,
    };
    if x.is_finite() && x >= least {
        return Ok(Some(x));
    }
    let range = if least.is_finite() {
        format!("a finite number, at least {least}")
    } else {
        "a finite number".to_owned()
    };
    Err(invalid(format!("`{prefix}{key}` = {value}: expected {range}")))
}

fn whole(
    table: &Table,
    prefix: &str,
    key: &str,
    least: u64,
) -> Result<Option<usize>, CompareError> {
    let Some(value) = table.get(key) else { return Ok(None) };
    match value.as_integer().and_then(|n| u64::try_from(n).ok()).filter(|n| *n >= least) {
        Some(n) => Ok(Some(usize::try_from(n).unwrap_or(usize::MAX))),
        None => Err(invalid(format!(
            "`{prefix}{key}` = {value}: expected a whole number, at least {least}"
        ))),
    }
}

impl GateFile {
    /// Reads a gate file.
    ///
    /// # Errors
    /// [`CompareError::Gate`] that names the key, the value, and what was expected there: not TOML, an
    /// unknown key or metric, a value out of range, or nothing to gate by.
    pub fn from_toml(text: &str) -> Result<GateFile, CompareError> {
        let file: Table =
            text.parse().map_err(|error: toml::de::Error| invalid(error.to_string()))?;
        only(&file, "", &["violations", "metrics"])?;
        let mut gate =
            GateFile { new_violations: 0, possible_violations: None, metrics: BTreeMap::new() };
        if let Some(violations) = table(&file, "violations")? {
            only(violations, "violations.", &["new", "possible"])?;
            gate.new_violations = whole(violations, "violations.", "new", 0)?.unwrap_or(0);
            gate.possible_violations = whole(violations, "violations.", "possible", 0)?;
        }
        for (name, row) in table(&file, "metrics")?.into_iter().flatten() {
            gate.metrics.insert(name.clone(), metric_gate(name, row)?);
        }
        if gate.metrics.is_empty() {
            return Err(invalid("no [metrics.NAME]: nothing to gate by".to_owned()));
        }
        Ok(gate)
    }

    /// Says of each metric, and of the comparison as a whole, whether it passes.
    pub(super) fn apply(&self, comparison: &mut Comparison) {
        let mut reasons = self.violations(comparison);
        let failed = comparison.failed_logs();
        if failed > 0 {
            reasons.push(format!("{failed} of {} logs failed", comparison.logs.len()));
        }
        let mut outcome = if reasons.is_empty() { Gate::Pass } else { Gate::Fail };
        let p: Vec<f64> =
            self.metrics.iter().map(|(name, gate)| p_beyond(comparison, name, gate)).collect();
        for ((name, gate), p) in self.metrics.iter().zip(holm(&p)) {
            let limits = limits(comparison, name, gate);
            let Some(change) = comparison.metrics.iter_mut().find(|m| m.name == *name) else {
                continue;
            };
            let (said, reason) = match limits {
                Some(reason) => (Gate::Fail, reason),
                None => judged(change, gate, p),
            };
            if said != Gate::Pass {
                reasons.push(format!("{name}: {reason}"));
                outcome =
                    if said == Gate::Fail || outcome == Gate::Fail { Gate::Fail } else { said };
            }
            (change.gate, change.gate_reason) = (said, reason);
        }
        comparison.gate = Some(GateResult { outcome, reasons });
    }

    fn violations(&self, comparison: &Comparison) -> Vec<String> {
        let mut reasons = Vec::new();
        let count = |of: fn(&super::ViolationRecord) -> bool| {
            comparison.violations.iter().filter(|v| v.arm == Arm::B && of(v)).count()
        };
        let (new, possible) = (count(|v| v.new), count(|v| v.possible));
        if new > self.new_violations {
            reasons.push(format!(
                "{new} violations of B that A does not have, at most {} allowed",
                self.new_violations
            ));
        }
        if let Some(most) = self.possible_violations
            && possible > most
        {
            reasons.push(format!("{possible} possible violations of B, at most {most} allowed"));
        }
        reasons
    }
}

fn metric_gate(name: &str, row: &Value) -> Result<MetricGate, CompareError> {
    let known = metric(name).filter(|metric| metric.group.is_repeatable());
    if known.is_none() {
        let names: Vec<&str> =
            CATALOGUE.iter().filter(|m| m.group.is_repeatable()).map(|m| m.name).collect();
        return Err(invalid(format!("`metrics.{name}`: expected one of {}", names.join(", "))));
    }
    let Value::Table(row) = row else {
        return Err(invalid(format!("`metrics.{name}` = {row}: expected a table")));
    };
    let prefix = format!("metrics.{name}.");
    only(row, &prefix, &["margin", "required_n", "mean_limit", "log_limit"])?;
    let gate = MetricGate {
        margin: real(row, &prefix, "margin", 0.0)?,
        required_n: whole(row, &prefix, "required_n", 2)?.unwrap_or(REQUIRED_N as usize),
        mean_limit: real(row, &prefix, "mean_limit", f64::NEG_INFINITY)?,
        log_limit: real(row, &prefix, "log_limit", f64::NEG_INFINITY)?,
    };
    if gate.margin.is_none() && gate.mean_limit.is_none() && gate.log_limit.is_none() {
        return Err(invalid(format!(
            "`metrics.{name}`: expected a margin, a mean_limit or a log_limit"
        )));
    }
    Ok(gate)
}

/// The chance that differences like these come from a B that is worse by no more than the margin; 1
/// where nothing speaks for that.
fn p_beyond(comparison: &Comparison, name: &str, gate: &MetricGate) -> f64 {
    let (Some(margin), Some(metric)) = (gate.margin, metric(name)) else { return 1.0 };
    let beyond =
        comparison.logs.iter().filter(|log| log.status == LogStatus::Ok).filter_map(|log| {
            let delta = log.metrics.get(name)?.delta?;
            Some((log.cluster.as_str(), -metric.better.improvement(delta) - margin))
        });
    let sums: Vec<f64> = pooled(beyond).iter().map(|cluster| cluster.sum).collect();
    if sums.iter().sum::<f64>() <= 0.0 {
        return 1.0;
    }
    sign_flip(&sums).unwrap_or(1.0)
}

/// The hard limit that B breaks, if any.
fn limits(comparison: &Comparison, name: &str, gate: &MetricGate) -> Option<String> {
    let better = metric(name)?.better;
    let breaks = |value: f64, limit: f64| match better {
        Better::Lower => value > limit,
        Better::Higher => value < limit,
    };
    let side = if better == Better::Lower { "at most" } else { "at least" };
    let mean = comparison.metric(name).and_then(|change| change.b);
    if let (Some(limit), Some(mean)) = (gate.mean_limit, mean)
        && breaks(mean, limit)
    {
        return Some(format!(
            "{} in B on average, {side} {} allowed",
            number(Some(mean)),
            number(Some(limit))
        ));
    }
    let limit = gate.log_limit?;
    let broken = comparison.logs.iter().find_map(|log| {
        let b = log.metrics.get(name)?.b.filter(|b| breaks(*b, limit))?;
        Some((b, &log.log))
    });
    broken.map(|(b, log)| {
        format!("{} in B in {log}, {side} {} allowed", number(Some(b)), number(Some(limit)))
    })
}

/// How much worse B is at the ends of an interval: least, most.
fn worsening(better: Better, ci: Interval) -> [f64; 2] {
    match better {
        Better::Lower => [ci.low, ci.high],
        Better::Higher => [-ci.high, -ci.low],
    }
}

/// Whether a metric stays within its margin.
fn judged(change: &MetricChange, gate: &MetricGate, p: f64) -> (Gate, String) {
    let enough = change.clusters >= gate.required_n;
    let few = || format!("{} logs or clusters, {} required", change.clusters, gate.required_n);
    let Some(margin) = gate.margin else {
        // Only limits, and none is broken. Where no log has a value none was looked at.
        return if change.b.is_none() {
            (Gate::Undecided, "no log has a value".to_owned())
        } else {
            (Gate::Pass, String::new())
        };
    };
    let Some(ci) = change.ci.filter(|_| enough) else { return (Gate::Undecided, few()) };
    let levels = change.levels.iter().map(|level| level.ci);
    let all: Vec<Option<Interval>> = std::iter::once(Some(ci)).chain(levels).collect();
    let every = |holds: &dyn Fn([f64; 2]) -> bool| {
        all.iter().all(|ci| ci.is_some_and(|ci| holds(worsening(change.better, ci))))
    };
    if every(&|[_, most]| most <= margin) {
        return (Gate::Pass, String::new());
    }
    let shown = format!(
        "B - A {} [{}, {}], margin {}",
        signed(change.delta),
        signed(Some(ci.low)),
        signed(Some(ci.high)),
        number(Some(margin))
    );
    if every(&|[least, _]| least > margin) {
        if p <= ALPHA {
            (Gate::Fail, format!("worse than the margin: {shown}"))
        } else {
            let chance = format!("p {} corrected, {ALPHA} at most", number(Some(p)));
            (
                Gate::Undecided,
                format!("not decided, too few sessions to rule out chance ({chance}): {shown}"),
            )
        }
    } else {
        (Gate::Undecided, format!("not decided: {shown}"))
    }
}
