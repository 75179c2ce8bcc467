//! Two runs of one session in one log, to be looked at and compared side by side.

use super::file::{Lane, LogFile};
use super::{Arm, LogError, Sink, Stop, Summary, WriterOptions, header};
use crate::{Event, Header, Stamped};

/// Writes two runs into one MCAP file, under `/A` and `/B`, with a layout that shows both.
///
/// The log's own head is B's, so that whatever reads a log reads B; [`super::LogReader::arm`] gives A.
pub struct SideBySide<W: Sink> {
    file: LogFile<W>,
    lanes: [Lane; 2],
}

impl<W: Sink> SideBySide<W> {
    /// Starts a log of two runs, whose heads are given in the order A, B.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn new(sink: W, [a, b]: [&Header; 2], options: &WriterOptions) -> Result<Self, LogError> {
        let mut file = LogFile::new(sink, options)?;
        file.write_head(None, b)?;
        file.write_head(Some(Arm::A), a)?;
        file.attach(header::LAYOUT, "application/json", crate::view::LAYOUT_AB, b.run.start)?;
        file.flush()?;
        let lanes = [Lane::new(Some(Arm::A), a, options), Lane::new(Some(Arm::B), b, options)];
        Ok(SideBySide { file, lanes })
    }

    /// Writes one event of one run, and what viewers are to see of it.
    ///
    /// # Errors
    /// The log time is not after that of the run's event before, or before that of the other run's;
    /// or the sink refuses.
    pub fn write(&mut self, arm: Arm, event: &Stamped<Event>) -> Result<(), LogError> {
        self.file.write(&mut self.lanes[arm as usize], event)
    }

    /// Notes that the runs were stopped before their end; to be called last. A reader meets it as
    /// [`LogError::Stopped`] where the end would be.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn mark_stopped(&mut self, by: Stop) -> Result<(), LogError> {
        self.file.mark_stopped(by)
    }

    /// Ends the log, as [`super::LogWriter::finish`] does.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn finish(self) -> Result<(W, Summary), LogError> {
        self.file.finish(&self.lanes)
    }
}

/// What ended the writing of two runs early.
#[derive(Debug, thiserror::Error)]
pub enum WriteAbError<E> {
    /// A run failed.
    #[error(transparent)]
    Run(E),
    /// The log could not be written.
    #[error(transparent)]
    Log(#[from] LogError),
}

/// Writes two runs of one session side by side, merged by log time, each pulled event by event until
/// it gives `None`; at equal times A comes first. Memory stays bounded. `stopped` is asked once both gave
/// `None`: what made that come before their end, if anything did, which the log then says.
///
/// # Errors
/// A run fails, its times do not increase, or the sink refuses. What was written until then is closed
/// as well as it can be.
pub fn write_ab<W: Sink, E>(
    sink: W,
    headers: [&Header; 2],
    options: &WriterOptions,
    mut a: impl FnMut() -> Result<Option<Stamped<Event>>, E>,
    mut b: impl FnMut() -> Result<Option<Stamped<Event>>, E>,
    stopped: impl FnOnce() -> Option<Stop>,
) -> Result<(W, Summary), WriteAbError<E>> {
    let mut log = SideBySide::new(sink, headers, options)?;
    let mut next_a = a().map_err(WriteAbError::Run)?;
    let mut next_b = b().map_err(WriteAbError::Run)?;
    loop {
        let a_first = match (&next_a, &next_b) {
            (None, None) => break,
            (Some(a), Some(b)) => a.at <= b.at,
            (a, _) => a.is_some(),
        };
        if a_first {
            if let Some(event) = next_a.take() {
                log.write(Arm::A, &event)?;
            }
            next_a = a().map_err(WriteAbError::Run)?;
        } else {
            if let Some(event) = next_b.take() {
                log.write(Arm::B, &event)?;
            }
            next_b = b().map_err(WriteAbError::Run)?;
        }
    }
    if let Some(by) = stopped() {
        log.mark_stopped(by)?;
    }
    Ok(log.finish()?)
}
