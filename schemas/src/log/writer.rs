//! Writing a session log.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, BufWriter, Cursor, Seek, Write};
use std::path::Path;

use mcap::records::MessageHeader;
use mcap::write::{Metadata, NoSeek};

use super::topics::{TOPICS, payload_stamp};
use super::{Encoder, LogError, Topic, descriptors, header};
use crate::view::Picture;
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
        self.get_ref().sync_all()
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
    /// Messages per topic, in the order of [`TOPICS`]; topics without any are left out.
    pub topics: Vec<(&'static str, u64)>,
    /// Log time of the first event.
    pub first: Option<Time>,
    /// Log time of the last event.
    pub last: Option<Time>,
}

/// A channel that has been declared in the file.
#[derive(Clone, Copy, Debug)]
struct Channel {
    id: u16,
    messages: u64,
}

/// Writes events into an MCAP file as they come, in memory bounded by one chunk and the index.
///
/// End a log with [`LogWriter::finish`]. A writer that is dropped instead still tries to close its
/// file, but cannot say whether that worked.
pub struct LogWriter<W: Sink> {
    mcap: mcap::Writer<NoSeek<W>>,
    encoder: Encoder,
    channels: [Option<Channel>; TOPICS.len()],
    picture: Option<Picture>,
    flush_interval: Span,
    flushed: Option<Time>,
    first: Option<Time>,
    last: Option<Time>,
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
        let mcap = mcap::WriteOptions::new()
            .profile("")
            .library(format!("tandem/{}", env!("CARGO_PKG_VERSION")))
            .compression(Some(mcap::Compression::Zstd))
            .compression_level(1)
            .compression_threads(0)
            .chunk_size(Some(options.chunk_bytes))
            // Chunks reach the file whole, with their length, so that a crash leaves no open end.
            .disable_seeking(true)
            .create(NoSeek::new(sink))?;
        let mut writer = LogWriter {
            mcap,
            encoder: Encoder::new(),
            channels: [None; TOPICS.len()],
            picture: options.view.then(|| Picture::new(header)),
            flush_interval: options.flush_interval,
            flushed: None,
            first: None,
            last: None,
        };
        writer.write_head(header)?;
        Ok(writer)
    }

    /// At the head, so that a reader of a stream, or of a log without its end, has them first.
    fn write_head(&mut self, header: &Header) -> Result<(), LogError> {
        let metadata = header::to_map(&header.run);
        self.mcap.write_metadata(&Metadata { name: header::RUN.to_owned(), metadata })?;
        let scenario = header.scenario.to_toml();
        let attachments = [
            (header::PARAMS, "application/toml", header.params_toml.as_str()),
            (header::SCENARIO, "application/toml", scenario.as_str()),
            (header::LAYOUT, "application/json", crate::view::LAYOUT),
        ];
        for (name, media_type, text) in attachments {
            self.mcap.attach(&mcap::Attachment {
                log_time: header.run.start.0,
                create_time: header.run.start.0,
                name: name.to_owned(),
                media_type: media_type.to_owned(),
                data: Cow::Borrowed(text.as_bytes()),
            })?;
        }
        self.mcap.flush()?;
        Ok(())
    }

    /// Writes one event, and what viewers are to see of it.
    ///
    /// # Errors
    /// The event's log time is not after that of the one before, or the sink refuses. After the
    /// sink has refused once, every further call fails: start a new log.
    pub fn write(&mut self, event: &Stamped<Event>) -> Result<(), LogError> {
        let topic = Topic::of(&event.value);
        if let Some(previous) = self.last
            && event.at <= previous
        {
            return Err(LogError::Order { topic: topic.name(), at: event.at, previous });
        }
        let flushed = *self.flushed.get_or_insert(event.at);
        if event.at.0.saturating_sub(flushed.0) >= self.flush_interval.0 {
            self.flush()?;
            self.flushed = Some(event.at);
        }
        self.first.get_or_insert(event.at);
        self.last = Some(event.at);

        let channel = declare(&mut self.mcap, &mut self.channels, topic)?;
        let head = message_header(channel, event.at, payload_stamp(&event.value));
        let (_, data) = self.encoder.encode(&event.value);
        self.mcap.write_to_known_channel(&head, data)?;

        if let Some(picture) = &mut self.picture {
            for shown in picture.observe(event) {
                let channel = declare(&mut self.mcap, &mut self.channels, shown.topic)?;
                let head = message_header(channel, shown.at, shown.at);
                self.mcap.write_to_known_channel(&head, &shown.bytes)?;
            }
        }
        Ok(())
    }

    /// Closes the current chunk and hands it to the sink. A live recorder calls this on a timer.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn flush(&mut self) -> Result<(), LogError> {
        Ok(self.mcap.flush()?)
    }

    /// Ends the log: last chunk, indexes, footer; then everything is flushed, and synced where the
    /// sink is a file.
    ///
    /// # Errors
    /// The sink refuses.
    pub fn finish(mut self) -> Result<(W, Summary), LogError> {
        self.mcap.finish()?;
        let mut sink = self.mcap.into_inner();
        let bytes = sink.stream_position()?;
        let mut sink = sink.into_inner();
        sink.settle()?;
        let counted = TOPICS.iter().zip(self.channels);
        let topics: Vec<_> = counted
            .filter_map(|(info, channel)| channel.map(|channel| (info.name, channel.messages)))
            .collect();
        let messages = topics.iter().map(|(_, count)| count).sum();
        Ok((sink, Summary { messages, bytes, topics, first: self.first, last: self.last }))
    }
}

/// The channel of a topic, declared in the file at its first message.
fn declare<'a, W: Write>(
    mcap: &mut mcap::Writer<NoSeek<W>>,
    channels: &'a mut [Option<Channel>; TOPICS.len()],
    topic: Topic,
) -> Result<&'a mut Channel, LogError> {
    let slot = &mut channels[topic as usize];
    if slot.is_none() {
        let info = topic.info();
        let schema = mcap.add_schema(info.schema, "protobuf", &descriptors::schema_data(topic))?;
        let id = mcap.add_channel(schema, info.name, "protobuf", &BTreeMap::new())?;
        *slot = Some(Channel { id, messages: 0 });
    }
    Ok(slot.as_mut().expect("set above"))
}

/// The head of a channel's next message.
fn message_header(channel: &mut Channel, at: Time, stamp: Time) -> MessageHeader {
    let sequence = channel.messages as u32;
    channel.messages += 1;
    MessageHeader { channel_id: channel.id, sequence, log_time: at.0, publish_time: stamp.0 }
}
