//! Serial receiver at a wrong baud rate: it finds a falling edge and samples by its own clock. The simulation is bit by bit,
//! because the resulting noise is not random: zeros, which are frame ends, are common.

/// Bits of a byte on the line: start, eight data, stop.
const BITS: u64 = 10;

/// Character as decoded by a serial receiver.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Character {
    /// Its eight data bits.
    pub byte: u8,
    /// The stop bit is missing: a framing error.
    pub framing: bool,
    /// All bits are zero, including the stop bit: a break.
    pub silent: bool,
}

/// Bytes decoded by a receiver at `read_baud` from `bytes` sent at `sent_baud`. Bytes with a framing error are dropped, as a
/// driver does.
pub(crate) fn misread(bytes: &[u8], sent_baud: u32, read_baud: u32) -> Vec<u8> {
    heard(bytes, sent_baud, read_baud)
        .into_iter()
        .filter_map(|heard| (!heard.framing).then_some(heard.byte))
        .collect()
}

/// Characters decoded by a receiver at `read_baud` from `bytes` sent at `sent_baud`, with an idle line before and after.
pub fn heard(bytes: &[u8], sent_baud: u32, read_baud: u32) -> Vec<Character> {
    let (sent, read) = (u64::from(sent_baud.max(1)), u64::from(read_baud.max(1)));
    // Time unit: a sent bit takes 2 * `read` and a read bit 2 * `sent`, so that halves are integers.
    let (sent_bit, read_bit) = (2 * read, 2 * sent);
    let end = bytes.len() as u64 * BITS * sent_bit;
    let level = |time: u64| {
        let bit = time / sent_bit;
        let Some(byte) = usize::try_from(bit / BITS)
            .ok()
            .and_then(|place| bytes.get(place))
        else {
            return true;
        };
        match bit % BITS {
            0 => false,
            9 => true,
            data => byte >> (data - 1) & 1 != 0,
        }
    };
    let mut heard = Vec::new();
    let mut time = 0;
    while time < end {
        if level(time) {
            // To the next edge.
            time = (time / sent_bit + 1) * sent_bit;
            continue;
        }
        let sample = |bit: u64| level(time + bit * read_bit + read_bit / 2);
        if sample(0) {
            // Too short for a start bit.
            time = (time / sent_bit + 1) * sent_bit;
            continue;
        }
        let byte = (0..8).fold(0, |byte, bit| byte | u8::from(sample(bit + 1)) << bit);
        let framing = !sample(9);
        heard.push(Character {
            byte,
            framing,
            silent: framing && byte == 0,
        });
        // The receiver searches the next edge from the middle of the stop bit; a low line must rise first.
        time += 9 * read_bit + read_bit / 2;
        while time < end && !level(time) {
            time = (time / sent_bit + 1) * sent_bit;
        }
    }
    heard
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_same_rate_and_one_within_a_few_percent_read_every_byte() {
        let every: Vec<u8> = (0..=255).collect();
        for rate in [115_200, 112_000, 118_000] {
            assert_eq!(misread(&every, 115_200, rate), every, "{rate}");
        }
    }

    #[test]
    fn half_the_rate_reads_known_noise() {
        // 0x00 is low for nine bits; the receiver samples its data after 3, 5, 7 (low), 9 and more of them (high).
        assert_eq!(misread(&[0x00], 115_200, 57_600), [0xF8]);
        // Twice the rate: each bit is read twice, and a line that is low for 18 receiver bits has no stop bit.
        assert_eq!(misread(&[0x00], 115_200, 230_400), Vec::<u8>::new());
        assert_eq!(misread(&[0xFF], 115_200, 230_400), [0xFE]);
    }

    #[test]
    fn a_slow_zero_is_a_break() {
        let heard = heard(&[0], 9_600, 115_200);
        assert!(heard.len() == 1 && heard[0].silent, "{heard:?}");
    }

    #[test]
    fn every_rate_ends_and_none_reads_more_than_it_can() {
        let every: Vec<u8> = (0..=255).collect();
        for rate in [300, 9600, 19_200, 38_400, 230_400, 921_600, 4_000_000] {
            let heard = misread(&every, 115_200, rate).len() as u64;
            let most = 256 * u64::from(rate) / 115_200 + 1;
            assert!(heard <= most.min(2560), "{rate}: {heard}");
        }
    }
}
