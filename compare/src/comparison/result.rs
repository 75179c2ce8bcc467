//! The one result object, in the shape of its JSON.

use std::cmp::Reverse;
use std::collections::BTreeMap;

use schemas::Scenario;
use serde::{Deserialize, Serialize};

use super::swap::Swap;
use crate::diff::FirstCause;
use crate::metrics::{Better, Group, Track, Violation, ViolationKind};
use crate::self_test::SelfTest;
use crate::statistics::Interval;

/// What a comparison comes to.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Verdict {
    /// B improves on A, and by more than chance.
    Better,
    /// B falls behind A, by more than chance.
    Worse,
    /// No difference at all, in any log.
    Same,
    /// The evidence does not suffice.
    Undecided,
    /// A run failed, or B did harm that A did not do.
    Failed,
}

impl Verdict {
    /// The name in reports and machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Verdict::Better => "better",
            Verdict::Worse => "worse",
            Verdict::Same => "same",
            Verdict::Undecided => "undecided",
            Verdict::Failed => "failed",
        }
    }

    /// A mark to stand beside the name, so that colour is never alone.
    pub fn mark(self) -> &'static str {
        match self {
            Verdict::Better => "▲",
            Verdict::Worse => "▼",
            Verdict::Same => "=",
            Verdict::Undecided => "?",
            Verdict::Failed => "✕",
        }
    }
}

/// One of the two sides.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Arm {
    /// The first controller: what there was.
    A,
    /// The second: what is proposed.
    B,
}

impl Arm {
    /// The letter in reports.
    pub fn letter(self) -> &'static str {
        match self {
            Arm::A => "A",
            Arm::B => "B",
        }
    }
}

/// Whether both arms of a log could be run.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum LogStatus {
    /// Both ran.
    Ok,
    /// At least one did not; the error says why.
    Failed,
}

/// One metric in both arms; `None` where it has no meaning.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Change {
    /// In A.
    pub a: Option<f64>,
    /// In B.
    pub b: Option<f64>,
    /// B − A, where both have a value.
    pub delta: Option<f64>,
}

impl Change {
    /// The change between two values.
    pub fn between(a: Option<f64>, b: Option<f64>) -> Change {
        Change { a, b, delta: a.zip(b).map(|(a, b)| b - a) }
    }
}

/// How the recorded person was brought back, and what that gave on one log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelResult {
    /// The level of the ladder: `playback`, `path`, `intent`, `fitted`.
    pub human: String,
    /// Whether it counts towards the estimate; a stress level does not.
    pub estimates: bool,
    /// Every metric of the catalogue.
    pub metrics: BTreeMap<String, Change>,
}

/// Where one log points. One log is no evidence: what is said of it is never more than indicative.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Indication {
    /// Primary metrics in which B does better at every level, by more than three floors.
    pub better: Vec<String>,
    /// Those in which it does worse likewise.
    pub worse: Vec<String>,
}

/// One log of a comparison.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LogResult {
    /// Its name.
    pub log: String,
    /// Whether both arms ran.
    pub status: LogStatus,
    /// Why not.
    pub error: Option<String>,
    /// Who steered, where known.
    pub operator: String,
    /// Until when the recorded person's input is to be believed, seconds; `None` where that was
    /// not determined.
    pub horizon_s: Option<f64>,
    /// Logs of one cluster count as one piece of evidence.
    pub cluster: String,
    /// BLAKE3 of the log, in hexadecimal; empty where it was not taken.
    pub hash: String,
    /// Every metric of the catalogue, over the levels that estimate; empty for a failed log.
    pub metrics: BTreeMap<String, Change>,
    /// The same at each level of the ladder, where there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<LevelResult>,
    /// How far the simulated run of A is from the recorded one, where A recorded the log.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub floor: BTreeMap<String, f64>,
    /// Where this log points; indicative only.
    pub indicative: Indication,
    /// What differed first between the arms.
    pub first_cause: Option<FirstCause>,
    /// What the log shows of its plant where that clearly contradicts its claim, which both arms drove.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plant_doubt: Option<String>,
    /// Why the log says nothing of its plant, where it does not.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub plant_untold: Option<String>,
    /// The faults that met nothing in the log that they could change, each with what there was none of.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub unmet_faults: Vec<String>,
    /// The log in which both arms stand side by side, from where the report is; `None` without one.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub side_by_side: Option<String>,
}

/// What a gate says about a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Gate {
    /// Within its margin.
    Pass,
    /// Beyond its margin.
    Fail,
    /// The evidence does not suffice for either.
    Undecided,
    /// No gate was set.
    None,
}

impl Gate {
    /// The name in reports and machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Gate::Pass => "pass",
            Gate::Fail => "fail",
            Gate::Undecided => "undecided",
            Gate::None => "none",
        }
    }
}

/// What the gate as a whole says.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct GateResult {
    /// `pass` if everything passes, `fail` if anything fails.
    pub outcome: Gate,
    /// Why, a sentence for each thing that does not pass.
    pub reasons: Vec<String>,
}

/// One metric at one level of the ladder, over all logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct LevelChange {
    /// The level.
    pub human: String,
    /// Whether it counts towards the estimate.
    pub estimates: bool,
    /// Mean in A.
    pub a: Option<f64>,
    /// Mean in B.
    pub b: Option<f64>,
    /// Mean of B − A.
    pub delta: Option<f64>,
    /// 95 % interval of that mean.
    pub ci: Option<Interval>,
    /// In how many logs both arms have a value.
    pub n: usize,
}

/// One metric over all logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct MetricChange {
    /// Name.
    pub name: String,
    /// Unit; empty for shares and counts.
    pub unit: String,
    /// Which way it should go.
    pub better: Better,
    /// What it is about.
    pub group: Group,
    /// Whether the verdict may rest on it.
    pub primary: bool,
    /// Mean in A, over the logs in which both arms have a value.
    pub a: Option<f64>,
    /// Mean in B, over the same logs.
    pub b: Option<f64>,
    /// Mean of B − A.
    pub delta: Option<f64>,
    /// 95 % interval of that mean over clusters of logs; `None` for fewer than two.
    pub ci: Option<Interval>,
    /// Two-sided p-value of the paired randomisation test.
    pub p: Option<f64>,
    /// In how many logs both arms have a value.
    pub n: usize,
    /// In how many only A has one.
    pub only_a: usize,
    /// In how many only B has one.
    pub only_b: usize,
    /// Below this no change counts as real: the gap between model and plant; `None` where it was
    /// not measured.
    pub floor: Option<f64>,
    /// How many clusters these logs are.
    pub clusters: usize,
    /// The same at each level of the ladder, where there are several.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub levels: Vec<LevelChange>,
    /// Whether the change is beyond chance: the interval excludes 0, the p-value adjusted by Holm
    /// over the group's primary metrics, or over its others, is at most 0.05, the floor is exceeded, and where there are several levels of the ladder each
    /// level's interval lies on the same side of 0.
    pub decidable: bool,
    /// What the gate says.
    pub gate: Gate,
    /// Why, where it does not pass.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub gate_reason: String,
}

/// One violation in one arm of one log.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct ViolationRecord {
    /// The log.
    pub log: String,
    /// First sample, seconds from the start.
    pub t_s: f64,
    /// What.
    pub kind: ViolationKind,
    /// Which arm.
    pub arm: Arm,
    /// Last sample, seconds from the start.
    pub until_s: f64,
    /// How deep, metres.
    pub depth_m: f64,
    /// |v| at the first sample, m/s.
    pub speed_mps: f64,
    /// The level of the ladder; empty where there is only one.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub human: String,
    /// Whether it is held against B: at every level B does so on this log, and A does nothing of the
    /// kind.
    pub new: bool,
    /// The same at some levels only: possible, to be confirmed live.
    pub possible: bool,
}

impl ViolationRecord {
    pub(super) fn new(log: &str, human: &str, arm: Arm, violation: &Violation) -> ViolationRecord {
        ViolationRecord {
            log: log.to_owned(),
            human: human.to_owned(),
            t_s: violation.t_s,
            kind: violation.kind,
            arm,
            until_s: violation.until_s,
            depth_m: violation.depth_m,
            speed_mps: violation.speed_mps,
            new: false,
            possible: false,
        }
    }
}

/// A stretch of a log that carries much of a metric's change.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Moment {
    /// The log.
    pub log: String,
    /// When to look, seconds from the start.
    pub t_s: f64,
    /// End of the stretch, seconds.
    pub until_s: f64,
    /// The metric.
    pub metric: String,
    /// What the stretch adds to B − A, in the metric's unit.
    pub delta: f64,
    /// That, as a share of all that the log's stretches add either way.
    pub share: f64,
    /// What happened there, in words.
    pub why: String,
}

/// What the reports draw of one log; not part of the JSON.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// The log.
    pub log: String,
    /// The level of the ladder that is shown; empty where there is only one way.
    pub human: String,
    /// World, body and task.
    pub scenario: Option<Scenario>,
    /// Path of A, where it ran.
    pub a: Option<Track>,
    /// Path of B, where it ran.
    pub b: Option<Track>,
}

/// What one arm ran.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct ArmInfo {
    /// BLAKE3 of its parameters on the first log, in hexadecimal.
    pub params_hash: String,
    /// All of them, as TOML.
    #[serde(skip)]
    pub params_toml: String,
}

/// A parameter that differs between the arms, as TOML writes its values.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct ParameterChange {
    /// Its key.
    pub key: String,
    /// In A; `None` where A has no such parameter.
    pub a: Option<String>,
    /// In B.
    pub b: Option<String>,
}

/// What made the comparison, and what was compared.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub struct Provenance {
    /// Version of the program.
    pub version: String,
    /// Commit that it was built from; empty where that is not known.
    pub commit: String,
    /// Whether that build had uncommitted changes.
    pub dirty: bool,
    /// The first controller.
    pub a: ArmInfo,
    /// The second.
    pub b: ArmInfo,
    /// The parameters that differ between them, on the first log.
    pub parameters: Vec<ParameterChange>,
}

/// Two controllers over the same logs.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Comparison {
    /// What it comes to.
    pub verdict: Verdict,
    /// Why, in one sentence.
    pub reason: String,
    /// The first controller.
    pub a: String,
    /// The second.
    pub b: String,
    /// `open` or `closed`.
    pub mode: String,
    /// How the recorded person was brought back; empty in open loop.
    pub human: Vec<String>,
    /// Faults that were put between sensors and controller, the same for both.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub faults: Vec<String>,
    /// Which plant both arms drove in closed loop: `recorded`, the claimed one, or `identified`.
    #[serde(default, skip_serializing_if = "String::is_empty")]
    pub plant: String,
    /// What made this, and with which parameters.
    pub provenance: Provenance,
    /// What the gate says; `None` without one.
    pub gate: Option<GateResult>,
    /// What the logs are clustered by: `operator`, `scenario`, or `log`.
    pub clustered_by: String,
    /// Every log that was asked for.
    pub logs: Vec<LogResult>,
    /// Every metric, in the order of the catalogue.
    pub metrics: Vec<MetricChange>,
    /// Every violation of both arms, by log and time.
    pub violations: Vec<ViolationRecord>,
    /// Where the changes come from, by log; within a log the largest share first.
    pub moments: Vec<Moment>,
    /// What each parameter that differs does alone, where that was asked for.
    #[serde(default, skip_serializing_if = "Vec::is_empty")]
    pub swaps: Vec<Swap>,
    /// What a test of the comparison itself found, where one was asked for.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub self_test: Option<SelfTest>,
    /// Where the reports were written.
    pub report: Vec<String>,
    /// What the reports draw.
    #[serde(skip)]
    pub scenes: Vec<Scene>,
}

impl Comparison {
    /// The logs that contradict the plant that both arms drove, in a sentence that shows the way out.
    pub fn plant_doubts(&self) -> Option<String> {
        let doubts: Vec<(&str, &str)> = self
            .logs
            .iter()
            .filter_map(|log| Some((log.log.as_str(), log.plant_doubt.as_deref()?)))
            .collect();
        let (log, doubt) = doubts.first()?;
        let more = if doubts.len() > 1 { ", and others likewise" } else { "" };
        Some(format!(
            "in {} of {} logs the robot was another one than both arms drove: {log}: {doubt}{more}; \
             --plant identified drives what each log shows",
            doubts.len(),
            self.logs.len()
        ))
    }

    /// The logs that say nothing of their plant, in words; `None` where every log does.
    pub fn plants_untold(&self) -> Option<String> {
        let untold: Vec<(&str, &str)> = self
            .logs
            .iter()
            .filter_map(|log| Some((log.log.as_str(), log.plant_untold.as_deref()?)))
            .collect();
        let (log, why) = untold.first()?;
        let all = self.logs.len();
        Some(match untold.len() {
            none if none == all => format!("no log says anything of it ({log}: {why})"),
            some => format!("{some} of {all} logs say nothing of it ({log}: {why})"),
        })
    }

    /// The faults that met nothing that they could change, each with the number of logs, in words.
    pub fn unmet_faults(&self) -> Vec<String> {
        let mut faults: BTreeMap<&str, usize> = BTreeMap::new();
        for fault in self.logs.iter().flat_map(|log| &log.unmet_faults) {
            *faults.entry(fault).or_default() += 1;
        }
        let all = self.logs.len();
        faults.into_iter().map(|(fault, n)| format!("{fault} in {n} of {all} logs")).collect()
    }

    /// How many logs could not be compared.
    pub fn failed_logs(&self) -> usize {
        self.logs.iter().filter(|log| log.status == LogStatus::Failed).count()
    }

    /// The logs in which anything differs, by how much there is to see: first those with violations held
    /// against B, then those with possible ones, then by the number of moments.
    pub fn logs_to_see(&self) -> Vec<usize> {
        let weight = |i: &usize| {
            let name = &self.logs[*i].log;
            let count = |of: fn(&ViolationRecord) -> bool| {
                self.violations.iter().filter(|v| v.log == *name && of(v)).count()
            };
            let moments = self.moments.iter().filter(|moment| moment.log == *name).count();
            (count(|v| v.new), count(|v| v.possible), moments)
        };
        let differs = |i: &usize| {
            let log = &self.logs[*i];
            log.status == LogStatus::Ok && log.first_cause.is_some()
        };
        let mut order: Vec<usize> = (0..self.logs.len()).filter(differs).collect();
        // The sort is stable: of equals the first ones come first.
        order.sort_by_key(|i| Reverse(weight(i)));
        order
    }

    /// The change of a metric over all logs.
    pub fn metric(&self, name: &str) -> Option<&MetricChange> {
        self.metrics.iter().find(|metric| metric.name == name)
    }
}
