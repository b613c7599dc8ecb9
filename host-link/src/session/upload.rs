//! An upload as a window over a table: which piece goes next, what an answer proves, when to go back.
//!
//! The robot takes pieces in order, so its one number, the next wanted offset, tells everything. A piece behind a lost one
//! is answered with that number too, which is the signal to go back at once and not to wait for a time-out.

use std::collections::VecDeque;
use std::time::Duration;

/// How far an upload is.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum UploadPhase {
    /// Announcing it.
    Begin,
    /// Sending its pieces.
    Chunks,
    /// Waiting for the robot's check.
    Commit,
}

/// How much of an upload has arrived.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct UploadProgress {
    /// How far it is.
    pub phase: UploadPhase,
    /// Bytes the robot has.
    pub done: usize,
    /// Bytes in all.
    pub total: usize,
}

#[derive(Debug, Clone, Copy)]
struct InFlight {
    sequence: u16,
    /// Offset of the piece.
    start: usize,
    /// Offset behind the piece.
    end: usize,
    /// Bytes on the wire.
    cost: usize,
    sent: Duration,
    /// Sent for the first time: its answer times the round trip.
    fresh: bool,
}

/// The window over one table.
#[derive(Debug)]
pub(crate) struct Window {
    total: usize,
    /// Bytes of a piece.
    piece: usize,
    /// Everything before is on the robot.
    wanted: usize,
    /// Where the next piece starts.
    next: usize,
    /// Furthest offset ever sent.
    furthest: usize,
    in_flight: VecDeque<InFlight>,
    /// Time-outs in a row.
    pub(crate) timeouts: u32,
}

impl Window {
    /// A table of `total` bytes of which the robot wants those from `wanted` on, in pieces of `piece` bytes.
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

    /// Bytes the robot has.
    pub(crate) fn wanted(&self) -> usize {
        self.wanted
    }

    /// All has arrived.
    pub(crate) fn complete(&self) -> bool {
        self.wanted >= self.total
    }

    /// Bytes on their way.
    pub(crate) fn in_flight(&self) -> usize {
        self.in_flight.iter().map(|piece| piece.cost).sum()
    }

    /// The next piece to send, if the table has one left.
    pub(crate) fn next_piece(&self) -> Option<std::ops::Range<usize>> {
        (self.next < self.total).then(|| self.next..self.total.min(self.next + self.piece))
    }

    /// Notes that [`next_piece`](Self::next_piece) was sent. Returns whether it had been sent before.
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

    /// Whether a piece of this number is in flight.
    pub(crate) fn knows(&self, sequence: u16) -> bool {
        self.in_flight
            .iter()
            .any(|piece| piece.sequence == sequence)
    }

    /// The robot answered piece `sequence` with its wanted offset. Where that lies before the piece, one before was lost. A
    /// late answer to a piece already written off still proves what has arrived. Returns the round trip where it can be told.
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
        // Pieces sent before this one were answered before it or will not be: the link keeps order.
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

    /// Starts again from the wanted offset. What is in flight is written off, so its late answers mean nothing.
    pub(crate) fn go_back(&mut self) {
        self.in_flight.clear();
        self.next = self.wanted;
    }

    /// When the oldest piece in flight was sent.
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
        // The first answer was lost; the second covers it.
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
        // Piece 1 is lost: 2, 3 and 4 come behind a gap.
        window.answered(2, 104, NOW);
        assert_eq!(window.next_piece(), Some(104..208));
        let next = send_all(&mut window, 5);
        assert_eq!(next, 9);
        // An answer to the pieces written off goes back no second time.
        assert_eq!(window.answered(3, 104, NOW), None);
        assert_eq!(window.next_piece(), None);
        // A repeat's answer times nothing.
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
