//! Reading a session log.

use std::collections::BTreeMap;
use std::fs::File;
use std::io::{BufReader, Read};
use std::path::Path;

use super::bytes::Bytes;
use super::encode::decode;
use super::header::{self, HeadParts};
use super::messages::{Item, Message, Messages};
use super::quick;
use super::topics::TOPICS;
use super::{Arm, LogError, Stop, Topic};
use crate::{Event, Header, Stamped, Time};

/// A log whose head has been read: its messages, undecoded.
pub(super) struct Opened<R> {
    pub(super) messages: Messages<R>,
    pub(super) header: Header,
    /// The head of A, where two runs stand side by side.
    header_a: Option<Header>,
    /// The first message, met while looking for the end of the head.
    pending: Option<Result<Option<Message>, LogError>>,
}

impl<R: Read> Opened<R> {
    pub(super) fn new(source: R) -> Result<Self, LogError> {
        let mut messages = Messages::new(source)?;
        let (mut parts, mut parts_a) = (HeadParts::default(), HeadParts::default());
        let first = loop {
            match messages.next() {
                Ok(Some(Item::Message(message))) => break Ok(Some(message)),
                Ok(Some(Item::Metadata)) => {
                    if let Some((name, map)) = parse_metadata(messages.body()) {
                        if name == header::STOPPED {
                            let by = stop(&map);
                            messages.end();
                            break Err(LogError::Stopped { by, after: None });
                        }
                        parts.describe(None, name, &map)?;
                        parts_a.describe(Some(Arm::A), name, &map)?;
                    }
                }
                Ok(Some(Item::Attachment)) => {
                    if let Some((name, data)) =
                        parse_attachment(messages.body(), messages.record_byte())?
                    {
                        parts.attach(None, name, data)?;
                        parts_a.attach(Some(Arm::A), name, data)?;
                    }
                }
                Ok(None) => break Ok(None),
                Err(error) => break Err(error),
            }
        };
        let header = match parts.complete() {
            Ok(header) => header,
            // What cut the head short explains more than what is therefore missing.
            Err(missing) => return Err(first.err().unwrap_or(missing)),
        };
        let header_a = if parts_a.is_there() { Some(parts_a.complete()?) } else { None };
        messages.start = header.run.start;
        Ok(Opened { messages, header, header_a, pending: Some(first) })
    }

    /// The next message of any topic; `None` at the end, and after an error.
    pub(super) fn next(&mut self) -> Result<Option<Message>, LogError> {
        if self.pending.is_some()
            && let Some(pending) = self.pending.take()
        {
            return pending;
        }
        loop {
            match self.messages.next()? {
                Some(Item::Message(message)) => return Ok(Some(message)),
                Some(Item::Metadata) => {
                    let metadata = parse_metadata(self.messages.body());
                    let mark = metadata.filter(|(name, _)| *name == header::STOPPED);
                    if let Some(by) = mark.map(|(_, map)| stop(&map)) {
                        self.messages.end();
                        return Err(LogError::Stopped { by, after: self.messages.reached_s() });
                    }
                }
                Some(Item::Attachment) => {}
                None => return Ok(None),
            }
        }
    }

    /// The event in a message; `None` for messages that hold none.
    pub(super) fn event(&self, message: &Message) -> Result<Option<Event>, LogError> {
        let Some(channel) = self.messages.channel(message.channel) else { return Ok(None) };
        let Some(topic) = channel.ours.filter(|topic| !topic.info().view) else { return Ok(None) };
        if !channel.as_expected {
            return Err(LogError::schema(topic, &channel.encoding, &channel.schema));
        }
        decode(topic, self.messages.payload(message)).map_err(|error| LogError::Decode {
            topic: topic.name(),
            at_byte: self.messages.record_byte(),
            after: self.messages.reached_s(),
            what: error.to_string(),
        })
    }
}

/// What is done with the messages of a channel.
#[derive(Clone, Copy)]
enum Plan {
    /// To be found out.
    Unseen,
    /// They are passed over.
    PassOver,
    /// They are given as events of a topic.
    Give(Topic),
    /// They are to be refused: the topic should carry something else.
    Refuse(Topic),
}

/// Reads the events of a session log in their order, in memory bounded by one chunk.
///
/// Every whole message before a damaged place is given before the error that names the place;
/// after an error comes the end.
pub struct LogReader<R> {
    opened: Opened<R>,
    wanted: [bool; TOPICS.len()],
    arm: Arm,
    /// What is done with the messages of each channel, once one was seen.
    plans: Vec<Plan>,
    last: Option<Time>,
    failed: bool,
}

impl LogReader<BufReader<File>> {
    /// Opens a log and reads its head.
    ///
    /// # Errors
    /// The file cannot be read, is not a session log, is newer than this build, or is damaged
    /// before its first message.
    pub fn open(path: impl AsRef<Path>) -> Result<Self, LogError> {
        LogReader::new(BufReader::with_capacity(1 << 16, File::open(path)?))
    }
}

impl<R: Read> LogReader<R> {
    /// Reads the head of a log. The source should be buffered.
    ///
    /// # Errors
    /// As [`LogReader::open`].
    pub fn new(source: R) -> Result<Self, LogError> {
        let wanted = TOPICS.map(|info| !info.view);
        let opened = Opened::new(source)?;
        let plans = Vec::new();
        Ok(LogReader { opened, wanted, arm: Arm::B, plans, last: None, failed: false })
    }

    /// Whether two runs stand side by side in the log.
    pub fn has_arms(&self) -> bool {
        self.opened.header_a.is_some()
    }

    /// Reads this one of two runs that stand side by side; without being told, B is read.
    ///
    /// # Errors
    /// The log holds one run only.
    pub fn arm(mut self, arm: Arm) -> Result<Self, LogError> {
        if !self.has_arms() {
            return Err(LogError::OneRun);
        }
        self.arm = arm;
        Ok(self)
    }

    /// Gives the events of these topics only; the others are passed over undecoded.
    #[must_use]
    pub fn only(mut self, topics: &[Topic]) -> Self {
        self.wanted = TOPICS.map(|info| !info.view && topics.contains(&info.topic));
        self
    }

    /// What stands at the head of the log.
    pub fn header(&self) -> &Header {
        match (self.arm, &self.opened.header_a) {
            (Arm::A, Some(header)) => header,
            _ => &self.opened.header,
        }
    }

    /// The next event; `None` at the end of the log, and after an error.
    ///
    /// # Errors
    /// The log is damaged here, carries something else than it should, or its times do not increase.
    pub fn next_event(&mut self) -> Result<Option<Stamped<Event>>, LogError> {
        if self.failed {
            return Ok(None);
        }
        let next = self.advance();
        self.failed = next.is_err();
        next
    }

    fn advance(&mut self) -> Result<Option<Stamped<Event>>, LogError> {
        while let Some(message) = self.opened.next()? {
            let plan = self.plans.get(usize::from(message.channel)).copied();
            let plan = match plan.unwrap_or(Plan::Unseen) {
                Plan::Unseen => self.plan(message.channel),
                known => known,
            };
            let (topic, quick) = match plan {
                Plan::Give(topic) => (topic, true),
                Plan::Refuse(topic) => (topic, false),
                Plan::PassOver | Plan::Unseen => continue,
            };
            if let Some(previous) = self.last.filter(|last| message.at <= *last) {
                return Err(LogError::Order { topic: topic.name(), at: message.at, previous });
            }
            let payload = self.opened.messages.payload(&message);
            let value = match quick::decode(topic, payload).filter(|_| quick) {
                Some(value) => value,
                None => match self.opened.event(&message)? {
                    Some(value) => value,
                    None => continue,
                },
            };
            self.last = Some(message.at);
            return Ok(Some(Stamped { at: message.at, value }));
        }
        Ok(None)
    }

    /// Finds out what is to be done with the messages of a channel.
    fn plan(&mut self, id: u16) -> Plan {
        let Some(channel) = self.opened.messages.channel(id) else { return Plan::PassOver };
        let of_arm = channel.arm.unwrap_or(Arm::B) == self.arm;
        let wanted = |topic: &Topic| of_arm && self.wanted[*topic as usize];
        let plan = match channel.ours.filter(wanted) {
            None => Plan::PassOver,
            Some(topic) if channel.as_expected => Plan::Give(topic),
            Some(topic) => Plan::Refuse(topic),
        };
        let index = usize::from(id);
        if self.plans.len() <= index {
            self.plans.resize(index + 1, Plan::Unseen);
        }
        self.plans[index] = plan;
        plan
    }

    /// Whether the log has been read to its proper end: footer and closing bytes seen, all check
    /// sums right. False until then.
    pub fn is_complete(&self) -> bool {
        !self.failed && self.opened.messages.is_complete()
    }
}

impl<R: Read> Iterator for LogReader<R> {
    type Item = Result<Stamped<Event>, LogError>;

    fn next(&mut self) -> Option<Self::Item> {
        self.next_event().transpose()
    }
}

/// What stopped a run, as its mark has it.
fn stop(mark: &BTreeMap<String, String>) -> Stop {
    Stop::of_name(mark.get(header::STOPPED_BY).map(String::as_str))
}

/// Name and map of a metadata record; `None` where it does not parse, as ours always do.
fn parse_metadata(body: &[u8]) -> Option<(&str, BTreeMap<String, String>)> {
    let mut bytes = Bytes(body);
    let name = bytes.text()?;
    let mut pairs = Bytes(bytes.blob32()?);
    let mut map = BTreeMap::new();
    while !pairs.0.is_empty() {
        map.insert(pairs.text()?.to_owned(), pairs.text()?.to_owned());
    }
    Some((name, map))
}

/// Name and content of an attachment record; `None` where it does not parse, as ours always do.
fn parse_attachment(body: &[u8], at_byte: u64) -> Result<Option<(&str, &[u8])>, LogError> {
    let parse = || {
        let mut bytes = Bytes(body);
        bytes.u64()?;
        bytes.u64()?;
        let name = bytes.text()?;
        bytes.text()?;
        let data = bytes.blob64()?;
        let covered = body.len() - bytes.0.len();
        Some((name, data, &body[..covered], bytes.u32()?))
    };
    let Some((name, data, covered, crc)) = parse() else { return Ok(None) };
    if crc != 0 && crc != crc32fast::hash(covered) {
        let what = format!("the check sum of attachment `{name}` is wrong");
        // Attachments are read at the head alone, before any message.
        return Err(LogError::Damaged { at_byte, after: None, what });
    }
    Ok(Some((name, data)))
}

#[cfg(test)]
impl<R: Read> LogReader<R> {
    /// What the reader's buffers have room for, bytes.
    pub(super) fn buffered_bytes(&self) -> usize {
        self.opened.messages.buffered_bytes()
    }
}
