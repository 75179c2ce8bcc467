//! Two controllers over the same logs: is B better than A?
//!
//! In go, per log, both arms' [`Measured`](crate::Measured) runs and their
//! [`Diff`](crate::Diff); out comes one [`Comparison`], from which every report is made.
//!
//! Where the recorded person was brought back in several ways, each log has a pair of runs for each
//! level of that ladder: the estimate is the mean over the levels that deserve it, and nothing is
//! called an effect that some level contradicts.
//!
//! A log whose replay failed is counted and named, never dropped. B is compared with A as it was
//! replayed, pair by pair; the statistics are over the pairs.

mod build;
mod cluster;
mod gate;
mod indication;
mod moments;
mod provenance;
mod result;
mod swap;
mod verdict;

#[cfg(test)]
mod tests;

pub use build::{LevelPair, LogPair, Question, compare};
pub use gate::{GateFile, MetricGate};
pub use result::{
    Arm, ArmInfo, Change, Comparison, Gate, GateResult, Indication, LevelChange, LevelResult,
    LogResult, LogStatus, MetricChange, Moment, ParameterChange, Provenance, Scene, Verdict,
    ViolationRecord,
};
pub use swap::{Swap, Values, swap_parameters};
