//! From bytes to text, a buffer at a time: byte order marks, UTF-16, and files that are not text at all.

use std::io::{self, BufRead, BufReader, Cursor, Read};

use super::utf16::Utf16;

/// First bytes that determine a file's encoding.
const PREFIX: usize = 4096;
/// Bytes read at once.
const BUFFER: usize = 1 << 18;

/// Encoding of a stream of bytes.
pub(super) enum Source<'s> {
    /// Text without its byte order mark. Bytes that are no UTF-8 are still in it.
    Text(Box<dyn BufRead + 's>),
    /// Not text: the name of the binary format.
    Binary(&'static str),
}

/// # Errors
/// Errors of the stream.
pub(super) fn open<'s>(mut bytes: impl Read + 's) -> io::Result<Source<'s>> {
    let mut prefix = Vec::with_capacity(PREFIX);
    bytes
        .by_ref()
        .take(PREFIX as u64)
        .read_to_end(&mut prefix)?;
    let utf16 = utf16(&prefix);
    if utf16.is_none()
        && let Some(name) = binary_format(&prefix)
    {
        return Ok(Source::Binary(name));
    }
    let (unit, mark) = utf16.map_or_else(
        || {
            (
                None,
                if prefix.starts_with(b"\xEF\xBB\xBF") {
                    3
                } else {
                    0
                },
            )
        },
        |(unit, mark)| (Some(unit), mark),
    );
    prefix.drain(..mark);
    let whole = Cursor::new(prefix).chain(bytes);
    Ok(Source::Text(match unit {
        None => Box::new(BufReader::with_capacity(BUFFER, whole)),
        Some(unit) => Box::new(BufReader::with_capacity(BUFFER, Utf16::new(whole, unit))),
    }))
}

/// Conversion of two bytes to a UTF-16 unit.
type Unit = fn([u8; 2]) -> u16;

/// UTF-16, by its mark or without, and how long the mark is.
fn utf16(prefix: &[u8]) -> Option<(Unit, usize)> {
    if prefix.starts_with(b"\xFF\xFE") {
        Some((u16::from_le_bytes, 2))
    } else if prefix.starts_with(b"\xFE\xFF") {
        Some((u16::from_be_bytes, 2))
    } else {
        Some((utf16_without_mark(prefix)?, 0))
    }
}

/// UTF-16 whose mark was lost: every other byte of the beginning is zero.
fn utf16_without_mark(prefix: &[u8]) -> Option<Unit> {
    let (pairs, _) = prefix.get(..64).unwrap_or(prefix).as_chunks::<2>();
    let all = |test: fn(&[u8; 2]) -> bool| pairs.len() >= 4 && pairs.iter().all(test);
    if all(|[low, high]| *low != 0 && *high == 0) {
        Some(u16::from_le_bytes)
    } else if all(|[high, low]| *low != 0 && *high == 0) {
        Some(u16::from_be_bytes)
    } else {
        None
    }
}

fn binary_format(prefix: &[u8]) -> Option<&'static str> {
    let begins_with = |magic: &[u8]| prefix.starts_with(magic);
    if begins_with(b"\x89HDF") {
        Some("hdf5")
    } else if begins_with(b"PK\x03\x04") {
        Some("xlsx")
    } else if prefix.contains(&0) {
        Some(if prefix.get(1) == Some(&0x50) {
            "c3d"
        } else {
            "binary"
        })
    } else {
        None
    }
}
