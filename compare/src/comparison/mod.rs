//! Two controllers over the same logs: is B better than A?
//!
//! In go, per log, both arms' [`Measured`](crate::Measured) runs and their
//! [`Diff`](crate::Diff); out comes one [`Comparison`], from which every report is made.
//!
//! A log whose replay failed is counted and named, never dropped. B is compared with A as it was
//! replayed, pair by pair; the statistics are over the pairs.

mod build;
mod moments;
mod result;
mod verdict;

#[cfg(test)]
mod tests;

pub use build::{LogPair, Question, compare};
pub use result::{
    Arm, Change, Comparison, Gate, LogResult, LogStatus, MetricChange, Moment, Scene, Verdict,
    ViolationRecord,
};
