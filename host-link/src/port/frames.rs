//! Splits a stream into frames at their zero bytes, without decoding. Faults and traces act per frame.

/// Largest length without a zero byte; longer data is passed on, so that garbage does not accumulate.
const LONGEST: usize = 512;

/// Collects bytes until a frame is complete.
#[derive(Debug, Default)]
pub(crate) struct FrameCutter {
    partial: Vec<u8>,
}

impl FrameCutter {
    /// Passes each complete frame, with its final zero, to `found`. Leading zeros of a burst are part of the next frame.
    pub(crate) fn push(&mut self, bytes: &[u8], mut found: impl FnMut(&mut Vec<u8>)) {
        for &byte in bytes {
            self.partial.push(byte);
            let closes = byte == 0 && self.partial.iter().any(|&b| b != 0);
            if closes || self.partial.len() >= LONGEST {
                found(&mut self.partial);
                self.partial.clear();
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn cut(chunks: &[&[u8]]) -> Vec<Vec<u8>> {
        let mut cutter = FrameCutter::default();
        let mut frames = Vec::new();
        for chunk in chunks {
            cutter.push(chunk, |frame| frames.push(frame.clone()));
        }
        frames
    }

    #[test]
    fn frames_end_at_zeros_at_any_split() {
        let expected = vec![vec![0, 1, 2, 0], vec![3, 0]];
        assert_eq!(cut(&[&[0, 1, 2, 0, 3, 0, 4]]), expected);
        assert_eq!(cut(&[&[0], &[1], &[2, 0, 3], &[0], &[4]]), expected);
    }

    #[test]
    fn garbage_without_zeros_is_passed_on() {
        assert_eq!(cut(&[&[7; LONGEST + 1]]), vec![vec![7; LONGEST]]);
    }
}
