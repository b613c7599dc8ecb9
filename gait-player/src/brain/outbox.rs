//! Bytes on their way out, frame by frame: a frame that finds no room is dropped whole and counted.

use heapless::Deque;
use link_protocol::{EncodeError, Header, Kind, MAX_ENCODED, Message, encode, encode_body};

/// Bytes that wait at most. Replies are few, telemetry yields to them.
const ROOM: usize = 640;
/// Everything leaves so much room for answers to stops, four of them: whatever floods the robot, a stop that acted is
/// acknowledged.
const STOPS_LEFT: usize = 4 * 14;
/// Telemetry leaves so much room for replies.
const TELEMETRY_LEAVES: usize = 2 * MAX_ENCODED;
/// Bytes that may leave in one tick, and so a second: 5 kB/s.
const BYTES_A_TICK: usize = 100;
/// Telemetry may save up so much.
const MAX_SAVED: usize = 3 * MAX_ENCODED;

/// Bytes on their way out.
#[derive(Clone)]
pub(crate) struct Outbox {
    bytes: Deque<u8, ROOM>,
    saved: usize,
    dropped: u32,
}

impl Outbox {
    pub(crate) const fn new() -> Self {
        Self {
            bytes: Deque::new(),
            saved: 0,
            dropped: 0,
        }
    }

    /// Frames that found no room.
    pub(crate) fn dropped(&self) -> u32 {
        self.dropped
    }

    /// A tick's worth of bytes may be spent.
    pub(crate) fn tick(&mut self) {
        self.saved = (self.saved + BYTES_A_TICK).min(MAX_SAVED);
    }

    /// Sends a message.
    pub(crate) fn send(&mut self, header: Header, message: &Message) {
        let mut frame = [0; MAX_ENCODED];
        let encoded = encode(header, message, &mut frame);
        self.push(encoded, &frame, STOPS_LEFT);
    }

    /// Sends the answer to a stop, which takes the room that all else leaves.
    pub(crate) fn send_stop_answer(&mut self, header: Header, message: &Message) {
        let mut frame = [0; MAX_ENCODED];
        let encoded = encode(header, message, &mut frame);
        self.push(encoded, &frame, 0);
    }

    /// Sends telemetry where the link has room for it.
    pub(crate) fn send_telemetry(&mut self, header: Header, message: &Message) {
        let mut frame = [0; MAX_ENCODED];
        let encoded = encode(header, message, &mut frame);
        if encoded.is_ok_and(|len| len <= self.saved) {
            self.push(encoded, &frame, TELEMETRY_LEAVES);
        }
    }

    /// Sends a reply whose body is stored.
    pub(crate) fn send_reply_body(&mut self, header: Header, body: &[u8]) {
        let mut frame = [0; MAX_ENCODED];
        let encoded = encode_body(header, Kind::Reply as u8, body, None, &mut frame);
        self.push(encoded, &frame, STOPS_LEFT);
    }

    fn push(&mut self, encoded: Result<usize, EncodeError>, frame: &[u8], leave: usize) {
        match encoded {
            Ok(len) if self.bytes.len() + len + leave <= ROOM => {
                self.bytes.extend(frame[..len].iter().copied());
                self.saved = self.saved.saturating_sub(len);
            }
            _ => self.dropped = self.dropped.wrapping_add(1),
        }
    }

    /// Takes bytes to be sent.
    pub(crate) fn take(&mut self, out: &mut [u8]) -> usize {
        let mut taken = 0;
        for place in out {
            let Some(byte) = self.bytes.pop_front() else {
                break;
            };
            *place = byte;
            taken += 1;
        }
        taken
    }

    /// Nobody listens: what waits is old by the time somebody does.
    pub(crate) fn clear(&mut self) {
        self.bytes.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use link_protocol::{MAX_BODY, Reply};

    fn header() -> Header {
        Header::new(u16::MAX, u16::MAX)
    }

    /// Takes all that waits; how many bytes it was.
    fn waiting(outbox: &mut Outbox) -> usize {
        outbox.take(&mut [0; 2 * ROOM])
    }

    /// Sends until one finds no room.
    fn fill(outbox: &mut Outbox, send: impl Fn(&mut Outbox)) {
        let full = (0..=ROOM).any(|_| {
            send(outbox);
            outbox.dropped() > 0
        });
        assert!(full, "it takes more than there is room for");
    }

    #[test]
    fn four_answers_to_stops_find_room_whatever_floods_the_rest() {
        for len in 1..=MAX_BODY {
            let mut outbox = Outbox::new();
            fill(&mut outbox, |outbox| {
                outbox.send_reply_body(header(), &[0xA5; MAX_BODY][..len]);
            });
            for _ in 0..4 {
                outbox.send_stop_answer(header(), &Message::Reply(Reply::Done));
            }
            assert_eq!(outbox.dropped(), 1, "among replies of {len} bytes");
        }
    }

    #[test]
    fn telemetry_leaves_room_for_two_of_the_longest_replies() {
        let mut outbox = Outbox::new();
        fill(&mut outbox, |outbox| {
            outbox.tick();
            outbox.send_telemetry(header(), &Message::KeepAlive);
        });
        // Room that telemetry leaves, less what answers to stops need of it.
        let longest = MAX_BODY - STOPS_LEFT / 2;
        for _ in 0..2 {
            outbox.send_reply_body(header(), &[0xA5; MAX_BODY][..longest]);
        }
        assert_eq!(outbox.dropped(), 1);
    }

    #[test]
    fn telemetry_goes_at_the_links_pace_and_saves_up_little() {
        let message = Message::KeepAlive;
        let mut outbox = Outbox::new();
        outbox.send_telemetry(header(), &message);
        assert_eq!(waiting(&mut outbox), 0, "nothing is saved yet");
        // Shut up for a minute, then all at once: no more than a few frames come.
        (0..3_000).for_each(|_| outbox.tick());
        let mut burst = 0;
        for _ in 0..200 {
            outbox.send_telemetry(header(), &message);
            burst += waiting(&mut outbox);
        }
        assert!(
            (2 * MAX_ENCODED..=3 * MAX_ENCODED).contains(&burst),
            "{burst}"
        );
        // From then on 5 kB/s: 100 bytes a tick.
        let mut sent = 0;
        for _ in 0..1_000 {
            outbox.tick();
            for _ in 0..200 {
                outbox.send_telemetry(header(), &message);
                sent += waiting(&mut outbox);
            }
        }
        assert!((99_000..=100_100).contains(&sent), "{sent}");
    }
}
