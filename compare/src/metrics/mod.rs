//! A run in numbers: events in, [`Measured`] out.
//!
//! [`Meter`] reads a run once, event by event, and keeps a bounded amount of it. Each metric is a
//! row of the [`CATALOGUE`] with its formula, and a small accumulator in a file by subject.
//!
//! Motion comes from `/truth` where the run has it, and otherwise from the estimate in `/step` and
//! the scenario's world; [`RunMetrics::basis`] says which. A value that has no meaning for a run
//! (no task, no contact, nothing to keep clear of) is `None`, never 0.

mod accumulate;
mod agreement;
mod answers;
mod authority;
mod catalogue;
mod certain;
mod clearance;
mod comfort;
mod contact;
mod cost;
mod echoes;
mod intervention;
mod invariance;
mod judge;
mod lyapunov;
mod meter;
mod operator;
mod profile;
mod quantile;
mod sample;
mod sets;
mod sparc;
mod summary;
mod sweep;
mod task;
mod track;
mod ttc;
mod warrant;

#[cfg(test)]
mod tests;

pub use catalogue::{Better, CATALOGUE, Group, Metric, metric};
pub use invariance::{Violation, ViolationKind};
pub use meter::{Basis, Measured, Meter, RunMetrics};
pub use profile::Profile;
pub use summary::{MetricSummary, summarize};
pub use track::{Critical, Switch, Track, TrackPoint};
