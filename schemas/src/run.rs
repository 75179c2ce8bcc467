//! What a session says about itself: the `tandem.run` metadata record and its attachments.

use crate::Time;

/// Version of the log format that this build writes.
pub const FORMAT_VERSION: u32 = 1;

/// Who made a log, with what, and from what. Stored as the metadata record `tandem.run`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct RunInfo {
    /// Version of the log format.
    pub format_version: u32,
    /// Version of the program that wrote it.
    pub program_version: String,
    /// Commit the program was built from; empty where it is not known.
    pub commit: String,
    /// Whether that build had uncommitted changes.
    pub dirty: bool,
    /// Name of the controller that drove, e.g. `tandem-kinematic`.
    pub controller: String,
    /// BLAKE3 of its parameters, in hexadecimal.
    pub params_hash: String,
    /// Noise seed.
    pub seed: u64,
    /// Name of the scenario.
    pub scenario: String,
    /// Sensor suite: `exact` or `sonar`.
    pub sensors: String,
    /// Who steered: `goal`, `script`, `joystick`, or a model of the recorded person (`playback`, …).
    pub driver: String,
    /// How the log came about: `record`, `open` or `closed`.
    pub mode: String,
    /// Name of the operator, kept for statistics over people; may be empty.
    pub operator: String,
    /// Free text.
    pub note: String,
    /// The start of the session: t = 0 of task and world.
    pub start: Time,
    /// Control period, nanoseconds.
    pub control_period_ns: u64,
    /// BLAKE3 of the log that this one was replayed from, in hexadecimal; empty for a recording.
    pub source_hash: String,
}

/// Everything that stands at the head of a log.
#[derive(Clone, Debug, PartialEq)]
pub struct Header {
    /// The metadata record.
    pub run: RunInfo,
    /// Attachment `params.toml`: every parameter of the controller that drove.
    pub params_toml: String,
    /// Attachment `scenario.toml`.
    pub scenario: crate::Scenario,
}
