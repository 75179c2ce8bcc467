//! A note about the recording itself: a stream dropped out.

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
