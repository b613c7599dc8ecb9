//! Sliding window of an upload: next chunk, acknowledgements, and retransmission.
//!
//! The robot accepts chunks in order, so the next expected offset is a cumulative acknowledgement. A chunk after a lost one is
//! answered with the same offset, and the window goes back at once without a time-out (go-back-N).

use std::collections::VecDeque;
use std::time::Duration;

/// Phase of an upload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UploadPhase {
    /// Announcement.
    Begin,
    /// Transfer of the chunks.
    Chunks,
    /// Wait for the robot's check.
    Commit,
}

/// Progress of an upload.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UploadProgress {
    /// Present phase.
    pub phase: UploadPhase,
    /// Bytes that the robot has received.
    pub done: usize,
    /// Total bytes.
    pub total: usize,
}

#[derive(Debug, Clone, Copy)]
struct InFlight {
    sequence: u16,
    /// Offset of the chunk.
    start: usize,
    /// Offset after the chunk.
    end: usize,
    /// Length on the wire, bytes.
    cost: usize,
    sent: Duration,
    /// Sent for the first time, so its reply measures the round trip.
    fresh: bool,
}

/// Sliding window over one table.
#[derive(Debug)]
pub(crate) struct Window {
    total: usize,
    /// Bytes per chunk.
    piece: usize,
    /// Next expected offset of the robot.
    wanted: usize,
    /// Offset of the next chunk.
    next: usize,
    /// Largest offset sent so far.
    furthest: usize,
    in_flight: VecDeque<InFlight>,
    /// Consecutive time-outs.
    pub(crate) timeouts: u32,
}

impl Window {
    /// Window over a table of `total` bytes, of which the robot expects `wanted` next, in chunks of `piece` bytes.
    pub(crate) fn new(total: usize, wanted: usize, piece: usize) -> Self {
        Self {
            total,
            piece: piece.max(1),
            wanted: wanted.min(total),
            next: wanted.min(total),
            furthest: wanted.min(total),
            in_flight: VecDeque::new(),
            timeouts: 0,
        }
    }

    /// Number of bytes that the robot has received.
    pub(crate) fn wanted(&self) -> usize {
        self.wanted
    }

    /// Returns true if all bytes have arrived.
    pub(crate) fn complete(&self) -> bool {
        self.wanted >= self.total
    }

    /// Bytes in flight, on the wire.
    pub(crate) fn in_flight(&self) -> usize {
        self.in_flight.iter().map(|piece| piece.cost).sum()
    }

    /// Next chunk to send, if any remains.
    pub(crate) fn next_piece(&self) -> Option<std::ops::Range<usize>> {
        (self.next < self.total).then(|| self.next..self.total.min(self.next + self.piece))
    }

    /// Records that [`next_piece`](Self::next_piece) was sent. Returns true if it is a repeat.
    pub(crate) fn sent(&mut self, sequence: u16, cost: usize, now: Duration) -> bool {
        let end = self.total.min(self.next + self.piece);
        let fresh = self.next >= self.furthest;
        self.in_flight.push_back(InFlight {
            sequence,
            start: self.next,
            end,
            cost,
            sent: now,
            fresh,
        });
        self.next = end;
        self.furthest = self.furthest.max(end);
        !fresh
    }

    /// Returns true if a chunk of this number is in flight.
    pub(crate) fn knows(&self, sequence: u16) -> bool {
        self.in_flight
            .iter()
            .any(|piece| piece.sequence == sequence)
    }

    /// Handles the reply to chunk `sequence` with the expected offset `wanted`. An offset before the chunk shows a loss. A late
    /// reply still acknowledges bytes. Returns the round trip if it is unambiguous.
    pub(crate) fn answered(
        &mut self,
        sequence: u16,
        wanted: usize,
        now: Duration,
    ) -> Option<Duration> {
        if wanted > self.wanted {
            self.wanted = wanted.min(self.total);
            self.timeouts = 0;
        }
        let place = self
            .in_flight
            .iter()
            .position(|piece| piece.sequence == sequence);
        // Earlier chunks were answered before, or never will be: the link preserves the order.
        let answered = place.and_then(|place| self.in_flight.drain(..=place).next_back());
        self.in_flight.retain(|piece| piece.end > self.wanted);
        if answered.is_some_and(|piece| self.wanted < piece.start) {
            self.go_back();
        }
        self.next = self.next.max(self.wanted);
        answered
            .filter(|piece| piece.fresh)
            .map(|piece| now.saturating_sub(piece.sent))
    }

    /// Restarts at the expected offset. Chunks in flight are written off, so their late replies have no effect.
    pub(crate) fn go_back(&mut self) {
        self.in_flight.clear();
        self.next = self.wanted;
    }

    /// Time at which the oldest chunk in flight was sent.
    pub(crate) fn oldest(&self) -> Option<Duration> {
        self.in_flight.front().map(|piece| piece.sent)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use link_protocol::MAX_CHUNK;

    const NOW: Duration = Duration::from_secs(1);

    fn send_all(window: &mut Window, mut sequence: u16) -> u16 {
        while window.next_piece().is_some() {
            window.sent(sequence, 124, NOW);
            sequence += 1;
        }
        sequence
    }

    #[test]
    fn answers_move_the_window_and_later_ones_include_earlier() {
        let mut window = Window::new(300, 0, MAX_CHUNK);
        send_all(&mut window, 10);
        assert_eq!(window.in_flight(), 3 * 124);
        // The first reply was lost; the second covers it.
        assert_eq!(window.answered(11, 208, NOW), Some(Duration::ZERO));
        assert_eq!(window.in_flight(), 124);
        assert_eq!(window.answered(10, 104, NOW), None);
        assert_eq!(window.wanted(), 208);
        window.answered(12, 300, NOW);
        assert!(window.complete());
    }

    #[test]
    fn a_gap_goes_back_once() {
        let mut window = Window::new(500, 0, MAX_CHUNK);
        send_all(&mut window, 0);
        window.answered(0, 104, NOW);
        // Chunk 1 is lost: 2, 3 and 4 follow a gap.
        window.answered(2, 104, NOW);
        assert_eq!(window.next_piece(), Some(104..208));
        let next = send_all(&mut window, 5);
        assert_eq!(next, 9);
        // A reply to a chunk that was written off does not go back again.
        assert_eq!(window.answered(3, 104, NOW), None);
        assert_eq!(window.next_piece(), None);
        // The reply to a repeat does not measure the round trip.
        assert_eq!(window.answered(8, 500, NOW), None);
        assert!(window.complete());
    }

    #[test]
    fn a_late_answer_saves_sending_again() {
        let mut window = Window::new(500, 0, MAX_CHUNK);
        send_all(&mut window, 0);
        window.go_back();
        assert_eq!(window.next_piece(), Some(0..104));
        window.answered(2, 312, NOW);
        assert_eq!(window.next_piece(), Some(312..416));
    }

    #[test]
    fn resumes_in_the_middle() {
        let window = Window::new(2048, 1040, MAX_CHUNK);
        assert_eq!(window.next_piece(), Some(1040..1144));
        assert!(Window::new(10, 9999, MAX_CHUNK).complete());
    }
}
