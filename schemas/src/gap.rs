//! Notes about the recording itself: drop-outs and measured times.

use crate::Time;

/// A stretch in which a stream that should have been there was not.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Gap {
    /// When it was noticed.
    pub stamp: Time,
    /// The topic that fell silent.
    pub stream: String,
    /// Last sample before the gap.
    pub start: Time,
    /// First sample after the gap.
    pub end: Time,
    /// What is known about the cause.
    pub cause: String,
}

/// Wall time that one controller step took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Timing {
    /// The step's instant.
    pub stamp: Time,
    /// The step's index.
    pub step_index: u64,
    /// Its cost, nanoseconds.
    pub step_cost_ns: u64,
}
