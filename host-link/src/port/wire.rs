//! Timing of a serial line: ten bit times per byte, in sequence, then the latency of the modules between.

use std::collections::VecDeque;
use std::time::Duration;

/// Speed of one direction of a line.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct WireSpeed {
    /// Bits per second; a byte takes ten of them (start, eight data, stop).
    pub baud: u32,
    /// Latency after the last bit has left.
    pub latency: Duration,
}

impl WireSpeed {
    /// Line of the robot: 115 200 baud and 5 ms for the module.
    pub fn robot() -> Self {
        Self {
            baud: 115_200,
            latency: Duration::from_millis(5),
        }
    }

    /// Line with a Bluetooth 2.0 module (HC-05), by design values: the serial ends run at 115 200 baud, the radio passes 5 kB/s
    /// and takes 25 ms. Lumps of 230 bytes towards the host are modelled as a fault (`testing::Faults::clump`).
    pub fn hc05() -> Self {
        Self {
            baud: 50_000,
            latency: Duration::from_millis(25),
        }
    }

    /// Duration of one byte on the line.
    pub fn byte_time(&self) -> Duration {
        Duration::from_nanos(10_000_000_000 / u64::from(self.baud.max(1)))
    }
}

/// One direction of a serial line.
#[derive(Debug)]
pub struct Wire {
    speed: WireSpeed,
    /// Time at which the line is idle again.
    free_at: Duration,
    under_way: VecDeque<(Duration, u8)>,
}

impl Wire {
    /// Returns an idle line.
    pub fn new(speed: WireSpeed) -> Self {
        Self {
            speed,
            free_at: Duration::ZERO,
            under_way: VecDeque::new(),
        }
    }

    /// Appends bytes at `now`; they follow the bytes already on the line.
    pub fn push(&mut self, now: Duration, bytes: &[u8]) {
        let byte_time = self.speed.byte_time();
        self.free_at = self.free_at.max(now);
        for &byte in bytes {
            self.free_at += byte_time;
            self.under_way
                .push_back((self.free_at + self.speed.latency, byte));
        }
    }

    /// Number of further bytes that the line can start to send by `until`.
    pub fn room(&self, until: Duration) -> usize {
        let free = until.saturating_sub(self.free_at).as_nanos();
        usize::try_from(free.div_ceil(self.speed.byte_time().as_nanos().max(1)))
            .unwrap_or(usize::MAX)
    }

    /// Latency of a byte after its last bit has left.
    pub fn latency(&self) -> Duration {
        self.speed.latency
    }

    /// Arrival time of the next byte.
    pub fn next_arrival(&self) -> Option<Duration> {
        self.under_way.front().map(|(at, _)| *at)
    }

    /// Appends the bytes that have arrived by `now` to `out`.
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
