//! UTF-16 as UTF-8, a buffer at a time.

use std::io::{self, Read};

/// Bytes read at once.
const BUFFER: usize = 1 << 16;

/// Reads UTF-16 as UTF-8. Half a pair, or half a unit at the end, becomes U+FFFD.
pub(super) struct Utf16<'s> {
    bytes: Box<dyn Read + 's>,
    unit: fn([u8; 2]) -> u16,
    /// Read but not yet decoded bytes, which may continue in the next piece.
    rest: Vec<u8>,
    text: io::Cursor<String>,
}

impl<'s> Utf16<'s> {
    /// `bytes` without their mark; `unit` knows which byte of a unit comes first.
    pub(super) fn new(bytes: impl Read + 's, unit: fn([u8; 2]) -> u16) -> Self {
        Self {
            bytes: Box::new(bytes),
            unit,
            rest: Vec::new(),
            text: io::Cursor::default(),
        }
    }

    /// Decodes the next piece; nothing is left where it is empty.
    fn piece(&mut self) -> io::Result<String> {
        loop {
            let mut more = self.bytes.by_ref().take(BUFFER as u64);
            let ended = more.read_to_end(&mut self.rest)? == 0;
            let (pairs, odd) = self.rest.as_chunks::<2>();
            let mut units: Vec<u16> = pairs.iter().map(|pair| (self.unit)(*pair)).collect();
            let mut kept = odd.to_vec();
            if ended {
                // No text ends with half a unit.
                units.extend(odd.iter().map(|_| 0xFFFD));
                kept.clear();
            } else if let Some(last) = pairs.last()
                && matches!((self.unit)(*last), 0xD800..=0xDBFF)
            {
                units.pop();
                kept = [last, odd].concat();
            }
            self.rest = kept;
            let letters = char::decode_utf16(units);
            let text: String = letters
                .map(|letter| letter.unwrap_or(char::REPLACEMENT_CHARACTER))
                .collect();
            if ended || !text.is_empty() {
                return Ok(text);
            }
        }
    }
}

impl Read for Utf16<'_> {
    fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
        let read = self.text.read(buffer)?;
        if read > 0 || buffer.is_empty() {
            return Ok(read);
        }
        self.text = io::Cursor::new(self.piece()?);
        self.text.read(buffer)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// A few bytes at a time, as a slow disk gives them.
    struct Drops<'a>(&'a [u8], usize);

    impl Read for Drops<'_> {
        fn read(&mut self, buffer: &mut [u8]) -> io::Result<usize> {
            let end = self.1.min(self.0.len()).min(buffer.len());
            let (now, later) = self.0.split_at(end);
            buffer[..end].copy_from_slice(now);
            self.0 = later;
            Ok(end)
        }
    }

    fn read(bytes: impl Read, unit: fn([u8; 2]) -> u16) -> String {
        let mut text = String::new();
        Utf16::new(bytes, unit).read_to_string(&mut text).unwrap();
        text
    }

    #[test]
    fn broken_text_shows_where_it_is_broken() {
        let little = |units: &[u16]| -> Vec<u8> {
            units.iter().flat_map(|unit| unit.to_le_bytes()).collect()
        };
        let read = |bytes: &[u8]| read(bytes, u16::from_le_bytes);
        assert_eq!(read(&little(&[0x61, 0xD83D, 0x62])), "a\u{FFFD}b");
        assert_eq!(read(&little(&[0x61, 0xDC1F, 0x62])), "a\u{FFFD}b");
        assert_eq!(read(&little(&[0x61, 0xD83D])), "a\u{FFFD}");
        assert_eq!(read(b"a\0b"), "a\u{FFFD}");
        assert_eq!(read(b"a\0\x3D\xD8\x1F"), "a\u{FFFD}\u{FFFD}");
        assert_eq!(read(b""), "");
    }

    #[test]
    fn a_pair_may_lie_on_both_sides_of_a_buffer() {
        for before in BUFFER / 2 - 3..BUFFER / 2 + 3 {
            let text = "a".repeat(before) + "\u{1F41F}" + &"b".repeat(BUFFER);
            let bytes: Vec<u8> = text.encode_utf16().flat_map(u16::to_be_bytes).collect();
            assert_eq!(read(bytes.as_slice(), u16::from_be_bytes), text);
        }
    }

    proptest! {
        #[test]
        fn text_comes_back(text in any::<String>(), piece in 1..9_usize) {
            let little: Vec<u8> = text.encode_utf16().flat_map(u16::to_le_bytes).collect();
            prop_assert_eq!(read(Drops(&little, piece), u16::from_le_bytes), text);
        }

        #[test]
        fn any_bytes_are_what_the_standard_library_makes_of_them(bytes in prop::collection::vec(any::<u8>(), 0..99), piece in 1..9_usize) {
            let (pairs, odd) = bytes.as_chunks::<2>();
            let units: Vec<u16> = pairs.iter().map(|pair| u16::from_be_bytes(*pair)).collect();
            let mut expected = String::from_utf16_lossy(&units);
            expected.extend(odd.iter().map(|_| char::REPLACEMENT_CHARACTER));
            prop_assert_eq!(read(Drops(&bytes, piece), u16::from_be_bytes), expected);
        }
    }
}
