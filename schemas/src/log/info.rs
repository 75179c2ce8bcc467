//! What a log holds: its head, its channels, its gaps, and whether it is whole.

use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use super::reader::Opened;
use super::{LogError, Topic};
use crate::{Event, Gap, Header, Time};

/// What is known about one channel of a log.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ChannelInfo {
    /// Topic.
    pub topic: String,
    /// Fully qualified name of its message.
    pub schema: String,
    /// Encoding of its messages.
    pub encoding: String,
    /// Messages.
    pub count: u64,
    /// Messages per second between the first and the last; 0 with fewer than two.
    pub rate_hz: f64,
    /// Messages that its sequence numbers say are missing.
    pub lost: u64,
    first: Time,
    last: Time,
    sequence: u32,
}

/// A stretch without a stream.
#[derive(Clone, Debug, PartialEq)]
pub struct GapInfo {
    /// The topic that fell silent.
    pub stream: String,
    /// When, seconds from the start of the session.
    pub start_s: f64,
    /// For how long, seconds.
    pub duration_s: f64,
    /// What is known about the cause.
    pub cause: String,
}

/// What a log holds.
#[derive(Debug)]
pub struct LogInfo {
    /// What stands at its head.
    pub header: Header,
    /// Whether the log has its proper end and every check sum is right.
    pub complete: bool,
    /// What is wrong with it, if anything.
    pub damage: Option<LogError>,
    /// From the first to the last message, seconds.
    pub duration_s: f64,
    /// Where the log begins in the middle of its session: its first message, seconds from the session's start.
    pub begins_late_s: Option<f64>,
    /// Bytes read: the size of the log, if it is complete.
    pub bytes: u64,
    /// Messages on all channels.
    pub messages: u64,
    /// The channels, by topic.
    pub channels: Vec<ChannelInfo>,
    /// Drop-outs noted in the log.
    pub gaps: Vec<GapInfo>,
}

/// Reads a log through once and tells what it holds, as far as it can be read.
///
/// # Errors
/// As [`super::LogReader::open`]. Damage behind the head is no error here, but part of the answer.
pub fn inspect(path: impl AsRef<Path>) -> Result<LogInfo, LogError> {
    inspect_source(BufReader::with_capacity(1 << 16, File::open(path)?))
}

pub(super) fn inspect_source(source: impl Read) -> Result<LogInfo, LogError> {
    let mut opened = Opened::new(source)?;
    let mut channels: Vec<Option<ChannelInfo>> = Vec::new();
    let mut gaps = Vec::new();
    let mut first_step = None;
    let damage = loop {
        let message = match opened.next() {
            Ok(Some(message)) => message,
            Ok(None) => break None,
            Err(error) => break Some(error),
        };
        let Some(channel) = opened.messages.channel(message.channel) else { continue };
        let index = usize::from(message.channel);
        if channels.len() <= index {
            channels.resize(index + 1, None);
        }
        let first_step_now = channel.ours == Some(Topic::Step) && first_step.is_none();
        if channel.ours == Some(Topic::Gap) || first_step_now {
            match opened.event(&message) {
                Ok(Some(Event::Gap(gap))) => gaps.push(gap_info(&gap, opened.header.run.start)),
                Ok(Some(Event::Step(step))) => first_step = Some(step.step_index),
                Ok(_) => {}
                Err(error) => break Some(error),
            }
        }
        let info = channels[index].get_or_insert_with(|| ChannelInfo {
            topic: channel.topic.clone(),
            schema: channel.schema.clone(),
            encoding: channel.encoding.clone(),
            first: message.at,
            sequence: message.sequence.wrapping_sub(1),
            ..ChannelInfo::default()
        });
        info.count += 1;
        // A counter that stands still or goes back is another recording, not a loss.
        let skipped = message.sequence.wrapping_sub(info.sequence).wrapping_sub(1);
        if skipped < u32::MAX / 2 {
            info.lost += u64::from(skipped);
        }
        info.sequence = message.sequence;
        info.last = info.last.max(message.at);
        info.first = info.first.min(message.at);
    };
    let mut channels: Vec<ChannelInfo> = channels.into_iter().flatten().collect();
    channels.sort_by(|a, b| a.topic.cmp(&b.topic));
    for channel in &mut channels {
        let duration_s = channel.last.seconds_since(channel.first);
        if duration_s > 0.0 {
            channel.rate_hz = (channel.count - 1) as f64 / duration_s;
        }
    }
    let first = channels.iter().map(|channel| channel.first).min();
    let last = channels.iter().map(|channel| channel.last).max();
    Ok(LogInfo {
        complete: damage.is_none() && opened.messages.is_complete(),
        damage,
        // A session's first step is its step 0.
        begins_late_s: first
            .filter(|_| first_step.is_some_and(|index| index > 0))
            .map(|first| first.seconds_since(opened.header.run.start)),
        duration_s: first.zip(last).map_or(0.0, |(first, last)| last.seconds_since(first)),
        bytes: opened.messages.at_byte(),
        messages: channels.iter().map(|channel| channel.count).sum(),
        channels,
        gaps,
        header: opened.header,
    })
}

fn gap_info(gap: &Gap, start: Time) -> GapInfo {
    GapInfo {
        stream: gap.stream.clone(),
        start_s: gap.start.seconds_since(start),
        duration_s: gap.end.seconds_since(gap.start),
        cause: gap.cause.clone(),
    }
}
