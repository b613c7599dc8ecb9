//! The records of an MCAP file as far as a link log has them: an opcode, a length, the record; chunks hold records in turn. The
//! library that writes them reads every record that the format knows; here it would be a twentieth of the lab page's module.

use std::borrow::Cow;
use std::io::Read as _;

use ruzstd::decoding::StreamingDecoder;

/// Ends a file.
pub(super) const FOOTER: u8 = 0x02;
pub(super) const CHANNEL: u8 = 0x04;
pub(super) const MESSAGE: u8 = 0x05;
pub(super) const CHUNK: u8 = 0x06;

/// Iterator over complete records with their opcodes; the remainder belongs to no record.
pub(super) struct Records<'a>(pub(super) &'a [u8]);

impl<'a> Iterator for Records<'a> {
    type Item = (u8, &'a [u8]);

    fn next(&mut self) -> Option<Self::Item> {
        let (opcode, mut rest) = self.0.split_first()?;
        let record = field::<8>(&mut rest)?;
        self.0 = rest;
        Some((*opcode, record))
    }
}

/// Contents of a field after its length of `LENGTH` bytes.
fn field<'a, const LENGTH: usize>(bytes: &mut &'a [u8]) -> Option<&'a [u8]> {
    let (length, rest) = bytes.split_first_chunk::<LENGTH>()?;
    let mut number = [0; 8];
    number.get_mut(..LENGTH)?.copy_from_slice(length);
    let (field, rest) = rest.split_at_checked(usize::try_from(u64::from_le_bytes(number)).ok()?)?;
    *bytes = rest;
    Some(field)
}

/// A channel's number and topic.
pub(super) fn channel(record: &[u8]) -> Option<(u16, &str)> {
    let (number, rest) = record.split_first_chunk::<2>()?;
    // Behind the number of its schema.
    let topic = field::<4>(&mut rest.get(2..)?)?;
    Some((u16::from_le_bytes(*number), str::from_utf8(topic).ok()?))
}

/// A message's channel and what it says, behind a sequence number and two times.
pub(super) fn message(record: &[u8]) -> Option<(u16, &[u8])> {
    let (number, rest) = record.split_first_chunk::<2>()?;
    Some((u16::from_le_bytes(*number), rest.get(4 + 8 + 8..)?))
}

/// Most bytes of records that a chunk may hold; our own hold some 20 kB.
const LARGEST_CHUNK: u64 = 1 << 28;

/// The records of a chunk, decompressed.
///
/// # Errors
/// Reason why the chunk cannot be read.
pub(super) fn of_chunk(record: &[u8]) -> Result<Cow<'_, [u8]>, String> {
    let parts = || -> Option<(u64, &[u8], &[u8])> {
        // After two times; a checksum follows.
        let (size, rest) = record.get(16..)?.split_first_chunk::<8>()?;
        let mut rest = rest.get(4..)?;
        let compression = field::<4>(&mut rest)?;
        Some((
            u64::from_le_bytes(*size),
            compression,
            field::<8>(&mut rest)?,
        ))
    };
    let (size, compression, records) = parts().ok_or("a chunk is damaged")?;
    match compression {
        b"" => Ok(Cow::Borrowed(records)),
        b"zstd" => decompressed(records, size).map(Cow::Owned),
        other => Err(format!(
            "a chunk is compressed by {}, which is not read; let `mcap compress --compression zstd` write it anew",
            String::from_utf8_lossy(other)
        )),
    }
}

fn decompressed(mut records: &[u8], size: u64) -> Result<Vec<u8>, String> {
    if size > LARGEST_CHUNK {
        return Err(format!(
            "a chunk of {size} bytes is larger than the {LARGEST_CHUNK} that are read; \
             let `mcap compress --chunk-size 1000000` write it anew"
        ));
    }
    let damaged = |reason: &dyn std::fmt::Display| {
        // The decoder's messages have several lines.
        let reason = reason.to_string();
        let first = reason.lines().next().unwrap_or_default();
        format!("a compressed chunk is damaged: {first}")
    };
    let decoder = StreamingDecoder::new(&mut records).map_err(|error| damaged(&error))?;
    let mut out = Vec::new();
    decoder
        .take(size + 1)
        .read_to_end(&mut out)
        .map_err(|error| damaged(&error))?;
    if out.len() as u64 == size {
        Ok(out)
    } else {
        Err(damaged(&format_args!("it does not hold {size} bytes")))
    }
}
