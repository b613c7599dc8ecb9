//! How long bytes take on a serial line: ten bit times each, one after the other, and then the latency of what is between.

use std::collections::VecDeque;
use std::time::Duration;

/// Speed of one direction of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WireSpeed {
    /// Bits per second; a byte takes ten of them (start, eight data, stop).
    pub baud: u32,
    /// Travel time after the last bit has left.
    pub latency: Duration,
}

impl WireSpeed {
    /// The robot's line: 115 200 baud and 5 ms for the module between.
    pub fn robot() -> Self {
        Self {
            baud: 115_200,
            latency: Duration::from_millis(5),
        }
    }

    /// A line with a Bluetooth 2.0 module (HC-05) in it, as it is planned for: the serial ends run at 115 200 baud, the
    /// radio between them passes 5 kB/s and takes 25 ms. That it hands bytes to the host in lumps of 230 is a fault
    /// (`testing::Faults::clump`).
    pub fn hc05() -> Self {
        Self {
            baud: 50_000,
            latency: Duration::from_millis(25),
        }
    }

    /// Time one byte occupies the line.
    pub fn byte_time(&self) -> Duration {
        Duration::from_nanos(10_000_000_000 / u64::from(self.baud.max(1)))
    }
}

/// One direction of a serial line.
#[derive(Debug)]
pub struct Wire {
    speed: WireSpeed,
    /// When the line has finished with everything put on it so far.
    free_at: Duration,
    under_way: VecDeque<(Duration, u8)>,
}

impl Wire {
    /// An idle line.
    pub fn new(speed: WireSpeed) -> Self {
        Self {
            speed,
            free_at: Duration::ZERO,
            under_way: VecDeque::new(),
        }
    }

    /// Puts bytes on the line at `now`; they queue behind those already on it.
    pub fn push(&mut self, now: Duration, bytes: &[u8]) {
        let byte_time = self.speed.byte_time();
        self.free_at = self.free_at.max(now);
        for &byte in bytes {
            self.free_at += byte_time;
            self.under_way
                .push_back((self.free_at + self.speed.latency, byte));
        }
    }

    /// Bytes that the line can have begun to carry by `until`, besides those already on it.
    pub fn room(&self, until: Duration) -> usize {
        let free = until.saturating_sub(self.free_at).as_nanos();
        usize::try_from(free.div_ceil(self.speed.byte_time().as_nanos().max(1)))
            .unwrap_or(usize::MAX)
    }

    /// Travel time of a byte after its last bit has left.
    pub fn latency(&self) -> Duration {
        self.speed.latency
    }

    /// When the next byte arrives.
    pub fn next_arrival(&self) -> Option<Duration> {
        self.under_way.front().map(|(at, _)| *at)
    }

    /// Appends to `out` the bytes that have arrived by `now`.
    pub fn pop(&mut self, now: Duration, out: &mut Vec<u8>) {
        while let Some((at, byte)) = self.under_way.front()
            && *at <= now
        {
            out.push(*byte);
            self.under_way.pop_front();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn two_kilobytes_take_their_time_at_115200_baud() {
        let mut wire = Wire::new(WireSpeed::robot());
        wire.push(Duration::from_secs(1), &[7; 1152]);
        wire.push(Duration::from_secs(1), &[7; 1152]);
        let mut out = Vec::new();
        wire.pop(Duration::from_millis(1205), &mut out);
        assert_eq!(out.len(), 2304);
        let mut wire = Wire::new(WireSpeed::robot());
        wire.push(Duration::ZERO, &[1, 2]);
        assert_eq!(
            wire.next_arrival(),
            Some(Duration::from_nanos(86_805) + Duration::from_millis(5))
        );
    }
}
