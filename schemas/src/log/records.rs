//! The outermost layer of an MCAP file: records one after another, each with an opcode and a length.
//!
//! Bytes come in, records go out, with the place where each began. Nothing is trusted: a length
//! is a claim, the buffer only grows by what is really there, and the check sums of data section and
//! summary are verified on the way.

use std::io::{self, Read};

use super::LogError;
use super::bytes::Bytes;

/// The bytes that open and close every MCAP file.
const MAGIC: &[u8; 8] = b"\x89MCAP0\r\n";

/// Opcodes that matter here (MCAP specification, "Records").
pub(super) mod opcode {
    pub(crate) const FOOTER: u8 = 0x02;
    pub(crate) const SCHEMA: u8 = 0x03;
    pub(crate) const CHANNEL: u8 = 0x04;
    pub(crate) const MESSAGE: u8 = 0x05;
    pub(crate) const CHUNK: u8 = 0x06;
    pub(crate) const MESSAGE_INDEX: u8 = 0x07;
    pub(crate) const ATTACHMENT: u8 = 0x09;
    pub(crate) const METADATA: u8 = 0x0C;
    pub(crate) const DATA_END: u8 = 0x0F;
}

/// Longest record that is taken into memory, and longest content of a chunk, bytes. Our chunks hold
/// 128 KiB; other programs that rewrite a log use up to a few MiB.
pub(super) const RECORD_LIMIT: u64 = 64 << 20;

/// Up to so many bytes are asked for at once where there is room for them.
const AT_ONCE: usize = 1 << 20;

/// One record. Its body is in the [`Records`] it came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Record {
    /// What it is.
    pub(super) opcode: u8,
    /// Where it begins in the file, bytes.
    pub(super) at_byte: u64,
    /// Whether all of it was there.
    pub(super) whole: bool,
}

/// Why there is no next record. The layers above add how far the session was read.
#[derive(Debug)]
pub(super) enum Broken {
    Log(LogError),
    CutOff { at_byte: u64 },
    Damaged { at_byte: u64, what: String },
}

impl From<io::Error> for Broken {
    fn from(error: io::Error) -> Self {
        Broken::Log(LogError::Io(error))
    }
}

/// Reads records from a source of bytes.
pub(super) struct Records<R> {
    source: R,
    /// Bytes read so far.
    at_byte: u64,
    /// The body of the record, and behind it what is left of longer ones: it need not be cleared.
    buffer: Vec<u8>,
    filled: usize,
    /// Over the data section, then over the summary.
    check: crc32fast::Hasher,
    /// Seen the footer and the closing magic, with nothing behind them.
    complete: bool,
}

impl<R: Read> Records<R> {
    /// Reads the opening magic.
    pub(super) fn new(source: R) -> Result<Self, Broken> {
        let mut records = Records {
            source,
            at_byte: 0,
            buffer: Vec::new(),
            filled: 0,
            check: crc32fast::Hasher::new(),
            complete: false,
        };
        records.fill(MAGIC.len() as u64)?;
        let found = records.body();
        if found.is_empty() {
            return Err(Broken::Log(LogError::NotMcap("it is empty")));
        }
        if !MAGIC.starts_with(found) {
            return Err(Broken::Log(LogError::NotMcap("its first bytes are other than MCAP's")));
        }
        if found.len() < MAGIC.len() {
            return Err(Broken::CutOff { at_byte: records.at_byte });
        }
        records.check.update(MAGIC);
        Ok(records)
    }

    /// The body of the record that [`Records::next`] gave last.
    pub(super) fn body(&self) -> &[u8] {
        &self.buffer[..self.filled]
    }

    /// Bytes read so far.
    pub(super) fn at_byte(&self) -> u64 {
        self.at_byte
    }

    /// Whether the file has been read to its proper end.
    pub(super) fn is_complete(&self) -> bool {
        self.complete
    }

    /// The next record; `None` after the closing magic. A record that is not whole is the last.
    pub(super) fn next(&mut self) -> Result<Option<Record>, Broken> {
        if self.complete {
            return Ok(None);
        }
        let at_byte = self.at_byte;
        self.fill(9)?;
        let mut head = Bytes(self.body());
        let (Some(opcode), Some(length)) = (head.u8(), head.u64()) else {
            return Err(Broken::CutOff { at_byte: self.at_byte });
        };
        // What stands before the data end is covered by its check sum, the data end itself by none.
        let data_check = (opcode == opcode::DATA_END).then(|| self.check.clone().finalize());
        self.check.update(&self.buffer[..self.filled]);

        if length > RECORD_LIMIT {
            if matches!(opcode, opcode::CHUNK | opcode::MESSAGE | opcode::SCHEMA | opcode::CHANNEL)
            {
                let what = format!("a record of {length} bytes, more than {RECORD_LIMIT}");
                return Err(Broken::Damaged { at_byte, what });
            }
            self.skip(length)?;
            return Ok(Some(Record { opcode, at_byte, whole: true }));
        }
        self.fill(length)?;
        let whole = self.filled as u64 == length;
        match opcode {
            opcode::DATA_END if whole => {
                self.check = crc32fast::Hasher::new();
                compare(
                    Bytes(self.body()).u32(),
                    data_check.unwrap_or(0),
                    at_byte,
                    "data section",
                )?;
            }
            opcode::FOOTER if whole => self.finish(at_byte)?,
            _ => self.check.update(&self.buffer[..self.filled]),
        }
        Ok(Some(Record { opcode, at_byte, whole }))
    }

    /// Checks the footer in the body, then the closing magic and that nothing follows.
    fn finish(&mut self, at_byte: u64) -> Result<(), Broken> {
        let mut footer = Bytes(&self.buffer[..self.filled]);
        // The summary's check sum covers the footer up to the check sum itself.
        if let Some(offsets) = footer.take(16) {
            self.check.update(offsets);
        }
        let calculated = self.check.clone().finalize();
        compare(footer.u32(), calculated, at_byte, "summary")?;

        let end_byte = self.at_byte;
        self.fill(MAGIC.len() as u64)?;
        if self.filled < MAGIC.len() && MAGIC.starts_with(self.body()) {
            return Err(Broken::CutOff { at_byte: self.at_byte });
        }
        if self.body() != MAGIC {
            let what = "the closing bytes are other than MCAP's".to_owned();
            return Err(Broken::Damaged { at_byte: end_byte, what });
        }
        let after_byte = self.at_byte;
        self.fill(1)?;
        if self.filled > 0 {
            let what = "more bytes follow the end of the log".to_owned();
            return Err(Broken::Damaged { at_byte: after_byte, what });
        }
        self.complete = true;
        Ok(())
    }

    /// Reads up to `count` bytes into the body; fewer only at the end of the source. The buffer
    /// grows by what arrives, not by what is claimed.
    fn fill(&mut self, count: u64) -> io::Result<()> {
        self.filled = 0;
        // Most records are small, and what reads to the end first looks where that is.
        if count <= self.buffer.capacity().min(AT_ONCE) as u64 {
            let count = count as usize;
            if self.buffer.len() < count {
                self.buffer.resize(count, 0);
            }
            while self.filled < count {
                match self.source.read(&mut self.buffer[self.filled..count]) {
                    Ok(0) => break,
                    Ok(read) => self.filled += read,
                    Err(error) if error.kind() == io::ErrorKind::Interrupted => {}
                    Err(error) => return Err(error),
                }
            }
        } else {
            self.buffer.clear();
            let read = self.source.by_ref().take(count).read_to_end(&mut self.buffer);
            self.filled = self.buffer.len();
            read?;
        }
        self.at_byte += self.filled as u64;
        Ok(())
    }

    /// Passes over `count` bytes without keeping them.
    fn skip(&mut self, count: u64) -> Result<(), Broken> {
        let mut left = count;
        while left > 0 {
            self.fill(left.min(1 << 16))?;
            if self.filled == 0 {
                return Err(Broken::CutOff { at_byte: self.at_byte });
            }
            self.check.update(&self.buffer[..self.filled]);
            left -= self.filled as u64;
        }
        self.filled = 0;
        Ok(())
    }
}

/// Compares a stored check sum with the one calculated; 0 stands for "none was stored".
fn compare(stored: Option<u32>, calculated: u32, at_byte: u64, of: &str) -> Result<(), Broken> {
    match stored {
        None => Err(Broken::Damaged { at_byte, what: format!("the end of the {of} is too short") }),
        Some(stored) if stored != 0 && stored != calculated => {
            let what = format!("the check sum of the {of} is {calculated:08x}, not {stored:08x}");
            Err(Broken::Damaged { at_byte, what })
        }
        Some(_) => Ok(()),
    }
}

#[cfg(test)]
impl<R> Records<R> {
    pub(super) fn capacity(&self) -> usize {
        self.buffer.capacity()
    }
}
