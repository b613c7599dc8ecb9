//! Crash note: place and reason of a crash, in memory that a reset preserves. A checksum protects it, because that memory is
//! random after a power cut.

use core::fmt::{self, Write as _};

use heapless::String;
use link_protocol::crc32c;

/// Capacity of the message, bytes, as on the wire.
const ROOM: usize = 96;
/// Longest path in the message, bytes. The end of the path is kept, because it has the file's name.
const PATH: usize = 32;

/// Crash note in memory that no start-up code clears. Any bit pattern is a valid value; the checksum identifies written notes.
///
/// ```
/// use gait_player::CrashNote;
///
/// assert!(CrashNote::panicked("src/main.rs", 7, "no such knot").message().contains("main.rs:7"));
/// ```
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct CrashNote {
    len: u32,
    text: [u8; ROOM],
    crc32: u32,
}

impl CrashNote {
    /// Empty note.
    pub const NONE: Self = Self {
        len: 0,
        text: [0; ROOM],
        crc32: 0,
    };

    /// Note of a panic: `PATH:LINE: MESSAGE`, truncated to the capacity.
    pub fn panicked(file: &str, line: u32, message: impl fmt::Display) -> Self {
        let mut start = file.len().saturating_sub(PATH);
        while !file.is_char_boundary(start) {
            start += 1;
        }
        let tail = file.get(start..).unwrap_or_default();
        // Starts at a whole folder name if there is one.
        let tail = match tail.split_once('/') {
            Some((_, rest)) if start > 0 => rest,
            _ => tail,
        };
        Self::of(format_args!("{tail}:{line}: {message}"))
    }

    /// Note of a hard fault at this address; `caller` is the return address.
    pub fn faulted(address: u32, caller: u32) -> Self {
        Self::of(format_args!(
            "hard fault at {address:#010x}, called from {caller:#010x}"
        ))
    }

    fn of(words: fmt::Arguments<'_>) -> Self {
        let mut text = Cut(String::new());
        // Fails only if a `Display` does; the text up to there is kept.
        let _ = text.write_fmt(words);
        let mut note = Self {
            len: text.0.len() as u32,
            ..Self::NONE
        };
        note.text[..text.0.len()].copy_from_slice(text.0.as_bytes());
        note.crc32 = note.checksum();
        note
    }

    /// The message; empty if no note was written.
    pub fn message(&self) -> String<ROOM> {
        let bytes = self.text.get(..self.len as usize).unwrap_or_default();
        if self.crc32 != self.checksum() {
            return String::new();
        }
        core::str::from_utf8(bytes)
            .ok()
            .and_then(|text| String::try_from(text).ok())
            .unwrap_or_default()
    }

    /// Checksum of length and text. It is never 0, so cleared memory is no valid note.
    fn checksum(&self) -> u32 {
        let mut bytes = [0; ROOM + 4];
        bytes[..ROOM].copy_from_slice(&self.text);
        bytes[ROOM..].copy_from_slice(&self.len.to_le_bytes());
        crc32c(&bytes).max(1)
    }
}

/// Writer that truncates at the capacity.
struct Cut(String<ROOM>);

impl fmt::Write for Cut {
    fn write_str(&mut self, text: &str) -> fmt::Result {
        for letter in text.chars() {
            if self.0.push(letter).is_err() {
                break;
            }
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    #[test]
    fn a_panic_is_told_with_its_place() {
        let note = CrashNote::panicked("gait-player/src/brain/motion.rs", 97, "no table");
        assert_eq!(
            note.message(),
            "gait-player/src/brain/motion.rs:97: no table"
        );
        let file = "/home/somebody/.cargo/registry/src/index-0123/embassy-rp-0.10.0/src/flash.rs";
        let note = CrashNote::panicked(file, 7, format_args!("{} of {}", 3, 2));
        assert_eq!(note.message(), "embassy-rp-0.10.0/src/flash.rs:7: 3 of 2");
        assert_eq!(
            CrashNote::faulted(0x1000_0d24, 0x1000_0101).message(),
            "hard fault at 0x10000d24, called from 0x10000101"
        );
    }

    proptest! {
        #[test]
        fn any_text_comes_back_as_far_as_it_fits(file in "\\PC{0,80}", line: u32, message in "\\PC{0,200}") {
            let message_text = CrashNote::panicked(&file, line, &message).message();
            let whole = format!(":{line}: {message}");
            let shown = message_text.find(&whole[..whole.floor_char_boundary(9)]);
            prop_assert!(shown.is_some() || message_text.len() + 4 > ROOM, "{message_text}");
        }

        /// Random memory is no message, and neither is a message with a flipped bit.
        #[test]
        fn noise_is_no_message(len: u32, text in prop::array::uniform32(any::<u8>()), crc32: u32, bit in 0..(32_usize * 8)) {
            let mut noise = CrashNote { len, crc32, ..CrashNote::NONE };
            noise.text[..32].copy_from_slice(&text);
            prop_assert!(noise.message().is_empty());
            let mut note = CrashNote::of(format_args!("a note of forty letters, and of four more"));
            note.text[bit / 8] ^= 1 << (bit % 8);
            prop_assert!(note.message().is_empty());
        }
    }

    #[test]
    fn cleared_memory_is_no_message() {
        assert_eq!(CrashNote::NONE.message(), "");
    }
}
