//! Transmit buffer of a transport, with priorities. A frame that does not fit is dropped whole and counted.

use heapless::Deque;
use link_protocol::{Header, Kind, MAX_ENCODED, Signature, encode_body};

/// Capacity, bytes. Replies are few, and telemetry yields to them.
const ROOM: usize = 640;
/// Space reserved for four replies to stops, bytes: under any flood, a stop that acted is acknowledged.
const STOPS_LEFT: usize = 4 * 28;
/// Space that telemetry leaves to replies, bytes.
const TELEMETRY_LEAVES: usize = 2 * MAX_ENCODED;
/// Bytes per tick: 5 kB/s.
const BYTES_A_TICK: usize = 100;
/// Most unspent bytes that telemetry can accumulate.
const MAX_SAVED: usize = 3 * MAX_ENCODED;

/// Frame priority; determines the buffer space that a frame must leave free.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum What {
    /// Reply to a stop. It may use the reserved space.
    StopAnswer,
    /// Any other reply.
    Answer,
    /// Sent if the link has capacity for it.
    Telemetry,
}

/// Pending bytes of a transport.
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

    /// Number of dropped frames.
    pub(crate) fn dropped(&self) -> u32 {
        self.dropped
    }

    /// Adds the byte budget of one tick.
    pub(crate) fn tick(&mut self) {
        self.saved = (self.saved + BYTES_A_TICK).min(MAX_SAVED);
    }

    /// Queues a frame if its priority leaves enough space.
    pub(crate) fn send(
        &mut self,
        header: Header,
        kind: Kind,
        body: &[u8],
        signature: Option<Signature>,
        what: What,
    ) {
        let mut frame = [0; MAX_ENCODED];
        let encoded = encode_body(header, kind as u8, body, signature, &mut frame);
        let leave = match what {
            What::StopAnswer => 0,
            What::Answer => STOPS_LEFT,
            What::Telemetry if encoded.is_ok_and(|len| len > self.saved) => return,
            What::Telemetry => TELEMETRY_LEAVES,
        };
        match encoded {
            Ok(len) if self.bytes.len() + len + leave <= ROOM => {
                self.bytes.extend(frame[..len].iter().copied());
                self.saved = self.saved.saturating_sub(len);
            }
            _ => self.dropped = self.dropped.wrapping_add(1),
        }
    }

    /// Removes bytes to be sent; returns their number.
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

    /// Discards pending bytes: without a listener they would be outdated when one appears.
    pub(crate) fn clear(&mut self) {
        self.bytes.clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use link_protocol::MAX_BODY;

    fn header() -> Header {
        Header::new(u16::MAX, u16::MAX)
    }

    const LONGEST_SIGNATURE: Option<Signature> = Some(Signature {
        counter: (1 << 48) - 1,
        tag: [0xA5; 8],
    });

    fn answer(outbox: &mut Outbox, body: &[u8]) {
        outbox.send(header(), Kind::Reply, body, None, What::Answer);
    }

    fn stop_answer(outbox: &mut Outbox) {
        outbox.send(
            header(),
            Kind::Reply,
            &[0],
            LONGEST_SIGNATURE,
            What::StopAnswer,
        );
    }

    fn telemetry(outbox: &mut Outbox) {
        outbox.send(header(), Kind::Pong, &[], None, What::Telemetry);
    }

    /// Drains the buffer; returns the number of bytes.
    fn waiting(outbox: &mut Outbox) -> usize {
        outbox.take(&mut [0; 2 * ROOM])
    }

    /// Sends until a frame is dropped.
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
                answer(outbox, &[0xA5; MAX_BODY][..len]);
            });
            for _ in 0..4 {
                stop_answer(&mut outbox);
            }
            assert_eq!(outbox.dropped(), 1, "among replies of {len} bytes");
        }
    }

    #[test]
    fn telemetry_leaves_room_for_two_of_the_longest_replies() {
        let mut outbox = Outbox::new();
        fill(&mut outbox, |outbox| {
            outbox.tick();
            telemetry(outbox);
        });
        // Longest frame that telemetry's limit allows next to the reserve for stops.
        let longest = MAX_BODY - STOPS_LEFT / 2;
        for _ in 0..2 {
            answer(&mut outbox, &[0xA5; MAX_BODY][..longest]);
        }
        assert_eq!(outbox.dropped(), 1);
    }

    #[test]
    fn telemetry_goes_as_soon_as_all_its_bytes_are_saved() {
        let mut outbox = Outbox::new();
        (0..100).for_each(|_| outbox.tick());
        telemetry(&mut outbox);
        let len = waiting(&mut outbox);
        outbox.saved = len - 1;
        telemetry(&mut outbox);
        assert_eq!(waiting(&mut outbox), 0);
        outbox.saved = len;
        telemetry(&mut outbox);
        assert_eq!((waiting(&mut outbox), outbox.saved), (len, 0));
    }

    #[test]
    fn telemetry_goes_at_the_links_pace_and_saves_up_little() {
        let mut outbox = Outbox::new();
        telemetry(&mut outbox);
        assert_eq!(waiting(&mut outbox), 0, "nothing is saved yet");
        // After a minute without traffic, the burst is a few frames.
        (0..3_000).for_each(|_| outbox.tick());
        let mut burst = 0;
        for _ in 0..200 {
            telemetry(&mut outbox);
            burst += waiting(&mut outbox);
        }
        assert!(
            (2 * MAX_ENCODED..=3 * MAX_ENCODED).contains(&burst),
            "{burst}"
        );
        // Then 5 kB/s: 100 bytes per tick.
        let mut sent = 0;
        for _ in 0..1_000 {
            outbox.tick();
            for _ in 0..200 {
                telemetry(&mut outbox);
                sent += waiting(&mut outbox);
            }
        }
        assert!((99_000..=100_100).contains(&sent), "{sent}");
    }
}
