//! One chunk: its records, decompressed into a buffer that is used again for the next chunk.

use std::io::Read;

use super::bytes::Bytes;
use super::records::{RECORD_LIMIT, opcode};

/// The content of the chunk being read.
#[derive(Default)]
pub(super) struct Chunk {
    content: Vec<u8>,
    position: usize,
    zstd: Option<zstd::bulk::Decompressor<'static>>,
}

/// The head of a chunk record.
struct Head<'a> {
    uncompressed: usize,
    crc: u32,
    compression: &'a str,
    records: &'a [u8],
}

impl<'a> Head<'a> {
    fn parse(body: &'a [u8], whole: bool) -> Result<Head<'a>, String> {
        let parse = || {
            let mut bytes = Bytes(body);
            let _times = bytes.take(16)?;
            let uncompressed = bytes.u64()?;
            let crc = bytes.u32()?;
            let compression = bytes.text()?;
            let compressed = bytes.u64()?;
            Some((uncompressed, crc, compression, compressed, bytes.0))
        };
        let (uncompressed, crc, compression, compressed, rest) =
            parse().ok_or_else(|| "the head of a chunk is too short".to_owned())?;
        if uncompressed > RECORD_LIMIT {
            return Err(format!(
                "a chunk claims {uncompressed} bytes of content, more than {RECORD_LIMIT}"
            ));
        }
        let claimed = usize::try_from(compressed).unwrap_or(usize::MAX);
        if whole && claimed > rest.len() {
            return Err(format!("a chunk claims {compressed} bytes, but holds {}", rest.len()));
        }
        let records = &rest[..claimed.min(rest.len())];
        Ok(Head { uncompressed: uncompressed as usize, crc, compression, records })
    }
}

impl Chunk {
    /// Takes in a whole chunk record and verifies its check sum.
    pub(super) fn load(&mut self, body: &[u8]) -> Result<(), String> {
        self.clear();
        let head = Head::parse(body, true)?;
        let loaded = self.decompress(&head);
        if let Err(what) = loaded {
            self.clear();
            return Err(what);
        }
        if self.content.len() != head.uncompressed {
            let found = self.content.len();
            self.clear();
            return Err(format!("a chunk holds {found} bytes, but claims {}", head.uncompressed));
        }
        let crc = crc32fast::hash(&self.content);
        if head.crc != 0 && head.crc != crc {
            self.clear();
            return Err(format!("the check sum of a chunk is {crc:08x}, not {:08x}", head.crc));
        }
        Ok(())
    }

    /// Takes in what is there of a chunk that the end of the file cuts off, without a check sum.
    pub(super) fn load_part(&mut self, body: &[u8]) {
        self.clear();
        let Ok(head) = Head::parse(body, false) else { return };
        let limit = head.uncompressed as u64;
        // An error is the expected end of these readers; what came before it is the content.
        let _ = match head.compression {
            "" => head.records.take(limit).read_to_end(&mut self.content),
            "zstd" => zstd::stream::read::Decoder::with_buffer(head.records)
                .and_then(|decoder| read_while(decoder, limit, &mut self.content)),
            "lz4" => lz4::Decoder::new(head.records)
                .and_then(|decoder| read_while(decoder, limit, &mut self.content)),
            _ => Ok(0),
        };
    }

    fn decompress(&mut self, head: &Head<'_>) -> Result<(), String> {
        let failed = |error: std::io::Error| format!("a chunk cannot be decompressed: {error}");
        match head.compression {
            "" => self.content.extend_from_slice(head.records),
            "zstd" => {
                self.content.reserve_exact(head.uncompressed);
                let decompressor = match &mut self.zstd {
                    Some(decompressor) => decompressor,
                    slot => slot.insert(zstd::bulk::Decompressor::new().map_err(failed)?),
                };
                decompressor
                    .decompress_to_buffer(head.records, &mut self.content)
                    .map_err(failed)?;
            }
            "lz4" => {
                let decoder = lz4::Decoder::new(head.records).map_err(failed)?;
                decoder
                    .take(head.uncompressed as u64)
                    .read_to_end(&mut self.content)
                    .map_err(failed)?;
            }
            other => return Err(format!("a chunk is compressed with {other:?}, not zstd or lz4")),
        }
        Ok(())
    }

    fn clear(&mut self) {
        self.content.clear();
        self.position = 0;
    }

    /// The next record, where it is a whole message on a known channel: channel, sequence, log time, and
    /// where its payload lies. Where it is anything else nothing is taken, and [`Chunk::next`] has to look.
    #[inline]
    pub(super) fn next_message(
        &mut self,
        known: impl FnOnce(u16) -> bool,
    ) -> Option<(u16, u32, u64, std::ops::Range<usize>)> {
        // Opcode and length, then channel, sequence and two times.
        const HEAD: usize = 9 + 22;
        let rest = self.content.get(self.position..)?;
        let mut head = Bytes(rest.first_chunk::<HEAD>()?);
        if head.u8()? != opcode::MESSAGE {
            return None;
        }
        let length = usize::try_from(head.u64()?).ok()?;
        if length < HEAD - 9 || length > rest.len() - 9 {
            return None;
        }
        let (channel, sequence, at) = (head.u16()?, head.u32()?, head.u64()?);
        if !known(channel) {
            return None;
        }
        let begin = self.position + HEAD;
        self.position += 9 + length;
        Some((channel, sequence, at, begin..self.position))
    }

    /// The next record in the chunk: its opcode and where its body lies; `None` at the end.
    pub(super) fn next(&mut self) -> Result<Option<(u8, std::ops::Range<usize>)>, &'static str> {
        let mut rest = Bytes(&self.content[self.position..]);
        if rest.0.is_empty() {
            return Ok(None);
        }
        let before = rest.0.len();
        let (Some(opcode), Some(body)) = (rest.u8(), rest.blob64()) else {
            self.position = self.content.len();
            return Err("a record goes beyond the end of its chunk");
        };
        self.position += before - rest.0.len();
        Ok(Some((opcode, self.position - body.len()..self.position)))
    }

    /// The bytes of a body found by [`Chunk::next`].
    pub(super) fn body(&self, range: std::ops::Range<usize>) -> &[u8] {
        &self.content[range]
    }
}

/// Reads until `limit`, the end, or an error, keeping everything up to there.
fn read_while(mut reader: impl Read, limit: u64, content: &mut Vec<u8>) -> std::io::Result<usize> {
    let mut piece = [0; 4096];
    while (content.len() as u64) < limit {
        let count = reader.read(&mut piece)?;
        if count == 0 {
            break;
        }
        content.extend_from_slice(&piece[..count]);
    }
    Ok(content.len())
}

#[cfg(test)]
impl Chunk {
    pub(super) fn capacity(&self) -> usize {
        self.content.capacity()
    }
}
