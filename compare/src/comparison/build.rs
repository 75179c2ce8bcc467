//! From the runs of both arms to the result object.

use std::collections::BTreeSet;

use schemas::Scenario;

use super::moments::moments;
use super::result::{
    Arm, Change, Comparison, Gate, LogResult, LogStatus, MetricChange, Scene, ViolationRecord,
};
use super::verdict;
use crate::CompareError;
use crate::diff::Diff;
use crate::metrics::{CATALOGUE, Measured, Metric, ViolationKind};
use crate::statistics::{bca, mean, sign_flip};

/// Confidence of every interval.
const LEVEL: f64 = 0.95;

/// What is asked.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Question {
    /// Name of the first controller.
    pub a: String,
    /// Name of the second.
    pub b: String,
    /// `open` or `closed`.
    pub mode: String,
    /// How the recorded person was brought back; empty in open loop.
    pub human: Vec<String>,
}

/// One log and what both controllers made of it.
#[derive(Clone, Debug)]
pub struct LogPair {
    /// Its name in reports.
    pub log: String,
    /// Who steered; may be empty.
    pub operator: String,
    /// World, body and task, for the map; `None` where the log could not be read.
    pub scenario: Option<Scenario>,
    /// A's run, or why there is none.
    pub a: Result<Measured, String>,
    /// B's run, or why there is none.
    pub b: Result<Measured, String>,
    /// A's run against B's. An error, or `None` where both arms ran, makes the log a failed one.
    pub diff: Option<Result<Diff, String>>,
}

impl LogPair {
    /// Everything there is of a log that went well; otherwise what went wrong.
    fn whole(&self) -> Result<(&Measured, &Measured, &Diff), String> {
        match (&self.a, &self.b, &self.diff) {
            (Ok(a), Ok(b), Some(Ok(diff))) => Ok((a, b, diff)),
            (a, b, diff) => {
                let mut errors = Vec::new();
                errors.extend(a.as_ref().err().map(|error| format!("A: {error}")));
                errors.extend(b.as_ref().err().map(|error| format!("B: {error}")));
                if let Some(Err(error)) = diff {
                    errors.push(format!("A against B: {error}"));
                }
                if errors.is_empty() {
                    errors.push("A was not compared with B".to_owned());
                }
                Err(errors.join("; "))
            }
        }
    }
}

/// Compares two controllers over logs.
///
/// # Errors
/// [`CompareError::NoLogs`] for no log, and [`CompareError::NeverEngaged`] when every log ran but
/// in none did either controller ever take over (k = 0): agreement of two controllers that were
/// never called upon means nothing.
pub fn compare(question: &Question, logs: Vec<LogPair>) -> Result<Comparison, CompareError> {
    if logs.is_empty() {
        return Err(CompareError::NoLogs);
    }
    let mut comparison = Comparison {
        verdict: super::Verdict::Undecided,
        reason: String::new(),
        a: question.a.clone(),
        b: question.b.clone(),
        mode: question.mode.clone(),
        human: question.human.clone(),
        logs: logs.iter().map(log_result).collect(),
        metrics: Vec::new(),
        violations: logs.iter().flat_map(violations).collect(),
        moments: Vec::new(),
        report: Vec::new(),
        scenes: Vec::new(),
    };
    comparison.metrics = CATALOGUE.iter().map(|metric| over_logs(metric, &comparison)).collect();
    verdict::mark_decidable(&mut comparison.metrics);
    for log in &logs {
        if let Ok((a, b, _)) = log.whole() {
            comparison.moments.extend(moments(&log.log, a, b));
        }
    }
    let wholes = logs.iter().map(LogPair::whole);
    let all_same = wholes.clone().all(|log| log.is_ok_and(|(_, _, diff)| diff.same_behaviour));
    let engaged = wholes
        .flatten()
        .any(|(a, b, _)| a.metrics.engaged_steps > 0 || b.metrics.engaged_steps > 0);
    (comparison.verdict, comparison.reason) = verdict::verdict(&comparison, all_same);
    if !engaged && comparison.verdict != super::Verdict::Failed {
        return Err(CompareError::NeverEngaged { logs: logs.len() });
    }
    comparison.scenes = logs.into_iter().map(scene).collect();
    Ok(comparison)
}

fn log_result(log: &LogPair) -> LogResult {
    let whole = log.whole();
    let mut result = LogResult {
        log: log.log.clone(),
        status: LogStatus::Ok,
        error: None,
        operator: log.operator.clone(),
        horizon_s: None,
        metrics: std::collections::BTreeMap::new(),
        first_cause: None,
    };
    match whole {
        Ok((a, b, diff)) => {
            let pairs = a.metrics.values().iter().zip(b.metrics.values());
            result.metrics = CATALOGUE
                .iter()
                .zip(pairs)
                .map(|(metric, (a, b))| (metric.name.to_owned(), Change::between(*a, *b)))
                .collect();
            result.first_cause.clone_from(&diff.first_cause);
        }
        Err(error) => {
            result.status = LogStatus::Failed;
            result.error = Some(error);
        }
    }
    result
}

/// The violations of both arms, by time. Those of an arm count even where the other failed.
fn violations(log: &LogPair) -> Vec<ViolationRecord> {
    let of = |arm: &Result<Measured, String>| {
        arm.as_ref().map(|run| run.violations.clone()).unwrap_or_default()
    };
    let (a, b) = (of(&log.a), of(&log.b));
    let kinds_of_a: BTreeSet<ViolationKind> = a.iter().map(|violation| violation.kind).collect();
    let mut records: Vec<ViolationRecord> = Vec::new();
    records.extend(a.iter().map(|v| ViolationRecord::new(&log.log, Arm::A, v, false)));
    records.extend(b.iter().map(|v| {
        let new = v.kind.counts_against_the_controller() && !kinds_of_a.contains(&v.kind);
        ViolationRecord::new(&log.log, Arm::B, v, new)
    }));
    records.sort_by(|x, y| x.t_s.total_cmp(&y.t_s).then(x.arm.cmp(&y.arm)));
    records
}

/// One metric over the logs that went well.
fn over_logs(metric: &Metric, comparison: &Comparison) -> MetricChange {
    let changes: Vec<Change> =
        comparison.logs.iter().filter_map(|log| log.metrics.get(metric.name).copied()).collect();
    let (mut a, mut b, mut deltas) = (Vec::new(), Vec::new(), Vec::new());
    for change in &changes {
        if let (Some(in_a), Some(in_b), Some(delta)) = (change.a, change.b, change.delta) {
            a.push(in_a);
            b.push(in_b);
            deltas.push(delta);
        }
    }
    // Resampling must not depend on the order in which the logs were named.
    deltas.sort_by(f64::total_cmp);
    MetricChange {
        name: metric.name.to_owned(),
        unit: metric.unit.to_owned(),
        better: metric.better,
        group: metric.group,
        primary: metric.primary,
        a: mean(&a),
        b: mean(&b),
        delta: mean(&deltas),
        ci: bca(&deltas, LEVEL),
        p: sign_flip(&deltas),
        n: deltas.len(),
        only_a: changes.iter().filter(|c| c.a.is_some() && c.b.is_none()).count(),
        only_b: changes.iter().filter(|c| c.a.is_none() && c.b.is_some()).count(),
        floor: None,
        decidable: false,
        gate: Gate::None,
    }
}

fn scene(log: LogPair) -> Scene {
    Scene {
        log: log.log,
        scenario: log.scenario,
        a: log.a.ok().map(|run| run.track),
        b: log.b.ok().map(|run| run.track),
    }
}
