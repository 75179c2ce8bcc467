//! What can go wrong with a session log, and the way out.

use std::{fmt, io};

use crate::Time;

use super::Topic;

/// Why a session log cannot be written or read.
#[derive(Debug, thiserror::Error)]
pub enum LogError {
    /// The file system refused.
    #[error(transparent)]
    Io(#[from] io::Error),
    /// The bytes are something else.
    #[error("not an MCAP file: {0}; give a log made by `tandem record` or `tandem replay`")]
    NotMcap(&'static str),
    /// MCAP, but without what makes it a session log.
    #[error(
        "an MCAP file, but not a session log: {0}; give a log made by `tandem record` or `tandem replay`"
    )]
    NotASession(String),
    /// A run was asked for where there is no choice.
    #[error("it holds one run, not two side by side; `tandem replay -o` writes such a log")]
    OneRun,
    /// Made by a later version of the program.
    #[error(
        "log format version {found} is newer than {known}, the newest known here; read it with a newer tandem"
    )]
    TooNew {
        /// Version that the log names.
        found: u32,
        /// Newest version that this build reads.
        known: u32,
    },
    /// The head of the log does not make sense.
    #[error("the head of the log cannot be used: {0}")]
    Header(String),
    /// The log ends before its end.
    #[error(
        "the log is cut off at byte {at_byte}, after {}; {}copy the log again{}",
        reached(*.after), usable(*.after), way_out(*.after)
    )]
    Truncated {
        /// Where the bytes end.
        at_byte: u64,
        /// Seconds from the start of the session to the last whole message before.
        after: Option<f64>,
    },
    /// Whoever wrote the log stopped before the end of the run; the log says so itself.
    #[error("{by}, after {}; {}make the run again{}", reached(*.after), usable(*.after), way_out(*.after))]
    Stopped {
        /// What stopped it.
        by: Stop,
        /// Seconds from the start of the session to the last message.
        after: Option<f64>,
    },
    /// A stretch of the log is not what was written.
    #[error(
        "the log is damaged at byte {at_byte}, after {}: {what}; {}copy the log again{}",
        reached(*.after), usable(*.after), way_out(*.after)
    )]
    Damaged {
        /// Start of the record that is wrong.
        at_byte: u64,
        /// Seconds from the start of the session to the last whole message before.
        after: Option<f64>,
        /// What is wrong with it.
        what: String,
    },
    /// A topic carries other messages than it should.
    #[error(
        "{topic} carries {found} where {expected} is expected; the log was not written by this program"
    )]
    Schema {
        /// The topic.
        topic: &'static str,
        /// Encoding and message that it should carry.
        expected: String,
        /// What it carries.
        found: String,
    },
    /// A message cannot be decoded.
    #[error(
        "a message of {topic} cannot be decoded (byte {at_byte}, after {}): {what}; {}copy the log again{}",
        reached(*.after), usable(*.after), way_out(*.after)
    )]
    Decode {
        /// The topic.
        topic: &'static str,
        /// Start of the record that holds it.
        at_byte: u64,
        /// Seconds from the start of the session to the last whole message before.
        after: Option<f64>,
        /// What the decoder says.
        what: String,
    },
    /// Log times do not increase.
    #[error(
        "log time does not increase: {topic} at {} ns follows {} ns; a session log holds its events in the order of their times",
        at.0, previous.0
    )]
    Order {
        /// The topic of the later event.
        topic: &'static str,
        /// Its log time.
        at: Time,
        /// The log time before.
        previous: Time,
    },
    /// The writer refused, e.g. because an earlier write failed.
    #[error("cannot write the log: {0}")]
    Write(String),
}

/// How far a damaged log can be read.
fn reached(after: Option<f64>) -> String {
    after.map_or_else(|| "no message".to_owned(), |seconds| format!("{seconds:.3} s of session"))
}

fn usable(after: Option<f64>) -> &'static str {
    after.map_or("", |_| "what stands before is usable: ")
}

/// How the part of a log that can be read becomes a log that every command takes for whole.
fn way_out(after: Option<f64>) -> String {
    // A replay knows that a part is whole by what comes after it: some message of another stream.
    let to_s = after.map(|seconds| libm::floor(10.0 * (seconds - 0.2)) / 10.0);
    to_s.filter(|to_s| *to_s > 0.0).map_or_else(String::new, |to_s| {
        format!(
            ", or turn that part into a whole log with `tandem replay LOG --to {to_s} -o PART.mcap`"
        )
    })
}

/// What stopped the writing of a run before its end.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stop {
    /// Whoever wrote it was told to stop.
    Told,
    /// What it was made from could be read no further.
    Source,
}

impl Stop {
    /// The word that stands for it in a log.
    pub(super) fn name(self) -> &'static str {
        match self {
            Stop::Told => "told",
            Stop::Source => "source",
        }
    }

    /// What stopped a run, by the word that stands in its log; the first marks had none.
    pub(super) fn of_name(name: Option<&str>) -> Stop {
        if name == Some(Stop::Source.name()) { Stop::Source } else { Stop::Told }
    }
}

impl fmt::Display for Stop {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Stop::Told => "the run was stopped before its end",
            Stop::Source => "the run was made from a log that is cut off or damaged",
        })
    }
}

impl LogError {
    /// Whether a session log is there and readable up to the place where this happened.
    pub fn is_damage(&self) -> bool {
        matches!(
            self,
            LogError::Truncated { .. }
                | LogError::Stopped { .. }
                | LogError::Damaged { .. }
                | LogError::Decode { .. }
                | LogError::Order { .. }
        )
    }

    pub(super) fn schema(topic: Topic, encoding: &str, schema: &str) -> LogError {
        let info = topic.info();
        LogError::Schema {
            topic: info.name,
            expected: format!("{} as protobuf", info.schema),
            found: format!("{schema:?} as {encoding:?}"),
        }
    }
}

impl From<mcap::McapError> for LogError {
    fn from(error: mcap::McapError) -> Self {
        match error {
            mcap::McapError::Io(error) => LogError::Io(error),
            other => LogError::Write(other.to_string()),
        }
    }
}
