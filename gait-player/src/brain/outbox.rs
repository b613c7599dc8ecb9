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
