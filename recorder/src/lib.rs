//! Sessions as they happen, into a log.
//!
//! In goes a [`Source`] (a simulation today), a [`Runner`] that drives it and a [`LogWriter`]; out
//! comes a finished log and what was counted on the way ([`Recorded`]). The stepping itself is the
//! controller's [`Session`], the same that replay uses. [`Simulated`] puts a simulated session together.

mod pace;
mod simulated;

pub use pace::Pace;
pub use simulated::{BeginError, Simulated};

use controller::{Runner, Session};
use schemas::log::{LogError, LogWriter, Sink, Summary};
use schemas::{Event, Source, Stamped};

/// Why recording stopped before its end. What was written until then is a valid log only if
/// [`LogWriter::finish`] could still run; after an I/O error it is a log without an end.
#[derive(Debug, thiserror::Error)]
pub enum RecordError<E> {
    /// The source failed.
    #[error(transparent)]
    Source(E),
    /// The log could not be written.
    #[error(transparent)]
    Log(LogError),
}

/// What was recorded.
#[derive(Debug)]
pub struct Recorded {
    /// What the log holds.
    pub summary: Summary,
    /// Controller steps.
    pub steps: u64,
    /// Steps in which the feedback law drove (k = 0).
    pub engaged_steps: u64,
    /// Whether the session was ended from outside before its source was.
    pub interrupted: bool,
}

/// Records a session to its end, or until `go_on` says no. Either way the log is finished.
///
/// `go_on` is asked before each event is written: the place for a progress bar, for pacing to real
/// time, for showing the person how near danger is, and for Ctrl-C.
///
/// # Errors
/// The source fails, or the log cannot be written (a full disk, say).
pub fn record<S, W>(
    source: S,
    runner: Runner,
    mut log: LogWriter<W>,
    mut go_on: impl FnMut(&Stamped<Event>) -> bool,
) -> Result<Recorded, RecordError<S::Error>>
where
    S: Source,
    W: Sink,
{
    let mut session = Session::new(source, runner);
    let (mut steps, mut engaged_steps, mut interrupted) = (0, 0, false);
    let failed = loop {
        let event = match session.next_event() {
            Ok(Some(event)) => event,
            Ok(None) => break None,
            Err(error) => break Some(error),
        };
        if !go_on(&event) {
            interrupted = true;
            break None;
        }
        log.write(&event).map_err(RecordError::Log)?;
        if let Event::Step(step) = &event.value {
            steps += 1;
            engaged_steps += u64::from(step.k == 0.0);
        }
    };
    let (_, summary) = log.finish().map_err(RecordError::Log)?;
    match failed {
        Some(error) => Err(RecordError::Source(error)),
        None => Ok(Recorded { summary, steps, engaged_steps, interrupted }),
    }
}
