//! What a UART makes of a line that does not carry what it expects: another baud rate, a bit that is not where it should be.

/// A character as a UART hears it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Character {
    /// Its eight bits.
    pub byte: u8,
    /// No stop bit where one should be: a framing error.
    pub framing: bool,
    /// Nothing but zeros, the stop bit too: a break.
    pub silent: bool,
}

impl Character {
    /// A whole one.
    pub fn whole(byte: u8) -> Self {
        Self {
            byte,
            framing: false,
            silent: false,
        }
    }

    /// With the error bits of the PL011's data register.
    pub(crate) fn data_register(self) -> u16 {
        u16::from(self.byte) | u16::from(self.framing) << 8 | u16::from(self.silent) << 10
    }
}

/// Bits of a character on the line: a start bit, eight of data, a stop bit.
const BITS: f64 = 10.0;

/// What a receiver at `heard_baud` hears of `bytes` that are sent without a pause at `sent_baud`. It waits for the line to
/// fall, looks at the middle of each bit to come, and waits again.
pub fn heard(bytes: &[u8], sent_baud: f64, heard_baud: f64) -> Vec<Character> {
    let end = BITS * bytes.len() as f64 / sent_baud;
    let high = |time: f64| line(bytes, time * sent_baud);
    // The line may only change at the sender's bits: looking a little after each of them misses no edge.
    let sender_bit = 1.0 / sent_baud;
    let (mut characters, mut time, mut was_high) = (Vec::new(), 0.0, true);
    while time < end {
        let is_high = high(time + 1e-6 * sender_bit);
        if !was_high || is_high {
            was_high = is_high;
            time = ((time * sent_baud + 1e-3).floor() + 1.0) / sent_baud;
            continue;
        }
        let bit = |number: u32| high(time + (f64::from(number) + 0.5) / heard_baud);
        let byte = (0..8).fold(0, |byte, data| byte | u8::from(bit(data + 1)) << data);
        let stop = bit(9);
        characters.push(Character {
            byte,
            framing: !stop,
            silent: !stop && byte == 0,
        });
        time += 9.5 / heard_baud;
        was_high = stop;
    }
    characters
}

/// The line's level so many of the sender's bits after the start: idle is high.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // counts of bits
fn line(bytes: &[u8], bits: f64) -> bool {
    let bit = bits as usize;
    let Some(byte) = bytes.get(bit / 10) else {
        return true;
    };
    match bit % 10 {
        0 => false,
        9 => true,
        data => byte >> (data - 1) & 1 == 1,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn all_bytes() -> Vec<u8> {
        (0..=255).collect()
    }

    #[test]
    fn the_right_rate_is_understood_and_so_are_two_percent_off() {
        let whole: Vec<_> = all_bytes().into_iter().map(Character::whole).collect();
        for percent in [-2.0, 0.0, 2.0] {
            let rate = 115_200.0 * (1.0 + percent / 100.0);
            assert_eq!(heard(&all_bytes(), rate, 115_200.0), whole, "{percent} %");
        }
    }

    #[test]
    fn half_the_rate_doubles_every_bit() {
        // 0x55 alternates: start 0, then 1 0 1 0 1 0 1 0, stop 1; heard at twice the rate each level counts twice.
        let heard = heard(&[0x55], 57_600.0, 115_200.0);
        assert_eq!(heard[0].byte, 0b0110_0110);
        assert!(heard[0].framing, "{heard:?}");
    }

    #[test]
    fn a_slow_zero_is_a_break() {
        let heard = heard(&[0], 9_600.0, 115_200.0);
        assert_eq!((heard.len(), heard[0].silent), (1, true), "{heard:?}");
    }

    #[test]
    fn another_rate_is_not_understood() {
        for rate in [9_600.0, 38_400.0, 57_600.0, 230_400.0] {
            let whole = heard(&all_bytes(), rate, 115_200.0)
                .iter()
                .zip(all_bytes())
                .filter(|(character, byte)| **character == Character::whole(*byte))
                .count();
            assert!(whole < 8, "{rate}: {whole}");
        }
    }
}
