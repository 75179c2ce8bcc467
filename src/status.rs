//! The exit status: the program's answer to whoever called it.

use std::process::ExitCode;

use replay::ReplayError;
use schemas::log::LogError;

/// What the program exits with.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Status {
    /// Done, same, or gate passed: 0.
    Done,
    /// Differs, gate failed, or file damaged: 1.
    Differs,
    /// Could not be done: 2.
    Impossible,
    /// The evidence does not suffice for a verdict: 3.
    Undecided,
}

impl Status {
    /// The status of a run that ended in an error: 1 when a file is damaged, else 2.
    pub fn of_error(error: &anyhow::Error) -> Status {
        let damaged = error.chain().any(|cause| {
            let of_replay = match cause.downcast_ref::<ReplayError>() {
                Some(ReplayError::Log(error)) => Some(error.as_ref()),
                _ => None,
            };
            of_replay.or(cause.downcast_ref::<LogError>()).is_some_and(LogError::is_damage)
        });
        if damaged { Status::Differs } else { Status::Impossible }
    }

    /// The worse of two: what could not be done outweighs what differs.
    #[must_use]
    pub fn worse(self, other: Status) -> Status {
        let rank = |status| match status {
            Status::Done => 0,
            Status::Undecided => 1,
            Status::Differs => 2,
            Status::Impossible => 3,
        };
        if rank(other) > rank(self) { other } else { self }
    }
}

impl From<Status> for ExitCode {
    fn from(status: Status) -> ExitCode {
        ExitCode::from(match status {
            Status::Done => 0,
            Status::Differs => 1,
            Status::Impossible => 2,
            Status::Undecided => 3,
        })
    }
}
