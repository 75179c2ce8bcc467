//! From the runs of both arms to the result object.

use std::collections::{BTreeMap, BTreeSet};

use schemas::Scenario;

use super::cluster::{clusters, pooled};
use super::gate::GateFile;
use super::indication::indication;
use super::moments::moments;
use super::provenance::parameters;
use super::result::{
    Arm, Change, Comparison, Gate, LevelChange, LevelResult, LogResult, LogStatus, MetricChange,
    Provenance, Scene, ViolationRecord,
};
use super::verdict;
use crate::CompareError;
use crate::diff::Diff;
use crate::metrics::{CATALOGUE, Measured, Metric, ViolationKind};
use crate::statistics::{bca_clustered, mean, sign_flip};

/// Confidence of every interval.
const LEVEL: f64 = 0.95;

/// What is asked.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Question {
    /// Name of the first controller.
    pub a: String,
    /// Name of the second.
    pub b: String,
    /// `open` or `closed`.
    pub mode: String,
    /// How the recorded person was brought back, by level; empty in open loop.
    pub human: Vec<String>,
    /// What runs the comparison, and with which parameters. Those that differ are found here.
    pub provenance: Provenance,
    /// The gate, where there is one.
    pub gate: Option<GateFile>,
    /// What both arms were put under: named faults between sensors and controller.
    pub faults: Vec<String>,
    /// Which plant both arms drove in closed loop: `recorded`, the claimed one, or `identified`; may be empty.
    pub plant: String,
}

/// Both arms of a log with one model of the person.
#[derive(Clone, Debug)]
pub struct LevelPair {
    /// The level of the ladder; empty in open loop.
    pub human: String,
    /// Whether it counts towards the estimate. A level that only stresses the controller does not; if
    /// none does, all count.
    pub estimates: bool,
    /// Until when the recorded person is to be believed in both arms, seconds; `None` where that was
    /// not determined.
    pub horizon_s: Option<f64>,
    /// A's run, or why there is none.
    pub a: Result<Measured, String>,
    /// B's run, or why there is none.
    pub b: Result<Measured, String>,
    /// A's run against B's. An error, or `None` where both arms ran, makes the log a failed one.
    pub diff: Option<Result<Diff, String>>,
}

/// One log and what both controllers made of it.
#[derive(Clone, Debug)]
pub struct LogPair {
    /// Its name in reports.
    pub log: String,
    /// Who steered; may be empty.
    pub operator: String,
    /// BLAKE3 of the file, in hexadecimal; may be empty.
    pub hash: String,
    /// World, body and task, for the map; `None` where the log could not be read.
    pub scenario: Option<Scenario>,
    /// What was recorded, where A recorded it: its distance from A's simulated run is the floor below
    /// which no effect is believed. `None` where another controller recorded, and in open loop.
    pub recorded: Option<Measured>,
    /// Where the log is clearly at odds with the plant that it claims, and both arms drove that one: what it
    /// shows instead, in a sentence.
    pub plant_doubt: Option<String>,
    /// Why the log says nothing of its plant, or nobody asked it; `None` where it does.
    pub plant_untold: Option<String>,
    /// The faults that met nothing in the log that they could change, each with what there was none of.
    pub unmet_faults: Vec<String>,
    /// The levels of the ladder, in the same order for every log; at least one.
    pub levels: Vec<LevelPair>,
}

impl LevelPair {
    /// A level of which nothing could be run.
    pub fn failed(error: &str) -> LevelPair {
        let error = || Err(error.to_owned());
        LevelPair {
            human: String::new(),
            estimates: true,
            a: error(),
            b: error(),
            diff: None,
            horizon_s: None,
        }
    }

    /// Everything there is of a level that went well; otherwise what went wrong.
    fn whole(&self) -> Result<Whole<'_>, String> {
        match (&self.a, &self.b, &self.diff) {
            (Ok(a), Ok(b), Some(Ok(diff))) => Ok(Whole { a, b, diff }),
            (a, b, diff) => {
                let mut errors = Vec::new();
                match (a, b) {
                    (Err(a), Err(b)) if a == b => errors.push(format!("A and B: {a}")),
                    (a, b) => {
                        errors.extend(a.as_ref().err().map(|error| format!("A: {error}")));
                        errors.extend(b.as_ref().err().map(|error| format!("B: {error}")));
                    }
                }
                if let Some(Err(error)) = diff {
                    errors.push(format!("A against B: {error}"));
                }
                if errors.is_empty() {
                    errors.push("A was not compared with B".to_owned());
                }
                let level =
                    if self.human.is_empty() { String::new() } else { format!("{}: ", self.human) };
                Err(format!("{level}{}", errors.join("; ")))
            }
        }
    }
}

/// Both arms of a level that went well.
#[derive(Clone, Copy)]
struct Whole<'a> {
    a: &'a Measured,
    b: &'a Measured,
    diff: &'a Diff,
}

impl LogPair {
    /// Every level, or what went wrong with any of them.
    fn whole(&self) -> Result<Vec<Whole<'_>>, String> {
        if self.levels.is_empty() {
            return Err("no level of the ladder was run".to_owned());
        }
        self.levels.iter().map(LevelPair::whole).collect()
    }

    /// Whether a level counts: those that estimate, or all where none does.
    fn counts(&self, level: &LevelPair) -> bool {
        level.estimates || self.levels.iter().all(|level| !level.estimates)
    }

    /// The level that stands for the log in pictures, moments and the first cause.
    fn shown(&self) -> usize {
        self.levels.iter().position(|level| self.counts(level)).unwrap_or(0)
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
    let (clustered_by, clusters) = clusters(&logs);
    let mut provenance = question.provenance.clone();
    provenance.parameters = parameters(&provenance.a.params_toml, &provenance.b.params_toml);
    let mut comparison = Comparison {
        verdict: super::Verdict::Undecided,
        reason: String::new(),
        a: question.a.clone(),
        b: question.b.clone(),
        mode: question.mode.clone(),
        human: question.human.clone(),
        faults: question.faults.clone(),
        plant: question.plant.clone(),
        provenance,
        gate: None,
        clustered_by: clustered_by.to_owned(),
        logs: logs.iter().zip(clusters).map(|(log, cluster)| log_result(log, cluster)).collect(),
        metrics: Vec::new(),
        violations: logs.iter().flat_map(violations).collect(),
        moments: Vec::new(),
        swaps: Vec::new(),
        self_test: None,
        report: Vec::new(),
        scenes: Vec::new(),
    };
    comparison.metrics = CATALOGUE.iter().map(|metric| over_logs(metric, &comparison)).collect();
    verdict::mark_decidable(&mut comparison.metrics);
    let (mut all_same, mut engaged) = (true, false);
    for log in &logs {
        let Ok(levels) = log.whole() else {
            all_same = false;
            continue;
        };
        all_same &= levels.iter().all(|level| level.diff.same_behaviour);
        let drives = |run: &Measured| run.metrics.engaged_steps > 0;
        engaged |= levels.iter().any(|level| drives(level.a) || drives(level.b));
        let shown = levels[log.shown()];
        comparison.moments.extend(moments(&log.log, shown.a, shown.b));
    }
    (comparison.verdict, comparison.reason) = verdict::verdict(&comparison, all_same);
    if !engaged && comparison.verdict != super::Verdict::Failed {
        return Err(CompareError::NeverEngaged { logs: logs.len() });
    }
    if let Some(gate) = &question.gate {
        gate.apply(&mut comparison);
    }
    comparison.scenes = logs.into_iter().map(scene).collect();
    Ok(comparison)
}

/// Until when the levels that estimate are to be believed; all levels where none does.
fn horizon_s(log: &LogPair) -> Option<f64> {
    let none = !log.levels.iter().any(|level| level.estimates);
    let counted = log.levels.iter().filter(|level| none || level.estimates);
    counted.filter_map(|level| level.horizon_s).min_by(f64::total_cmp)
}

fn log_result(log: &LogPair, cluster: String) -> LogResult {
    let mut result = LogResult {
        log: log.log.clone(),
        status: LogStatus::Ok,
        error: None,
        operator: log.operator.clone(),
        horizon_s: horizon_s(log),
        cluster,
        hash: log.hash.clone(),
        metrics: BTreeMap::new(),
        levels: Vec::new(),
        floor: BTreeMap::new(),
        indicative: super::Indication::default(),
        first_cause: None,
        plant_doubt: log.plant_doubt.clone(),
        plant_untold: log.plant_untold.clone(),
        unmet_faults: log.unmet_faults.clone(),
        side_by_side: None,
    };
    let wholes = match log.whole() {
        Ok(wholes) => wholes,
        Err(error) => {
            result.status = LogStatus::Failed;
            result.error = Some(error);
            return result;
        }
    };
    let levels: Vec<LevelResult> = log
        .levels
        .iter()
        .zip(&wholes)
        .map(|(level, whole)| LevelResult {
            human: level.human.clone(),
            estimates: log.counts(level),
            metrics: changes(whole.a, whole.b),
        })
        .collect();
    result.metrics = CATALOGUE
        .iter()
        .map(|metric| (metric.name.to_owned(), estimate(&levels, metric.name)))
        .collect();
    if let Some(recorded) = &log.recorded {
        for (metric, recorded) in CATALOGUE.iter().zip(recorded.metrics.values()) {
            let simulated = result.metrics.get(metric.name).and_then(|change| change.a);
            if let (Some(simulated), Some(recorded)) = (simulated, recorded) {
                result.floor.insert(metric.name.to_owned(), simulated - recorded);
            }
        }
    }
    result.indicative = indication(&levels, &result.floor);
    result.first_cause.clone_from(&wholes[log.shown()].diff.first_cause);
    if levels.len() > 1 {
        result.levels = levels;
    }
    result
}

/// Every metric in both arms.
fn changes(a: &Measured, b: &Measured) -> BTreeMap<String, Change> {
    let pairs = a.metrics.values().iter().zip(b.metrics.values());
    CATALOGUE
        .iter()
        .zip(pairs)
        .map(|(metric, (a, b))| (metric.name.to_owned(), Change::between(*a, *b)))
        .collect()
}

/// One metric over the levels that count: the mean of those with a value in both arms.
fn estimate(levels: &[LevelResult], name: &str) -> Change {
    let counting: Vec<Change> = levels
        .iter()
        .filter(|level| level.estimates)
        .filter_map(|level| level.metrics.get(name).copied())
        .collect();
    if let [only] = counting[..] {
        return only;
    }
    let paired: Vec<&Change> = counting.iter().filter(|change| change.delta.is_some()).collect();
    let over = |value: fn(&Change) -> Option<f64>| {
        mean(&paired.iter().filter_map(|change| value(change)).collect::<Vec<_>>())
    };
    if paired.is_empty() {
        // A value of one arm only is not hidden.
        let first = |value: fn(&Change) -> Option<f64>| counting.iter().find_map(value);
        let (a, b) = (first(|change| change.a), first(|change| change.b));
        return Change { a, b: if a.is_some() { None } else { b }, delta: None };
    }
    Change::between(over(|change| change.a), over(|change| change.b))
}

/// The violations of both arms, by time. Those of an arm count even where the other failed.
fn violations(log: &LogPair) -> Vec<ViolationRecord> {
    let of = |arm: &Result<Measured, String>| {
        arm.as_ref().map(|run| run.violations.clone()).unwrap_or_default()
    };
    let mut records: Vec<ViolationRecord> = Vec::new();
    // At how many levels B does what A does not do there.
    let mut against: BTreeMap<ViolationKind, usize> = BTreeMap::new();
    for level in &log.levels {
        let human = if log.levels.len() > 1 { level.human.as_str() } else { "" };
        let (a, b) = (of(&level.a), of(&level.b));
        let kinds_of_a: BTreeSet<ViolationKind> = a.iter().map(|v| v.kind).collect();
        let kinds_of_b: BTreeSet<ViolationKind> = b.iter().map(|v| v.kind).collect();
        for kind in kinds_of_b.difference(&kinds_of_a) {
            *against.entry(*kind).or_default() += 1;
        }
        records.extend(a.iter().map(|v| ViolationRecord::new(&log.log, human, Arm::A, v)));
        records.extend(b.iter().map(|v| {
            let new = v.kind.counts_against_the_controller() && !kinds_of_a.contains(&v.kind);
            // Whether at every level is known at the end.
            ViolationRecord { new, ..ViolationRecord::new(&log.log, human, Arm::B, v) }
        }));
    }
    for record in records.iter_mut().filter(|record| record.new) {
        record.new = against.get(&record.kind) == Some(&log.levels.len());
        record.possible = !record.new;
    }
    records.sort_by(|x, y| x.t_s.total_cmp(&y.t_s).then(x.arm.cmp(&y.arm)));
    records
}

/// What there is to say of one metric over some logs.
struct Pooled {
    a: Option<f64>,
    b: Option<f64>,
    delta: Option<f64>,
    ci: Option<crate::statistics::Interval>,
    p: Option<f64>,
    n: usize,
    clusters: usize,
}

/// Pools one metric over logs, each with its cluster.
fn over<'a>(changes: impl Iterator<Item = (&'a str, Change)>) -> Pooled {
    let (mut a, mut b, mut deltas) = (Vec::new(), Vec::new(), Vec::new());
    for (cluster, change) in changes {
        if let (Some(in_a), Some(in_b), Some(delta)) = (change.a, change.b, change.delta) {
            a.push(in_a);
            b.push(in_b);
            deltas.push((cluster, delta));
        }
    }
    let clusters = pooled(deltas.iter().copied());
    // Sums must not depend on the order in which the logs were named.
    let mut sorted: Vec<f64> = deltas.iter().map(|(_, delta)| *delta).collect();
    sorted.sort_by(f64::total_cmp);
    Pooled {
        a: mean(&a),
        b: mean(&b),
        delta: mean(&sorted),
        ci: bca_clustered(&clusters, LEVEL),
        p: sign_flip(&clusters.iter().map(|cluster| cluster.sum).collect::<Vec<_>>()),
        n: deltas.len(),
        clusters: clusters.len(),
    }
}

/// One metric over the logs that went well.
fn over_logs(metric: &Metric, comparison: &Comparison) -> MetricChange {
    let ok = || comparison.logs.iter().filter(|log| log.status == LogStatus::Ok);
    let changes: Vec<(&str, Change)> = ok()
        .filter_map(|log| Some((log.cluster.as_str(), *log.metrics.get(metric.name)?)))
        .collect();
    let levels = comparison.logs.iter().map(|log| log.levels.len()).max().unwrap_or(0);
    let levels = (0..levels).filter_map(|i| {
        let level = ok().find_map(|log| log.levels.get(i))?;
        let pooled = over(ok().filter_map(|log| {
            let change = log.levels.get(i)?.metrics.get(metric.name)?;
            Some((log.cluster.as_str(), *change))
        }));
        Some(LevelChange {
            human: level.human.clone(),
            estimates: level.estimates,
            a: pooled.a,
            b: pooled.b,
            delta: pooled.delta,
            ci: pooled.ci,
            n: pooled.n,
        })
    });
    // The bias of the simulation; what varies from log to log is in the interval already.
    let mut gaps: Vec<f64> = ok().filter_map(|log| log.floor.get(metric.name).copied()).collect();
    gaps.sort_by(f64::total_cmp);
    let pooled = over(changes.iter().copied());
    MetricChange {
        name: metric.name.to_owned(),
        unit: metric.unit.to_owned(),
        better: metric.better,
        group: metric.group,
        primary: metric.primary,
        a: pooled.a,
        b: pooled.b,
        delta: pooled.delta,
        ci: pooled.ci,
        p: pooled.p,
        n: pooled.n,
        only_a: changes.iter().filter(|(_, c)| c.a.is_some() && c.b.is_none()).count(),
        only_b: changes.iter().filter(|(_, c)| c.a.is_none() && c.b.is_some()).count(),
        floor: mean(&gaps).map(libm::fabs),
        clusters: pooled.clusters,
        levels: levels.collect(),
        decidable: false,
        gate: Gate::None,
        gate_reason: String::new(),
    }
}

fn scene(mut log: LogPair) -> Scene {
    let shown = log.shown();
    let (human, a, b) = if log.levels.is_empty() {
        (String::new(), None, None)
    } else {
        let level = log.levels.swap_remove(shown);
        (level.human, level.a.ok(), level.b.ok())
    };
    Scene {
        log: log.log,
        human,
        scenario: log.scenario,
        a: a.map(|run| run.track),
        b: b.map(|run| run.track),
    }
}
