//! The MCAP file under a session log, and the runs in it: one, or two side by side.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::io::{Seek, Write};

use mcap::records::MessageHeader;
use mcap::write::{Metadata, NoSeek};

use super::topics::{TOPICS, payload_stamp};
use super::{
    Arm, Encoder, LogError, Sink, Stop, Summary, Topic, WriterOptions, descriptors, header,
};
use crate::view::Picture;
use crate::{Event, Header, Span, Stamped, Time};

/// A channel that has been declared in the file.
#[derive(Clone, Copy, Debug)]
struct Channel {
    id: u16,
    messages: u64,
}

/// One run in the file: its channels, and how it is drawn.
pub(super) struct Lane {
    arm: Option<Arm>,
    channels: [Option<Channel>; TOPICS.len()],
    picture: Option<Picture>,
    last: Option<Time>,
}

impl Lane {
    /// A run of which nothing has been written; `None` for the only one in its file.
    pub(super) fn new(arm: Option<Arm>, header: &Header, options: &WriterOptions) -> Lane {
        Lane {
            arm,
            channels: [None; TOPICS.len()],
            picture: options.view.then(|| Picture::of(header, arm)),
            last: None,
        }
    }

    fn topic(&self, topic: Topic) -> Cow<'static, str> {
        match self.arm {
            None => Cow::Borrowed(topic.name()),
            Some(arm) => Cow::Owned(arm.topic(topic)),
        }
    }
}

/// An MCAP file that events are written to.
pub(super) struct LogFile<W: Sink> {
    mcap: mcap::Writer<NoSeek<W>>,
    encoder: Encoder,
    flush_interval: Span,
    flushed: Option<Time>,
    first: Option<Time>,
    last: Option<Time>,
}

impl<W: Sink> LogFile<W> {
    pub(super) fn new(sink: W, options: &WriterOptions) -> Result<Self, LogError> {
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
        Ok(LogFile {
            mcap,
            encoder: Encoder::new(),
            flush_interval: options.flush_interval,
            flushed: None,
            first: None,
            last: None,
        })
    }

    /// What a run says about itself. It stands before the first message, so that a reader of a
    /// stream, or of a log without its end, has it first.
    pub(super) fn write_head(&mut self, arm: Option<Arm>, header: &Header) -> Result<(), LogError> {
        let metadata = header::to_map(&header.run);
        self.mcap.write_metadata(&Metadata { name: header::run_name(arm), metadata })?;
        let start = header.run.start;
        for (name, text) in [
            (header::PARAMS, header.params_toml.as_str()),
            (header::SCENARIO, header.scenario.to_toml().as_str()),
        ] {
            self.attach(&header::attachment_name(arm, name), "application/toml", text, start)?;
        }
        Ok(())
    }

    pub(super) fn attach(
        &mut self,
        name: &str,
        media_type: &str,
        text: &str,
        start: Time,
    ) -> Result<(), LogError> {
        Ok(self.mcap.attach(&mcap::Attachment {
            log_time: start.0,
            create_time: start.0,
            name: name.to_owned(),
            media_type: media_type.to_owned(),
            data: Cow::Borrowed(text.as_bytes()),
        })?)
    }

    /// Writes an event of one run. Times increase strictly in each run, and never go back in the file.
    pub(super) fn write(
        &mut self,
        lane: &mut Lane,
        event: &Stamped<Event>,
    ) -> Result<(), LogError> {
        let topic = Topic::of(&event.value);
        let order = |previous| LogError::Order { topic: topic.name(), at: event.at, previous };
        if let Some(previous) = lane.last.filter(|last| event.at <= *last) {
            return Err(order(previous));
        }
        if let Some(previous) = self.last.filter(|last| event.at < *last) {
            return Err(order(previous));
        }
        let flushed = *self.flushed.get_or_insert(event.at);
        if event.at.0.saturating_sub(flushed.0) >= self.flush_interval.0 {
            self.flush()?;
            self.flushed = Some(event.at);
        }
        self.first.get_or_insert(event.at);
        self.last = Some(event.at);
        lane.last = Some(event.at);

        let channel = declare(&mut self.mcap, lane, topic)?;
        let head = message_header(channel, event.at, payload_stamp(&event.value));
        let (_, data) = self.encoder.encode(&event.value);
        self.mcap.write_to_known_channel(&head, data)?;

        let shown = lane.picture.as_mut().map(|picture| picture.observe(event));
        for shown in shown.into_iter().flatten() {
            let channel = declare(&mut self.mcap, lane, shown.topic)?;
            let head = message_header(channel, shown.at, shown.at);
            self.mcap.write_to_known_channel(&head, &shown.bytes)?;
        }
        Ok(())
    }

    pub(super) fn flush(&mut self) -> Result<(), LogError> {
        Ok(self.mcap.flush()?)
    }

    /// Notes that the runs in the file were stopped before their end.
    pub(super) fn mark_stopped(&mut self, by: Stop) -> Result<(), LogError> {
        let name = header::STOPPED.to_owned();
        let metadata = [(header::STOPPED_BY.to_owned(), by.name().to_owned())].into();
        Ok(self.mcap.write_metadata(&Metadata { name, metadata })?)
    }

    pub(super) fn finish(mut self, lanes: &[Lane]) -> Result<(W, Summary), LogError> {
        self.mcap.finish()?;
        let mut sink = self.mcap.into_inner();
        let bytes = sink.stream_position()?;
        let mut sink = sink.into_inner();
        sink.settle()?;
        let topics: Vec<(String, u64)> = lanes
            .iter()
            .flat_map(|lane| {
                let counted = TOPICS.iter().zip(lane.channels);
                counted.filter_map(|(info, channel)| {
                    Some((lane.topic(info.topic).into_owned(), channel?.messages))
                })
            })
            .collect();
        let messages = topics.iter().map(|(_, count)| count).sum();
        Ok((sink, Summary { messages, bytes, topics, first: self.first, last: self.last }))
    }
}

/// The channel of a topic, declared in the file at its first message.
fn declare<'a, W: Write>(
    mcap: &mut mcap::Writer<NoSeek<W>>,
    lane: &'a mut Lane,
    topic: Topic,
) -> Result<&'a mut Channel, LogError> {
    if lane.channels[topic as usize].is_none() {
        let info = topic.info();
        let schema = mcap.add_schema(info.schema, "protobuf", &descriptors::schema_data(topic))?;
        let id = mcap.add_channel(schema, &lane.topic(topic), "protobuf", &BTreeMap::new())?;
        lane.channels[topic as usize] = Some(Channel { id, messages: 0 });
    }
    Ok(lane.channels[topic as usize].as_mut().expect("set above"))
}

/// The head of a channel's next message.
fn message_header(channel: &mut Channel, at: Time, stamp: Time) -> MessageHeader {
    let sequence = channel.messages as u32;
    channel.messages += 1;
    MessageHeader { channel_id: channel.id, sequence, log_time: at.0, publish_time: stamp.0 }
}
