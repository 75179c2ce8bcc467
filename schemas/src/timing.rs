//! A note about the recording itself: what a step cost.

use crate::Time;

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
