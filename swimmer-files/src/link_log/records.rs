//! The records of an MCAP file as far as a link log has them: an opcode, a length, the record; chunks hold records in turn. The
//! library that writes them reads every record that the format knows; here it would be a twentieth of the lab page's module.

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

/// The records of a chunk.
///
/// # Errors
/// Reason why the chunk cannot be read.
pub(super) fn of_chunk(record: &[u8]) -> Result<&[u8], String> {
    let parts = || -> Option<(&[u8], &[u8])> {
        // After two times, a length and a checksum.
        let mut rest = record.get(16 + 8 + 4..)?;
        Some((field::<4>(&mut rest)?, field::<8>(&mut rest)?))
    };
    let (compression, records) = parts().ok_or("a chunk is damaged")?;
    if compression.is_empty() {
        return Ok(records);
    }
    Err(format!(
        "a chunk is compressed by {}, which is not read; let `mcap compress --compression none` write it anew",
        String::from_utf8_lossy(compression)
    ))
}
