//! The list of metrics: one row each, in the order of every table.

use serde::{Deserialize, Serialize};

use super::accumulate::Accumulate;
use super::agreement::{Disagreement, Override};
use super::authority::{Chatter, Deadlock, HumanShare, Interventions};
use super::clearance::{MinClearance, NearMiss};
use super::contact::{Collisions, ContactSpeed};
use super::invariance::Breaches;
use super::sample::Setting;
use super::task::{GoalReached, GoalTime, PathEfficiency, Tracking};

/// Which way a metric should go.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Better {
    /// The smaller the better.
    Lower,
    /// The larger the better.
    Higher,
}

impl Better {
    /// The name in machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Better::Lower => "lower",
            Better::Higher => "higher",
        }
    }

    /// A change as an improvement: positive is better.
    pub fn improvement(self, delta: f64) -> f64 {
        match self {
            Better::Lower => -delta,
            Better::Higher => delta,
        }
    }
}

/// What a metric is about. Verdicts look at safety first, then at authority.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Group {
    /// Whether anything was hit, and how nearly.
    Safety,
    /// How much the person drives, and how far the command is from what they asked for.
    Authority,
    /// How well the task was done.
    Task,
}

impl Group {
    /// The name in reports and machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Group::Safety => "safety",
            Group::Authority => "authority",
            Group::Task => "task",
        }
    }
}

/// One row of the catalogue.
#[derive(Clone, Copy)]
pub struct Metric {
    /// Name, with the unit as its suffix.
    pub name: &'static str,
    /// Unit; empty for shares and counts.
    pub unit: &'static str,
    /// Which way it should go.
    pub better: Better,
    /// What it is about.
    pub group: Group,
    /// What it is, in one sentence.
    pub formula: &'static str,
    /// What it is computed from, and where the definition comes from.
    pub source: &'static str,
    /// Fed with motions; otherwise with decisions.
    pub(super) from_motion: bool,
    pub(super) make: fn(&Setting) -> Box<dyn Accumulate>,
}

impl std::fmt::Debug for Metric {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_struct("Metric").field("name", &self.name).finish_non_exhaustive()
    }
}

/// The row of that name.
pub fn metric(name: &str) -> Option<&'static Metric> {
    CATALOGUE.iter().find(|metric| metric.name == name)
}

const MOTION: &str = "/truth, or the estimate in /step with the scenario's world";
const DECISION: &str = "/step and /command";

/// Every metric, in the order of every table.
///
/// S = diag(1/`v_max`, 1/`ω_max`) with the plant's limits; d is the signed clearance of the
/// footprint; `u_s` = (`v_s`, `ω_s`) is the command, `u_h` = (`v_h`, `ω_h`) the request clipped to
/// the plant's limits. A step stands until the next one, but no longer than two control periods; a
/// motion sample until the next one, but no longer than 0.5 s.
pub const CATALOGUE: &[Metric] = &[
    Metric {
        name: "min_clearance_m",
        unit: "m",
        better: Better::Higher,
        group: Group::Safety,
        formula: "least signed clearance d of the footprint over the run",
        source: MOTION,
        from_motion: true,
        make: |_| Box::new(MinClearance::new()),
    },
    Metric {
        name: "collisions",
        unit: "",
        better: Better::Lower,
        group: Group::Safety,
        formula: "number of maximal intervals with d <= 0, moving discs included",
        source: MOTION,
        from_motion: true,
        make: |_| Box::new(Collisions::default()),
    },
    Metric {
        name: "contact_speed_mps",
        unit: "m/s",
        better: Better::Lower,
        group: Group::Safety,
        formula: "greatest |v| at the first sample of a collision; undefined without one",
        source: MOTION,
        from_motion: true,
        make: |_| Box::new(ContactSpeed::default()),
    },
    Metric {
        name: "near_miss_s",
        unit: "s",
        better: Better::Lower,
        group: Group::Safety,
        formula: "time with 0 < d < 0.1 m",
        source: MOTION,
        from_motion: true,
        make: |_| Box::new(NearMiss::default()),
    },
    Metric {
        name: "invariance_breaches",
        unit: "",
        better: Better::Lower,
        group: Group::Safety,
        formula: "number of maximal intervals in which the body overlaps a wall or an obstacle: \
                  leavings of the static admissible set",
        source: MOTION,
        from_motion: true,
        make: |_| Box::new(Breaches::default()),
    },
    Metric {
        name: "human_share",
        unit: "",
        better: Better::Higher,
        group: Group::Authority,
        formula: "mean of the sharing function k over time: 1 when the person always drives",
        source: DECISION,
        from_motion: false,
        make: |_| Box::new(HumanShare::default()),
    },
    Metric {
        name: "interventions_per_min",
        unit: "1/min",
        better: Better::Lower,
        group: Group::Authority,
        formula: "rising edges of |S(u_s - u_h)| > 0.05, merged when less than 0.3 s apart, per \
                  minute",
        source: DECISION,
        from_motion: false,
        make: |setting| Box::new(Interventions::new(setting.limits)),
    },
    Metric {
        name: "chatter_per_min",
        unit: "1/min",
        better: Better::Lower,
        group: Group::Authority,
        formula: "switches of k that undo the one before within 0.5 s, per minute",
        source: DECISION,
        from_motion: false,
        make: |_| Box::new(Chatter::new()),
    },
    Metric {
        name: "deadlock_s",
        unit: "s",
        better: Better::Lower,
        group: Group::Authority,
        formula: "time with |S u_h| > 0.05 while the robot moves at |S u| <= 0.02",
        source: "/step, and /truth where there is one",
        from_motion: false,
        make: |setting| Box::new(Deadlock::new(setting.limits)),
    },
    Metric {
        name: "override_m",
        unit: "m",
        better: Better::Lower,
        group: Group::Authority,
        formula: "integral of |v_s - v_h| over time",
        source: DECISION,
        from_motion: false,
        make: |_| Box::new(Override::travel()),
    },
    Metric {
        name: "override_rad",
        unit: "rad",
        better: Better::Lower,
        group: Group::Authority,
        formula: "integral of |omega_s - omega_h| over time",
        source: DECISION,
        from_motion: false,
        make: |_| Box::new(Override::turning()),
    },
    Metric {
        name: "disagreement",
        unit: "",
        better: Better::Lower,
        group: Group::Authority,
        formula: "time mean of |S(u_s - u_h)|",
        source: DECISION,
        from_motion: false,
        make: |setting| Box::new(Disagreement::new(setting.limits)),
    },
    Metric {
        name: "tracking_rms_m",
        unit: "m",
        better: Better::Lower,
        group: Group::Task,
        formula: "RMS over time of the distance from the reference point to the path of the \
                  task's target; undefined without a task",
        source: MOTION,
        from_motion: true,
        make: |setting| Box::new(Tracking::new(setting)),
    },
    Metric {
        name: "goal_reached",
        unit: "",
        better: Better::Higher,
        group: Group::Task,
        formula: "1 if the robot came within 0.2 m of the task's end point, else 0; undefined \
                  without a task or where the body does not fit there",
        source: MOTION,
        from_motion: true,
        make: |setting| Box::new(GoalReached::new(setting)),
    },
    Metric {
        name: "goal_time_s",
        unit: "s",
        better: Better::Lower,
        group: Group::Task,
        formula: "first time within 0.2 m of the task's end point; undefined if never",
        source: MOTION,
        from_motion: true,
        make: |setting| Box::new(GoalTime::new(setting)),
    },
    Metric {
        name: "path_efficiency",
        unit: "",
        better: Better::Higher,
        group: Group::Task,
        formula: "progress towards the task's end point per metre driven: 1 for the straight way; \
                  undefined without a task or below 0.05 m",
        source: MOTION,
        from_motion: true,
        make: |setting| Box::new(PathEfficiency::new(setting)),
    },
];
