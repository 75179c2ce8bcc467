//! What changed between two runs, when, why, and how sure that is.
//!
//! In go the events of runs ([`schemas::Event`]) and what the runs say about themselves
//! ([`schemas::Header`]); out come
//!
//! - [`Measured`]: a run's metrics, violations and path, from a streaming [`Meter`];
//! - [`Diff`]: two runs field by field, with the first cause along the controller's data flow;
//! - [`Comparison`]: two controllers over many logs, with paired statistics and a verdict;
//! - [`report`]: that one object as text, Markdown, JSON and a page;
//! - [`figure`]: one run as a picture;
//! - [`golden`]: a run against the result that was once approved.
//!
//! Nothing here runs a controller, reads a file or asks for the time.

mod comparison;
mod diff;
mod drawing;
mod error;
pub mod figure;
pub mod golden;
mod metrics;
#[cfg(test)]
mod properties;
pub mod report;
mod self_test;
pub mod statistics;
#[cfg(test)]
mod synthetic;
mod thinning;

pub use comparison::{
    Arm, ArmInfo, Change, Comparison, Gate, GateFile, GateResult, Indication, LevelChange,
    LevelPair, LevelResult, LogPair, LogResult, LogStatus, MetricChange, MetricGate, Moment,
    ParameterChange, Provenance, Question, Scene, Swap, Values, Verdict, ViolationRecord, compare,
    swap_parameters,
};
pub use diff::{
    Base, Compared, Diff, Differ, FieldDifference, FirstCause, Next, Reading, Tolerance,
    Tolerances, diff, unit_of_law,
};
pub use error::CompareError;
pub use metrics::{
    Basis, Better, CATALOGUE, Critical, Group, Measured, Meter, Metric, MetricSummary, Profile,
    RunMetrics, Switch, Track, TrackPoint, Violation, ViolationKind, metric, summarize,
};
pub use self_test::{FalseAlarms, Mutant, Power, SelfTest, Unchanged};
