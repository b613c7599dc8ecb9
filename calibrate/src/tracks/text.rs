//! From bytes to text: byte order marks, UTF-16, and files that are not text at all.

use std::borrow::Cow;

/// The file's text without its byte order mark.
///
/// Bytes that are no UTF-8 (names in an old code page) become U+FFFD: only names can hold them.
///
/// # Errors
/// The name of the binary format that this is.
pub(super) fn decode(bytes: &[u8]) -> Result<Cow<'_, str>, &'static str> {
    if let Some(rest) = bytes.strip_prefix(b"\xEF\xBB\xBF") {
        return Ok(String::from_utf8_lossy(rest));
    }
    if let Some(rest) = bytes.strip_prefix(b"\xFF\xFE") {
        return Ok(Cow::Owned(utf16(rest, u16::from_le_bytes)));
    }
    if let Some(rest) = bytes.strip_prefix(b"\xFE\xFF") {
        return Ok(Cow::Owned(utf16(rest, u16::from_be_bytes)));
    }
    match binary_format(bytes) {
        Some(name) => Err(name),
        None => Ok(String::from_utf8_lossy(bytes)),
    }
}

fn utf16(bytes: &[u8], unit: fn([u8; 2]) -> u16) -> String {
    let (pairs, _) = bytes.as_chunks::<2>();
    char::decode_utf16(pairs.iter().map(|pair| unit(*pair)))
        .map(|decoded| decoded.unwrap_or(char::REPLACEMENT_CHARACTER))
        .collect()
}

fn binary_format(bytes: &[u8]) -> Option<&'static str> {
    let begins_with = |magic: &[u8]| bytes.starts_with(magic);
    if begins_with(b"\x89HDF") {
        Some("hdf5")
    } else if begins_with(b"PK\x03\x04") {
        Some("xlsx")
    } else if bytes.get(..4096).unwrap_or(bytes).contains(&0) {
        Some(if bytes.get(1) == Some(&0x50) {
            "c3d"
        } else {
            "binary"
        })
    } else {
        None
    }
}
