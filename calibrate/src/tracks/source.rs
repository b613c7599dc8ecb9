//! From bytes to text, a buffer at a time: byte order marks, UTF-16, and files that are not text at all.

use std::io::{self, BufRead, BufReader, Cursor, Read};

#[cfg(not(target_family = "wasm"))]
use encoding_rs::{Encoding, UTF_16BE, UTF_16LE};

/// Bytes by which a file's encoding is told.
const PREFIX: usize = 4096;
/// Bytes read at once.
const BUFFER: usize = 1 << 18;

/// What a stream of bytes turned out to be.
pub(super) enum Source<'s> {
    /// Text without its byte order mark. Bytes that are no UTF-8 are still in it.
    Text(Box<dyn BufRead + 's>),
    /// Not text: the name of the binary format.
    Binary(&'static str),
}

/// # Errors
/// What the stream answers.
pub(super) fn open<'s>(mut bytes: impl Read + 's) -> io::Result<Source<'s>> {
    let mut prefix = Vec::with_capacity(PREFIX);
    bytes
        .by_ref()
        .take(PREFIX as u64)
        .read_to_end(&mut prefix)?;
    if let Some(order) = utf16(&prefix) {
        return decoded(order, prefix, bytes);
    }
    if let Some(name) = binary_format(&prefix) {
        return Ok(Source::Binary(name));
    }
    let mark = if prefix.starts_with(b"\xEF\xBB\xBF") {
        3
    } else {
        0
    };
    prefix.drain(..mark);
    let whole = Cursor::new(prefix).chain(bytes);
    Ok(Source::Text(Box::new(BufReader::with_capacity(
        BUFFER, whole,
    ))))
}

/// Which byte of a UTF-16 unit comes first, and whether a mark says so.
#[derive(Clone, Copy)]
enum Utf16 {
    Marked,
    Little,
    Big,
}

fn utf16(prefix: &[u8]) -> Option<Utf16> {
    if prefix.starts_with(b"\xFF\xFE") || prefix.starts_with(b"\xFE\xFF") {
        Some(Utf16::Marked)
    } else {
        utf16_without_mark(prefix)
    }
}

/// UTF-16 as text.
#[cfg(not(target_family = "wasm"))]
#[expect(clippy::unnecessary_wraps, reason = "in a browser it fails")]
fn decoded<'s>(order: Utf16, prefix: Vec<u8>, bytes: impl Read + 's) -> io::Result<Source<'s>> {
    let encoding: Option<&'static Encoding> = match order {
        Utf16::Marked => None,
        Utf16::Little => Some(UTF_16LE),
        Utf16::Big => Some(UTF_16BE),
    };
    let decoded = encoding_rs_io::DecodeReaderBytesBuilder::new()
        .encoding(encoding)
        .strip_bom(true)
        .build(Cursor::new(prefix).chain(bytes));
    Ok(Source::Text(Box::new(BufReader::with_capacity(
        BUFFER, decoded,
    ))))
}

/// A page in a browser has no decoder of its own here.
#[cfg(target_family = "wasm")]
fn decoded<'s>(_: Utf16, _: Vec<u8>, _: impl Read + 's) -> io::Result<Source<'s>> {
    Err(io::Error::other(
        "it is UTF-16, which the page does not read; save it as UTF-8",
    ))
}

/// UTF-16 whose mark was lost: every other byte of the beginning is zero.
fn utf16_without_mark(prefix: &[u8]) -> Option<Utf16> {
    let (pairs, _) = prefix.get(..64).unwrap_or(prefix).as_chunks::<2>();
    let all = |test: fn(&[u8; 2]) -> bool| pairs.len() >= 4 && pairs.iter().all(test);
    if all(|[low, high]| *low != 0 && *high == 0) {
        Some(Utf16::Little)
    } else if all(|[high, low]| *low != 0 && *high == 0) {
        Some(Utf16::Big)
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
