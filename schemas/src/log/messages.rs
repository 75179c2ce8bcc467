//! The messages of an MCAP file in file order, whatever they carry: schemas, channels and chunks
//! resolved, nothing decoded.

use std::collections::BTreeMap;
use std::io::Read;
use std::ops::Range;

use super::bytes::Bytes;
use super::chunk::Chunk;
use super::records::{Broken, Record, Records, opcode};
use super::{Arm, LogError, Topic};
use crate::Time;

/// A channel as the file declares it.
#[derive(Clone, Debug)]
pub(super) struct Channel {
    pub(super) topic: String,
    pub(super) encoding: String,
    pub(super) schema: String,
    /// Which of our topics it is, if it is one.
    pub(super) ours: Option<Topic>,
    /// Which of two runs it belongs to, where there are two.
    pub(super) arm: Option<Arm>,
    /// Whether it carries what the topic should carry.
    pub(super) as_expected: bool,
}

/// One message. Its payload is in the [`Messages`] it came from.
#[derive(Clone, Debug)]
pub(super) struct Message {
    pub(super) channel: u16,
    pub(super) sequence: u32,
    pub(super) at: Time,
    payload: Range<usize>,
    in_chunk: bool,
}

/// Something that stands outside the stream of messages.
pub(super) enum Item {
    Message(Message),
    /// The body of [`Messages::body`] is a metadata record.
    Metadata,
    /// The body of [`Messages::body`] is an attachment.
    Attachment,
}

/// Reads messages from a source of bytes.
pub(super) struct Messages<R> {
    records: Records<R>,
    chunk: Chunk,
    in_chunk: bool,
    /// The record being read.
    record: Record,
    /// Name and encoding of each schema.
    schemas: BTreeMap<u16, (String, String)>,
    channels: Vec<Option<Box<Channel>>>,
    /// For the seconds in error messages.
    pub(super) start: Time,
    reached: Option<Time>,
    ended: bool,
}

impl<R: Read> Messages<R> {
    pub(super) fn new(source: R) -> Result<Self, LogError> {
        let records = Records::new(source).map_err(|broken| as_error(broken, None))?;
        Ok(Messages {
            records,
            chunk: Chunk::default(),
            in_chunk: false,
            record: Record { opcode: 0, at_byte: 0, whole: true },
            schemas: BTreeMap::new(),
            channels: Vec::new(),
            start: Time(0),
            reached: None,
            ended: false,
        })
    }

    /// Whether the file has been read to its proper end.
    pub(super) fn is_complete(&self) -> bool {
        self.records.is_complete()
    }

    /// Bytes read so far.
    pub(super) fn at_byte(&self) -> u64 {
        self.records.at_byte()
    }

    /// Start of the record, or of the chunk, that the last message came from.
    pub(super) fn record_byte(&self) -> u64 {
        self.record.at_byte
    }

    /// The body of the current record outside of chunks.
    pub(super) fn body(&self) -> &[u8] {
        self.records.body()
    }

    /// A channel by its number.
    pub(super) fn channel(&self, id: u16) -> Option<&Channel> {
        self.channels.get(usize::from(id))?.as_deref()
    }

    /// The payload of the message that [`Messages::next`] gave last.
    pub(super) fn payload(&self, message: &Message) -> &[u8] {
        if message.in_chunk {
            self.chunk.body(message.payload.clone())
        } else {
            &self.records.body()[message.payload.clone()]
        }
    }

    /// Seconds from the start of the session to the last message given.
    pub(super) fn reached_s(&self) -> Option<f64> {
        self.reached.map(|at| at.seconds_since(self.start))
    }

    /// Ends the stream here: nothing further is given.
    pub(super) fn end(&mut self) {
        self.ended = true;
    }

    /// The next message, metadata record or attachment; `None` at the end, and after an error.
    #[inline]
    pub(super) fn next(&mut self) -> Result<Option<Item>, LogError> {
        // Nearly everything is a message in a chunk.
        if self.in_chunk && !self.ended {
            let channels = &self.channels;
            let known = |id| channels.get(usize::from(id)).is_some_and(Option::is_some);
            if let Some((channel, sequence, at, payload)) = self.chunk.next_message(known) {
                let at = Time(at);
                self.reached = Some(at);
                let message = Message { channel, sequence, at, payload, in_chunk: true };
                return Ok(Some(Item::Message(message)));
            }
        }
        self.next_of_any_kind()
    }

    fn next_of_any_kind(&mut self) -> Result<Option<Item>, LogError> {
        if self.ended {
            return Ok(None);
        }
        match self.advance() {
            Ok(Some(item)) => {
                if let Item::Message(message) = &item {
                    self.reached = Some(message.at);
                }
                Ok(Some(item))
            }
            Ok(None) => {
                self.ended = true;
                Ok(None)
            }
            Err(broken) => {
                self.ended = true;
                Err(as_error(broken, self.reached_s()))
            }
        }
    }

    fn advance(&mut self) -> Result<Option<Item>, Broken> {
        loop {
            if self.in_chunk {
                match self.chunk.next() {
                    Ok(Some((opcode, range))) => {
                        if let Some(message) = self.take(opcode, Some(&range))? {
                            return Ok(Some(Item::Message(message)));
                        }
                        continue;
                    }
                    Ok(None) if self.record.whole => self.in_chunk = false,
                    // The rest of a record that the end of the file has cut off.
                    _ if !self.record.whole => return Err(self.cut_off()),
                    Err(what) => return Err(self.damaged(what)),
                    Ok(None) => self.in_chunk = false,
                }
            }
            let Some(record) = self.records.next()? else { return Ok(None) };
            let previous = std::mem::replace(&mut self.record, record).opcode;
            if record.opcode == opcode::CHUNK {
                if record.whole {
                    self.chunk.load(self.records.body()).map_err(|what| self.damaged(what))?;
                } else {
                    self.chunk.load_part(self.records.body());
                }
                self.in_chunk = true;
                continue;
            }
            if !record.whole {
                return Err(self.cut_off());
            }
            match record.opcode {
                opcode::MESSAGE_INDEX => self.check_index(previous)?,
                opcode::METADATA => return Ok(Some(Item::Metadata)),
                opcode::ATTACHMENT => return Ok(Some(Item::Attachment)),
                other => {
                    if let Some(message) = self.take(other, None)? {
                        return Ok(Some(Item::Message(message)));
                    }
                }
            }
        }
    }

    /// Message indexes follow their chunk. One that stands elsewhere, or has another form, shows that
    /// a chunk was not recognised as such: without this, its messages would silently be missing.
    fn check_index(&self, previous: u8) -> Result<(), Broken> {
        let mut bytes = Bytes(self.records.body());
        let well_formed = bytes.u16().is_some() && bytes.blob32().is_some() && bytes.0.is_empty();
        if well_formed && matches!(previous, opcode::CHUNK | opcode::MESSAGE_INDEX) {
            Ok(())
        } else {
            Err(self.damaged("a message index without its chunk"))
        }
    }

    /// Takes in a schema, channel or message record from the chunk, or from the current record.
    fn take(
        &mut self,
        opcode: u8,
        range: Option<&Range<usize>>,
    ) -> Result<Option<Message>, Broken> {
        let body = match range {
            Some(range) => self.chunk.body(range.clone()),
            None => self.records.body(),
        };
        let taken = match opcode {
            opcode::MESSAGE => {
                let begin = range.map_or(0, |range| range.start);
                let end = begin + body.len();
                let mut bytes = Bytes(body);
                let head = (bytes.u16(), bytes.u32(), bytes.u64(), bytes.u64());
                let (Some(channel), Some(sequence), Some(at), Some(_)) = head else {
                    return Err(self.damaged("a message is shorter than its head"));
                };
                if self.channel(channel).is_none() {
                    let what = format!("a message belongs to channel {channel}, which is unknown");
                    return Err(self.damaged(what));
                }
                let payload = end - bytes.0.len()..end;
                let in_chunk = range.is_some();
                return Ok(Some(Message { channel, sequence, at: Time(at), payload, in_chunk }));
            }
            opcode::SCHEMA => parse_schema(body).map(|(id, schema)| {
                self.schemas.insert(id, schema);
            }),
            opcode::CHANNEL => parse_channel(body).map(|(id, schema, channel)| {
                self.declare(id, schema, channel);
            }),
            _ => Some(()),
        };
        match taken {
            Some(()) => Ok(None),
            None => Err(self.damaged("a schema or channel record does not parse")),
        }
    }

    fn declare(&mut self, id: u16, schema: u16, mut channel: Channel) {
        let index = usize::from(id);
        if self.channels.len() <= index {
            self.channels.resize_with(index + 1, || None);
        }
        // Summaries repeat every channel; the first declaration holds.
        if self.channels[index].is_some() {
            return;
        }
        if let Some((name, encoding)) = self.schemas.get(&schema) {
            channel.schema.clone_from(name);
            channel.as_expected = encoding == "protobuf"
                && channel.encoding == "protobuf"
                && channel.ours.is_some_and(|topic| topic.info().schema == name);
        }
        self.channels[index] = Some(Box::new(channel));
    }

    fn damaged(&self, what: impl Into<String>) -> Broken {
        Broken::Damaged { at_byte: self.record.at_byte, what: what.into() }
    }

    fn cut_off(&self) -> Broken {
        Broken::CutOff { at_byte: self.records.at_byte() }
    }
}

fn parse_schema(body: &[u8]) -> Option<(u16, (String, String))> {
    let mut bytes = Bytes(body);
    let id = bytes.u16()?;
    let name = bytes.text()?.to_owned();
    let encoding = bytes.text()?.to_owned();
    bytes.blob32()?;
    Some((id, (name, encoding)))
}

fn parse_channel(body: &[u8]) -> Option<(u16, u16, Channel)> {
    let mut bytes = Bytes(body);
    let id = bytes.u16()?;
    let schema = bytes.u16()?;
    let topic = bytes.text()?.to_owned();
    let encoding = bytes.text()?.to_owned();
    bytes.blob32()?;
    let (arm, ours) = Arm::split(&topic).map_or((None, None), |(arm, topic)| (arm, Some(topic)));
    let channel = Channel { topic, encoding, schema: String::new(), ours, arm, as_expected: false };
    Some((id, schema, channel))
}

fn as_error(broken: Broken, after: Option<f64>) -> LogError {
    match broken {
        Broken::Log(error) => error,
        Broken::CutOff { at_byte } => LogError::Truncated { at_byte, after },
        Broken::Damaged { at_byte, what } => LogError::Damaged { at_byte, after, what },
    }
}

#[cfg(test)]
impl<R> Messages<R> {
    pub(super) fn buffered_bytes(&self) -> usize {
        self.records.capacity() + self.chunk.capacity()
    }
}
