//! Counter of consecutive runs of less than a minute (promise R8). The chip cannot distinguish a supply dip from switching off:
//! a servo that pulls the supply down restarts the robot repeatedly, and only a counter reveals it.
//!
//! A run counts as short from its start until it has lasted a minute, so every early end is counted.

use link_protocol::crc32c;

const MAGIC: [u8; 4] = *b"RUNS";

/// Record that survives a start: in RAM that resets preserve, and in flash for power cuts.
///
/// ```
/// use gait_player::ShortStarts;
///
/// let starts = ShortStarts { runs: 2 };
/// assert_eq!(ShortStarts::decode(&starts.encode()), Some(starts));
/// assert_eq!(ShortStarts::decode(&[0; ShortStarts::LEN]), None);
/// ```
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct ShortStarts {
    /// Number of consecutive short runs. The present run counts until it has lasted a minute.
    pub runs: u8,
}

impl ShortStarts {
    /// Bytes of the record.
    pub const LEN: usize = 12;
    /// Number of short runs in a row that locks arming.
    pub const MOST: u8 = 3;

    /// Encodes the record: magic, count, CRC-32C of both.
    pub fn encode(self) -> [u8; Self::LEN] {
        let [m0, m1, m2, m3] = MAGIC;
        let covered = [m0, m1, m2, m3, self.runs, 0, 0, 0];
        let mut bytes = [0; Self::LEN];
        bytes[..8].copy_from_slice(&covered);
        bytes[8..].copy_from_slice(&crc32c(&covered).to_le_bytes());
        bytes
    }

    /// Decodes a record. Returns `None` if the bytes are invalid, such as RAM after power-on.
    pub fn decode(bytes: &[u8; Self::LEN]) -> Option<Self> {
        let record = Self { runs: bytes[4] };
        (record.encode() == *bytes).then_some(record)
    }

    /// Record after one more start.
    pub(crate) fn start(self) -> Self {
        Self {
            runs: self.runs.saturating_add(1),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    proptest! {
        #[test]
        fn a_record_comes_back_and_no_other_bytes_are_one(runs: u8, noise: [u8; ShortStarts::LEN], bit in 0..8 * ShortStarts::LEN) {
            let record = ShortStarts { runs };
            let mut bytes = record.encode();
            prop_assert_eq!(ShortStarts::decode(&bytes), Some(record));
            bytes[bit / 8] ^= 1 << (bit % 8);
            prop_assert_eq!(ShortStarts::decode(&bytes), None);
            prop_assert_eq!(ShortStarts::decode(&noise), None);
        }
    }

    #[test]
    fn cleared_and_erased_memory_is_no_record() {
        for byte in [0, 0xFF] {
            assert_eq!(ShortStarts::decode(&[byte; ShortStarts::LEN]), None);
        }
    }
}
