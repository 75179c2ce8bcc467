//! The list of metrics: one row each, in the order of every table. The rows stand in files by
//! subject.

mod authority;
mod ride;
mod safety;

use serde::{Deserialize, Serialize};

use super::accumulate::Accumulate;
use super::sample::Setting;

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
    /// How the ride feels.
    Comfort,
    /// Whether the law does what its theorem promises.
    Law,
    /// What it costs the person.
    Operator,
    /// What it costs the computer: measured by a clock, so never compared and never approved.
    Cost,
}

impl Group {
    /// Every group, in the order of every table.
    pub const ALL: [Group; 7] = [
        Group::Safety,
        Group::Authority,
        Group::Task,
        Group::Comfort,
        Group::Law,
        Group::Operator,
        Group::Cost,
    ];

    /// Whether the same run always gives the same value: not where a clock is read.
    pub fn is_repeatable(self) -> bool {
        self != Group::Cost
    }

    /// The name in reports and machine-readable output.
    pub fn name(self) -> &'static str {
        match self {
            Group::Safety => "safety",
            Group::Authority => "authority",
            Group::Task => "task",
            Group::Comfort => "comfort",
            Group::Law => "law",
            Group::Operator => "operator",
            Group::Cost => "cost",
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
    /// Whether a verdict may rest on it. The few that may were chosen beforehand: the more are looked
    /// at, the less each of them can prove. The others are shown beside them.
    pub primary: bool,
    pub(super) feed: Feed,
    pub(super) make: fn(&Setting) -> Box<dyn Accumulate>,
}

/// What of a run a metric is fed with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Feed {
    /// Where the robot was.
    Motion,
    /// What the controller decided.
    Decision,
    /// What the joystick said.
    Request,
    /// What a step cost.
    Timing,
}

impl Feed {
    /// Where that comes from.
    const fn source(self) -> &'static str {
        match self {
            Feed::Motion => "/truth, or the estimate in /step with the scenario's world",
            Feed::Decision => "/step and /command",
            Feed::Request => "/joystick",
            Feed::Timing => "/timing",
        }
    }
}

impl Metric {
    /// A row with what most rows have: no unit, the smaller the better, not primary.
    const fn new(
        name: &'static str,
        group: Group,
        feed: Feed,
        formula: &'static str,
        make: fn(&Setting) -> Box<dyn Accumulate>,
    ) -> Metric {
        Metric {
            name,
            unit: "",
            better: Better::Lower,
            group,
            formula,
            source: feed.source(),
            primary: false,
            feed,
            make,
        }
    }

    const fn unit(self, unit: &'static str) -> Metric {
        Metric { unit, ..self }
    }

    const fn higher_is_better(self) -> Metric {
        Metric { better: Better::Higher, ..self }
    }

    const fn primary(self) -> Metric {
        Metric { primary: true, ..self }
    }

    /// Says more about where the definition comes from.
    const fn after(self, source: &'static str) -> Metric {
        Metric { source, ..self }
    }
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

/// Every metric, in the order of every table.
///
/// S = diag(1/`v_max`, 1/`ω_max`) with the plant's limits; d is the signed clearance of the
/// footprint; `u_s` = (`v_s`, `ω_s`) is the command, `u_h` = (`v_h`, `ω_h`) the request clipped to
/// the plant's limits. A step stands until the next one, but no longer than two control periods; a
/// motion sample until the next one, but no longer than 0.5 s.
pub const CATALOGUE: &[Metric] = &joined::<
    { safety::ROWS.len() + authority::ROWS.len() + ride::ROWS.len() },
>(&[safety::ROWS, authority::ROWS, ride::ROWS]);

const fn joined<const N: usize>(parts: &[&[Metric]]) -> [Metric; N] {
    let mut all = [parts[0][0]; N];
    let (mut part, mut next) = (0, 0);
    while part < parts.len() {
        let mut row = 0;
        while row < parts[part].len() {
            all[next] = parts[part][row];
            next += 1;
            row += 1;
        }
        part += 1;
    }
    all
}
