//! Expected duration of an upload on a link without faults, as shown to the operator in advance.

use std::collections::VecDeque;
use std::time::Duration;

use super::drive::CHUNK_COST;
use super::{Link, Session};

/// Time of the robot's check of a full table at rest, including its ticks and the waits between.
const CHECK: Duration = Duration::from_millis(130);

impl Session {
    /// Expected time from the request for an upload of `bytes` until the check has passed, without losses, while the robot is
    /// at rest: announcement, chunks, commit. Returns `None` without a session.
    pub fn expected_upload(&self, bytes: usize) -> Option<Duration> {
        let Link::Open(hello) = &self.link else {
            return None;
        };
        let trip = self.trip.assumed();
        let window = hello.limits.upload_window.min(hello.buffer);
        let pieces = Pieces {
            count: bytes.div_ceil(self.piece()),
            each: Duration::from_secs_f64(
                CHUNK_COST as f64 / self.config.bytes_per_second.max(1.0),
            ),
            at_once: usize::from(window) / CHUNK_COST,
        };
        Some(trip + pieces.expected(trip) + trip + CHECK)
    }
}

/// Chunks of a table on the line.
#[derive(Debug, Clone, Copy)]
struct Pieces {
    count: usize,
    /// Time of one chunk on the line.
    each: Duration,
    /// Number of chunks that fit the robot's buffer.
    at_once: usize,
}

impl Pieces {
    /// Time from the first byte of the first chunk to the reply to the last one.
    fn expected(self, trip: Duration) -> Duration {
        let mut unanswered = VecDeque::new();
        let mut line_free = Duration::ZERO;
        for _ in 0..self.count {
            let room = if unanswered.len() < self.at_once.max(1) {
                None
            } else {
                unanswered.pop_front()
            };
            line_free = line_free.max(room.unwrap_or_default()) + self.each;
            unanswered.push_back(line_free + trip);
        }
        unanswered.back().copied().unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn a_quick_line_is_filled_and_a_slow_one_waits_for_answers() {
        let pieces = Pieces {
            count: 20,
            each: MS * 10,
            at_once: 8,
        };
        assert_eq!(pieces.expected(MS * 20), MS * 220);
        // Eight, eight and four: the last ones wait for two replies.
        assert_eq!(pieces.expected(MS * 1000), MS * (3 * 1010 + 3 * 10));
        let one_by_one = Pieces {
            at_once: 0,
            ..pieces
        };
        assert_eq!(one_by_one.expected(MS * 90), MS * 2000);
        assert_eq!(Pieces { count: 0, ..pieces }.expected(MS), Duration::ZERO);
    }
}
