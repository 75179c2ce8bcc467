//! Writing a session log.

use std::fs::File;
use std::io::{self, BufWriter, Cursor, Write};
use std::path::Path;

use super::file::{Lane, LogFile};
use super::{LogError, header};
use crate::{Event, Header, NS_PER_S, Span, Stamped, Time};

/// How a log is written. The defaults suit a live recording, [`WriterOptions::offline`] a simulation.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct WriterOptions {
    /// Whether to add the topics that only viewers read (`/tf`, `/pose`, `/scene`, `/log`).
    pub view: bool,
    /// Content of a chunk at which it is closed, bytes before compression.
    pub chunk_bytes: u64,
    /// Log time after which a chunk is closed and handed to the file whatever its size: a crash
    /// loses no more than this.
    pub flush_interval: Span,
}

impl Default for WriterOptions {
    fn default() -> Self {
        WriterOptions { view: true, chunk_bytes: 128 << 10, flush_interval: Span(NS_PER_S) }
    }
}

impl WriterOptions {
    /// For sessions that run as fast as the machine allows: larger chunks that end by their size
    /// alone, because a crash loses nothing that could not be made again.
    pub fn offline() -> Self {
        WriterOptions { view: true, chunk_bytes: 256 << 10, flush_interval: Span(u64::MAX) }
    }
}

/// Where a log's bytes go.
pub trait Sink: Write {
    /// Makes sure that everything written stays, as far as this sink can.
    ///
    /// # Errors
    /// The device refuses.
    fn settle(&mut self) -> io::Result<()> {
        self.flush()
    }
}

impl Sink for BufWriter<File> {
    fn settle(&mut self) -> io::Result<()> {
        self.flush()?;
        let file = self.get_ref();
        // A pipe or a device has no disk to wait for, and refuses.
        if file.metadata()?.is_file() { file.sync_all() } else { Ok(()) }
    }
}
impl Sink for Vec<u8> {}
impl Sink for Cursor<Vec<u8>> {}
impl Sink for &mut Vec<u8> {}

/// What was written.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Summary {
    /// Messages on all topics.
    pub messages: u64,
    /// Size of the log, bytes.
    pub bytes: u64,
    /// Messages per topic, in the order of [`super::TOPICS`]; topics without any are left out.
    pub topics: Vec<(String, u64)>,
    /// Log time of the first event.
    pub first: Option<Time>,
    /// Log time of the last event.
    pub last: Option<Time>,
}

/// Writes events into an MCAP file as they come, in memory bounded by one chunk and the index.
///
/// End a log with [`LogWriter::finish`]. A writer that is dropped instead still tries to close its
/// file, but cannot say whether that worked.
pub struct LogWriter<W: Sink> {
    file: LogFile<W>,
    lane: Lane,
}

/// Creates the file of a new log.
///
/// The file is written in place, so that a crash leaves what was recorded. One that stands there
/// already is overwritten.
///
/// # Errors
/// The file cannot be created or written.
pub fn create(
    path: impl AsRef<Path>,
    header: &Header,
    options: &WriterOptions,
) -> Result<LogWriter<BufWriter<File>>, LogError> {
    LogWriter::new(BufWriter::new(File::create(path)?), header, options)
}

impl<W: Sink> LogWriter<W> {
    /// Starts a log: writes the metadata record and the attachments.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn new(sink: W, header: &Header, options: &WriterOptions) -> Result<Self, LogError> {
        let mut file = LogFile::new(sink, options)?;
        file.write_head(None, header)?;
        file.attach(header::LAYOUT, "application/json", crate::view::LAYOUT, header.run.start)?;
        file.flush()?;
        Ok(LogWriter { file, lane: Lane::new(None, header, options) })
    }

    /// Writes one event, and what viewers are to see of it.
    ///
    /// # Errors
    /// The event's log time is not after that of the one before, or the sink refuses. After the
    /// sink has refused once, every further call fails: start a new log.
    pub fn write(&mut self, event: &Stamped<Event>) -> Result<(), LogError> {
        self.file.write(&mut self.lane, event)
    }

    /// Closes the current chunk and hands it to the sink. A live recorder calls this on a timer.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn flush(&mut self) -> Result<(), LogError> {
        self.file.flush()
    }

    /// Ends the log: last chunk, indexes, footer; then everything is flushed, and synced where the
    /// sink is a file.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn finish(self) -> Result<(W, Summary), LogError> {
        self.file.finish(&[self.lane])
    }
}
