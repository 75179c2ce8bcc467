//! The one result object, in the shape of its JSON.

use std::collections::BTreeMap;

use schemas::Scenario;
use serde::{Deserialize, Serialize};

use crate::diff::FirstCause;
use crate::metrics::{Better, Group, Track, Violation, ViolationKind};
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
    /// Every metric of the catalogue; empty for a failed log.
    pub metrics: BTreeMap<String, Change>,
    /// What differed first between the arms.
    pub first_cause: Option<FirstCause>,
}

/// What a gate says about a metric.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Gate {
    /// Within its margin.
    Pass,
    /// Beyond its margin.
    Fail,
    /// No gate was set.
    None,
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
    /// 95 % interval of that mean over logs; `None` for fewer than two.
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
    /// Whether the change is beyond chance: the interval excludes 0, the p-value adjusted by Holm
    /// over the group's primary metrics, or over its others, is at most 0.05, and the floor is exceeded.
    pub decidable: bool,
    /// What the gate says.
    pub gate: Gate,
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
    /// Whether it is held against B: A does nothing of the kind on this log.
    pub new: bool,
}

impl ViolationRecord {
    pub(super) fn new(log: &str, arm: Arm, violation: &Violation, new: bool) -> ViolationRecord {
        ViolationRecord {
            log: log.to_owned(),
            t_s: violation.t_s,
            kind: violation.kind,
            arm,
            until_s: violation.until_s,
            depth_m: violation.depth_m,
            speed_mps: violation.speed_mps,
            new,
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
    /// World, body and task.
    pub scenario: Option<Scenario>,
    /// Path of A, where it ran.
    pub a: Option<Track>,
    /// Path of B, where it ran.
    pub b: Option<Track>,
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
    /// Every log that was asked for.
    pub logs: Vec<LogResult>,
    /// Every metric, in the order of the catalogue.
    pub metrics: Vec<MetricChange>,
    /// Every violation of both arms, by log and time.
    pub violations: Vec<ViolationRecord>,
    /// Where the changes come from, by log; within a log the largest share first.
    pub moments: Vec<Moment>,
    /// Where the reports were written.
    pub report: Vec<String>,
    /// What the reports draw.
    #[serde(skip)]
    pub scenes: Vec<Scene>,
}

impl Comparison {
    /// How many logs could not be compared.
    pub fn failed_logs(&self) -> usize {
        self.logs.iter().filter(|log| log.status == LogStatus::Failed).count()
    }

    /// The change of a metric over all logs.
    pub fn metric(&self, name: &str) -> Option<&MetricChange> {
        self.metrics.iter().find(|metric| metric.name == name)
    }
}
