//! Transmit queue of a port: whole frames in order, with priority for stops.
//!
//! ```text
//!  frames ──► [waiting, bounded] ──┐
//!                                  ├─► [frame being sent] ──► port.write_ready
//!  Stop, EStop ──► [stop lane] ────┘         a stop discards what waits, here and in the port
//! ```
//!
//! The queue never waits. If the port is slower than the producer, frames are dropped, as a full buffer on a link does.

use std::collections::VecDeque;
use std::io;
use std::time::Duration;

use link_protocol::{Decoder, Message};

use super::FrameCutter;
use super::Port;

/// Capacity, bytes; further frames are dropped.
const MOST_WAITING: usize = 8192;
/// Most queued stops; more have no effect.
const MOST_STOPS: usize = 8;
/// Lead of a paced line: bounds the bytes in the port's own buffer.
const AHEAD: Duration = Duration::from_millis(20);

/// Transmit queue of a port.
#[derive(Debug, Default)]
pub struct SendQueue {
    cutter: FrameCutter,
    decoder: Decoder,
    /// Frame in transmission: the bytes that the port has not accepted yet.
    current: Vec<u8>,
    current_is_stop: bool,
    stops: VecDeque<Vec<u8>>,
    waiting: VecDeque<Vec<u8>>,
    waiting_bytes: usize,
    /// Bytes per second of the line; `None` if the producer paces itself.
    pace: Option<f64>,
    /// Time at which a paced line has sent its bytes.
    line_free: Duration,
    /// Other bytes were passed to the port since the last stop.
    others_ahead: bool,
    /// A stop was queued: unsent bytes of the port are to be discarded.
    discard: bool,
    /// Time since which the port has accepted nothing.
    stuck_since: Option<Duration>,
    dropped: u64,
}

impl SendQueue {
    /// Returns a queue that passes at most this many bytes per second to the port.
    pub fn paced(bytes_per_second: f64) -> Self {
        Self {
            pace: Some(bytes_per_second.max(1.0)),
            ..Self::default()
        }
    }

    /// Appends frames, in any split. A stop replaces everything that waits. Returns true if there was one.
    pub fn push(&mut self, bytes: &[u8]) -> bool {
        let mut frames = Vec::new();
        self.cutter
            .push(bytes, |frame| frames.push(std::mem::take(frame)));
        let mut any_stop = false;
        for frame in frames {
            if self.is_stop(&frame) {
                any_stop = true;
                self.push_stop(frame);
            } else if self.waiting_bytes + frame.len() <= MOST_WAITING {
                self.waiting_bytes += frame.len();
                self.waiting.push_back(frame);
            } else {
                self.dropped += 1;
            }
        }
        any_stop
    }

    /// Passes as many bytes to the port as it accepts now.
    ///
    /// # Errors
    /// The port's error.
    pub fn drive(&mut self, port: &mut (impl Port + ?Sized)) -> io::Result<()> {
        let now = port.now();
        if std::mem::take(&mut self.discard) {
            port.discard_unsent();
            self.others_ahead = false;
        }
        loop {
            if self.current.is_empty() {
                match self.next(now) {
                    Some(frame) => self.current = frame,
                    None => break,
                }
            }
            let count = port.write_ready(&self.current)?;
            if count == 0 {
                self.stuck_since.get_or_insert(now);
                return Ok(());
            }
            self.current.drain(..count.min(self.current.len()));
            self.stuck_since = None;
        }
        Ok(())
    }

    /// Returns true if nothing waits.
    pub fn is_empty(&self) -> bool {
        self.current.is_empty() && self.stops.is_empty() && self.waiting.is_empty()
    }

    /// Duration for which the port has accepted nothing, at `now` on its clock.
    pub fn stuck_for(&self, now: Duration) -> Duration {
        self.stuck_since
            .map_or(Duration::ZERO, |since| now.saturating_sub(since))
    }

    /// Number of frames dropped because the port was too slow.
    pub fn dropped(&self) -> u64 {
        self.dropped
    }

    fn next(&mut self, now: Duration) -> Option<Vec<u8>> {
        self.current_is_stop = !self.stops.is_empty();
        if let Some(stop) = self.stops.pop_front() {
            return Some(stop);
        }
        if self.pace.is_some() && self.line_free > now + AHEAD {
            return None;
        }
        let frame = self.waiting.pop_front()?;
        self.waiting_bytes -= frame.len();
        self.others_ahead = true;
        if let Some(pace) = self.pace {
            let takes = Duration::from_secs_f64(frame.len() as f64 / pace);
            self.line_free = self.line_free.max(now) + takes;
        }
        Some(frame)
    }

    fn push_stop(&mut self, mut frame: Vec<u8>) {
        self.dropped += self.waiting.len() as u64;
        self.waiting.clear();
        self.waiting_bytes = 0;
        self.discard |= self.others_ahead;
        if !self.current_is_stop {
            // The current frame is cut off here; the zero before the stop terminates it for the robot.
            self.current.clear();
            if frame.first() != Some(&0) {
                frame.insert(0, 0);
            }
        }
        if self.stops.contains(&frame) {
            return;
        }
        if self.stops.len() >= MOST_STOPS {
            self.stops.pop_front();
        }
        self.stops.push_back(frame);
    }

    fn is_stop(&mut self, frame: &[u8]) -> bool {
        frame.iter().any(|&byte| {
            self.decoder.push(byte).is_some_and(|received| {
                matches!(received.message, Ok(Message::Request(request)) if request.is_stop())
            })
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use link_protocol::{Header, MAX_ENCODED, Request, encode};

    /// Port that accepts `room` bytes and then none. Accepted bytes that are not sent can be discarded.
    #[derive(Default)]
    struct SlowPort {
        room: usize,
        unsent: Vec<u8>,
        now: Duration,
    }

    impl Port for SlowPort {
        fn read(&mut self, _buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
            self.now += timeout;
            Ok(0)
        }

        fn write(&mut self, _bytes: &[u8]) -> io::Result<()> {
            panic!("a queue never waits")
        }

        fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
            let count = bytes.len().min(self.room - self.unsent.len());
            self.unsent.extend_from_slice(&bytes[..count]);
            Ok(count)
        }

        fn discard_unsent(&mut self) {
            self.unsent.clear();
        }

        fn now(&self) -> Duration {
            self.now
        }
    }

    fn frame(sequence: u16, request: Request) -> Vec<u8> {
        let mut bytes = [0; MAX_ENCODED];
        let message = Message::Request(request);
        let len = encode(Header::new(7, sequence), &message, &mut bytes).unwrap();
        bytes[..len].to_vec()
    }

    /// Decodes the requests in these bytes.
    fn heard(bytes: &[u8]) -> Vec<Request> {
        let mut decoder = Decoder::new();
        let received = bytes.iter().filter_map(|byte| decoder.push(*byte));
        received
            .filter_map(|received| match received.message {
                Ok(Message::Request(request)) => Some(request),
                _ => None,
            })
            .collect()
    }

    #[test]
    fn a_stop_passes_frames_that_wait_and_those_in_the_port() {
        for room in [0, 1, 5, 40, 64] {
            let mut port = SlowPort {
                room: room.max(64),
                ..SlowPort::default()
            };
            let mut queue = SendQueue::default();
            for sequence in 0..20_000 {
                assert!(!queue.push(&frame(sequence, Request::Status)));
                queue.drive(&mut port).unwrap();
            }
            assert!(queue.waiting_bytes <= MOST_WAITING && queue.dropped() > 0);
            assert!(queue.push(&frame(9, Request::EStop)));
            queue.drive(&mut port).unwrap();
            assert_eq!(heard(&port.unsent), [Request::EStop], "room {room}");
            assert!(queue.is_empty());
        }
    }

    /// Without discarding, part of a frame is already in the port: the stop after it is still decoded.
    #[test]
    fn a_stop_is_heard_behind_part_of_a_frame() {
        let long = frame(1, Request::Status);
        for taken in 1..long.len() - 1 {
            let mut port = SlowPort {
                room: taken,
                ..SlowPort::default()
            };
            let mut queue = SendQueue::default();
            queue.push(&long);
            queue.push(&long);
            queue.drive(&mut port).unwrap();
            let mut sent = std::mem::take(&mut port.unsent);
            port.room = 1000;
            queue.push(&frame(2, Request::Stop));
            queue.drive(&mut port).unwrap();
            sent.extend(&port.unsent);
            assert_eq!(heard(&sent), [Request::Stop], "{taken} bytes taken");
        }
    }

    #[test]
    fn a_repeated_stop_waits_once_and_an_estop_is_not_lost_behind_a_stop() {
        let mut port = SlowPort::default();
        let mut queue = SendQueue::default();
        queue.push(&frame(1, Request::EStop));
        for _ in 0..100 {
            queue.push(&frame(2, Request::Stop));
            queue.drive(&mut port).unwrap();
        }
        port.room = 1000;
        queue.drive(&mut port).unwrap();
        assert_eq!(heard(&port.unsent), [Request::EStop, Request::Stop]);
    }

    #[test]
    fn a_paced_queue_keeps_the_ports_buffer_short() {
        let mut port = SlowPort {
            room: 100_000,
            ..SlowPort::default()
        };
        let mut queue = SendQueue::paced(11_520.0);
        for _ in 0..20 {
            for sequence in 0..100 {
                queue.push(&frame(sequence, Request::Status));
            }
            queue.drive(&mut port).unwrap();
            port.now += Duration::from_millis(10);
        }
        // 190 ms of line, 20 ms ahead, and one frame.
        let most = 11_520.0_f64 * 0.21 + 20.0;
        assert!((port.unsent.len() as f64) < most, "{}", port.unsent.len());
        assert!(port.unsent.len() > 1500, "{}", port.unsent.len());
    }

    #[test]
    fn a_port_that_takes_nothing_is_stuck() {
        let mut port = SlowPort::default();
        let mut queue = SendQueue::default();
        queue.push(&frame(1, Request::Status));
        queue.drive(&mut port).unwrap();
        port.now = Duration::from_secs(3);
        assert_eq!(queue.stuck_for(port.now), Duration::from_secs(3));
        port.room = 1000;
        queue.drive(&mut port).unwrap();
        assert_eq!(queue.stuck_for(port.now), Duration::ZERO);
    }
}
