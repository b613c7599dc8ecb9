//! Session with a host: one at a time; each request acts at most once, in order.

use super::Transport;
use heapless::Vec;
use link_protocol::{Binding, Header, Heartbeat, Key, Kind, MAX_BODY, Reply, Seal, Signature};

/// Lease: a session is silent if no fresh keep-alive arrived for this long, µs. One tick later, at most 480 ms after the last
/// keep-alive, the ramp starts; 500 ms are promised.
pub(crate) const LEASE_US: u64 = 460_000;
/// Largest age of the robot's last frame at the host for which a keep-alive is fresh, µs. Legal links stay below it: 200 ms
/// each way, 200 ms to fill a lump of 230 bytes with telemetry, 100 ms until the host's next keep-alive (`docs/security.md`).
pub(crate) const FRESH_US: u64 = 1_000_000;

/// The open session.
#[derive(Clone)]
pub(crate) struct Session {
    open: Option<Open>,
    next: u16,
    /// Session numbers have wrapped around; the next session gets another boot nonce.
    anew: bool,
    boot_nonce: u32,
    /// Time of the last fresh keep-alive.
    pub(super) fed_us: Option<u64>,
}

#[derive(Clone)]
struct Open {
    number: u16,
    /// Transport of the greeting. Frames of the other transport are not of this session.
    transport: Transport,
    host_nonce: u32,
    /// Latest robot time that the host has echoed in a keep-alive, µs.
    echoed_us: u64,
    last: Option<u16>,
    /// Body of the reply to `last`; empty before the reply exists.
    reply: Vec<u8, MAX_BODY>,
    guard: Option<Guard>,
    /// A key was set in this session. It only repeats the reply to that request.
    closed: bool,
}

/// Signature check of a session: admits only frames signed with its key, each once and in increasing order.
#[derive(Clone)]
struct Guard {
    seal: Seal,
    /// Counter of the last admitted frame.
    last: u64,
    /// Counter of the last frame signed by the robot.
    signed: u64,
}

/// Relation of a frame to the open session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Admission {
    /// Frame of the open session, signed if there is a key.
    Ours,
    /// Frame of no open session, or over another transport than its greeting.
    Foreign,
    /// Frame of the session that was closed by setting a key, signed as that session requires.
    Closed,
    /// Frame of the open session without the required signature.
    Unsigned,
    /// Signed with another key, or for another session of the same number.
    WrongKey,
    /// Signed with the key, but not newer than the last admitted frame: an echo or a recorded copy.
    Replayed,
}

/// Position of a request's sequence number in the order.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// Next number: the request may act.
    Next,
    /// Repeat of the last request.
    Repeat,
    /// A later request has acted already.
    Superseded {
        /// Number of the last request that acted.
        last: u16,
    },
}

impl Session {
    /// Returns a state without an open session. The first session is `seed` or the next number.
    pub(crate) fn new(seed: u16, boot_nonce: u32) -> Self {
        Self {
            open: None,
            next: seed.max(1),
            anew: false,
            boot_nonce,
            fed_us: None,
        }
    }

    /// Number of the open session; 0 without a session.
    pub(crate) fn number(&self) -> u16 {
        self.open().map_or(0, |open| open.number)
    }

    fn open(&self) -> Option<&Open> {
        self.open.as_ref().filter(|open| !open.closed)
    }

    /// Closes the session because a key is required from now on. The reply to the request that set it can still be repeated.
    pub(crate) fn close(&mut self) {
        if let Some(open) = &mut self.open {
            open.closed = true;
        }
        self.fed_us = None;
    }

    /// Returns true if this is the number of the last request that acted.
    pub(crate) fn is_last(&self, sequence: u16) -> bool {
        self.open
            .as_ref()
            .is_some_and(|open| open.last == Some(sequence))
    }

    /// Nonce that identifies this start to hosts. It changes if the session numbers wrap around, so no two sessions of a start
    /// share number and nonce.
    pub(crate) fn boot_nonce(&self) -> u32 {
        self.boot_nonce
    }

    /// Transport of the open session.
    pub(crate) fn transport(&self) -> Option<Transport> {
        self.open().map(|open| open.transport)
    }

    /// Opens a session for a greeting, or returns the one that it opened before. The key is fixed for the session.
    pub(crate) fn greet(
        &mut self,
        transport: Transport,
        host_nonce: u32,
        key: Option<&Key>,
    ) -> u16 {
        if let Some(open) = self.open()
            && (open.transport, open.host_nonce) == (transport, host_nonce)
        {
            return open.number;
        }
        let number = self.next;
        if core::mem::take(&mut self.anew) {
            // Odd multiple from the golden ratio: repeats only after 2³² steps.
            self.boot_nonce = self.boot_nonce.wrapping_add(0x9E37_79B9);
        }
        let binding = Binding {
            boot_nonce: self.boot_nonce,
            session: number,
            host_nonce,
        };
        (self.next, self.anew) = self
            .next
            .checked_add(1)
            .map_or((1, true), |next| (next, false));
        self.open = Some(Open {
            number,
            transport,
            host_nonce,
            echoed_us: 0,
            last: None,
            reply: Vec::new(),
            guard: key.map(|key| Guard {
                seal: Seal::new(key, binding),
                last: 0,
                signed: 0,
            }),
            closed: false,
        });
        number
    }

    /// Classifies a complete frame of this session number. `signed` are the bytes before its tag.
    pub(crate) fn admit(
        &mut self,
        transport: Transport,
        number: u16,
        signed: &[u8],
        signature: Option<&Signature>,
    ) -> Admission {
        let ours = |open: &&mut Open| (open.transport, open.number) == (transport, number);
        let Some(open) = self.open.as_mut().filter(ours) else {
            return Admission::Foreign;
        };
        let admitted = if open.closed {
            Admission::Closed
        } else {
            Admission::Ours
        };
        match (&mut open.guard, signature) {
            (None, _) => admitted,
            (Some(_), None) => Admission::Unsigned,
            (Some(guard), Some(signature)) => {
                if !guard.seal.verifies(signed, signature) {
                    Admission::WrongKey
                } else if signature.counter <= guard.last {
                    Admission::Replayed
                } else {
                    guard.last = signature.counter;
                    admitted
                }
            }
        }
    }

    /// Signs a frame to the host of the open session. Returns `None` if the session has no key.
    pub(crate) fn sign(&mut self, header: Header, kind: Kind, body: &[u8]) -> Option<Signature> {
        let open = self.open.as_mut()?;
        let guard = open.guard.as_mut()?;
        if header.session != open.number {
            return None;
        }
        guard.signed += 1;
        Some(guard.seal.sign(header, kind, body, guard.signed))
    }

    /// Renews the lease with a fresh keep-alive of the open session. Its echoed time must be later than any before, so that
    /// none counts twice, and not in the future.
    pub(crate) fn feed(&mut self, now_us: u64, heartbeat: Heartbeat) {
        let Some(open) = self.open.as_mut().filter(|open| !open.closed) else {
            return;
        };
        let age_us = now_us.checked_sub(heartbeat.heard_us);
        if heartbeat.heard_us > open.echoed_us && age_us.is_some_and(|age| age <= FRESH_US) {
            open.echoed_us = heartbeat.heard_us;
            self.fed_us = Some(now_us);
        }
    }

    /// Returns true if the lease has run out.
    pub(crate) fn silent(&self, now_us: u64) -> bool {
        self.fed_us
            .is_none_or(|fed| now_us.saturating_sub(fed) > LEASE_US)
    }

    /// Returns true if the host of the open session is alive: the last fresh keep-alive came within this session.
    pub(crate) fn attended(&self, now_us: u64) -> bool {
        self.open().is_some_and(|open| open.echoed_us > 0) && !self.silent(now_us)
    }

    /// Classifies a sequence number. [`Order::Next`] makes it the last one, without a reply yet.
    pub(crate) fn order(&mut self, sequence: u16) -> Order {
        let Some(open) = &mut self.open else {
            return Order::Superseded { last: 0 };
        };
        match open.last {
            Some(last) if last == sequence => return Order::Repeat,
            Some(last) if sequence.wrapping_sub(last) >= 0x8000 => {
                return Order::Superseded { last };
            }
            _ => {}
        }
        open.last = Some(sequence);
        open.reply.clear();
        Order::Next
    }

    /// Stores the body of a reply for repeats, unless a later request has replaced it.
    pub(crate) fn keep(&mut self, sequence: u16, reply: &Reply) {
        let Some(open) = &mut self.open else { return };
        if open.last == Some(sequence) {
            let _ = open.reply.resize_default(MAX_BODY);
            let len = postcard::to_slice(reply, &mut open.reply).map_or(0, |body| body.len());
            open.reply.truncate(len);
        }
    }

    /// Stored reply body of the last request. Returns `None` before that reply exists.
    pub(crate) fn kept(&self) -> Option<&[u8]> {
        self.open
            .as_ref()
            .map(|open| &open.reply[..])
            .filter(|body| !body.is_empty())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_greeting_opens_one_session_however_often_it_comes() {
        let mut session = Session::new(0xFFFE, 7);
        assert_eq!(session.number(), 0);
        assert_eq!(
            [
                session.greet(Transport::Uart, 1, None),
                session.greet(Transport::Uart, 1, None),
                session.greet(Transport::Uart, 2, None),
                session.greet(Transport::Uart, 3, None)
            ],
            [0xFFFE, 0xFFFE, 0xFFFF, 1]
        );
        assert_eq!(session.number(), 1);
        assert_eq!(Session::new(0, 7).greet(Transport::Uart, 9, None), 1);
    }

    #[test]
    fn numbers_count_modulo_two_to_the_sixteenth() {
        let mut session = Session::new(5, 7);
        session.greet(Transport::Uart, 1, None);
        assert_eq!(session.order(0xFFFE), Order::Next);
        assert_eq!(session.order(0xFFFE), Order::Repeat);
        assert_eq!(session.order(0x0001), Order::Next);
        assert_eq!(session.order(0xFFFF), Order::Superseded { last: 1 });
        assert_eq!(session.order(0x8000), Order::Next);
        assert_eq!(session.order(0x0000), Order::Superseded { last: 0x8000 });
        assert_eq!(session.order(0xFFFF), Order::Next);
    }

    #[test]
    fn replies_are_kept_for_the_last_request_only() {
        let mut session = Session::new(5, 7);
        session.greet(Transport::Uart, 1, None);
        session.order(1);
        assert_eq!(session.kept(), None);
        session.order(2);
        session.keep(1, &Reply::Done);
        assert_eq!(session.kept(), None);
        session.keep(2, &Reply::Done);
        assert_eq!(session.kept(), Some(&[0][..]));
        session.greet(Transport::Uart, 2, None);
        assert_eq!(session.kept(), None);
    }

    #[test]
    fn only_the_open_session_is_ours() {
        let mut session = Session::new(5, 7);
        assert!(session.silent(0));
        assert_eq!(
            session.admit(Transport::Uart, 0, &[], None),
            Admission::Foreign
        );
        session.greet(Transport::Uart, 1, None);
        assert_eq!(
            session.admit(Transport::Uart, 0, &[], None),
            Admission::Foreign
        );
        assert_eq!(
            session.admit(Transport::Uart, 4, &[], None),
            Admission::Foreign
        );
        assert_eq!(
            session.admit(Transport::Uart, 5, &[], None),
            Admission::Ours
        );
        assert_eq!(
            session.admit(Transport::Usb, 5, &[], None),
            Admission::Foreign
        );
    }

    #[test]
    fn a_closed_session_only_repeats_its_last_reply() {
        let mut session = Session::new(5, 7);
        session.greet(Transport::Uart, 1, None);
        session.order(9);
        session.keep(9, &Reply::Done);
        session.feed(
            10,
            Heartbeat {
                host_us: 0,
                heard_us: 5,
            },
        );
        session.close();
        assert!(session.number() == 0 && session.transport().is_none());
        assert!(session.silent(10) && !session.attended(10));
        let admission = session.admit(Transport::Uart, 5, &[], None);
        assert_eq!(admission, Admission::Closed);
        assert!(session.is_last(9) && !session.is_last(10) && session.kept().is_some());
        // After the key was set, the same greeting opens another session.
        assert_eq!(session.greet(Transport::Uart, 1, None), 6);
    }

    #[test]
    fn only_what_is_fresh_and_new_feeds_the_lease() {
        let mut session = Session::new(5, 7);
        session.greet(Transport::Uart, 1, None);
        let beat = |heard_us| Heartbeat {
            host_us: 0,
            heard_us,
        };
        let mut fed = |now_us, heard_us| {
            session.fed_us = None;
            session.feed(now_us, beat(heard_us));
            session.fed_us.is_some()
        };
        let now = 10 * FRESH_US;
        // Nothing received yet, later than the robot's clock, too old.
        assert!(!fed(now, 0) && !fed(now, now + 1) && !fed(now, now - FRESH_US - 1));
        assert!(fed(now, now - FRESH_US));
        // Repeated, or overtaken.
        assert!(!fed(now, now - FRESH_US) && !fed(now - 1, now - FRESH_US));
        assert!(fed(now, now) && !fed(now + 1, now));
        session.fed_us = Some(now);
        assert!(!session.silent(now + LEASE_US) && session.silent(now + LEASE_US + 1));
    }

    #[test]
    fn a_host_is_there_by_its_own_keep_alives() {
        let mut session = Session::new(5, 7);
        session.greet(Transport::Uart, 1, None);
        let beat = |heard_us| Heartbeat {
            host_us: 0,
            heard_us,
        };
        assert!(!session.attended(10));
        session.feed(10, beat(5));
        assert!(session.attended(10 + LEASE_US) && !session.attended(11 + LEASE_US));
        // After another host's greeting the motion's lease continues, but the new host must prove that it is alive.
        session.greet(Transport::Usb, 2, None);
        assert!(!session.silent(11) && !session.attended(11));
        session.feed(11, beat(9));
        assert!(session.attended(11));
    }

    #[test]
    fn a_key_lets_in_what_it_signed_for_this_session_once_and_in_order() {
        let key = Key([3; Key::LEN]);
        let mut session = Session::new(5, 7);
        session.greet(Transport::Uart, 1, Some(&key));
        let seal = |session, host_nonce| {
            let binding = Binding {
                boot_nonce: 7,
                session,
                host_nonce,
            };
            Seal::new(&key, binding)
        };
        let header = link_protocol::Header::new(5, 0);
        let mut come = |seal: &Seal, counter| {
            let kind = link_protocol::Kind::Pong;
            let signature = seal.sign(header, kind, &[], counter);
            let mut signed = std::vec![0x10, 5, 0, 0, 0, 0x87];
            signed.extend(&counter.to_le_bytes()[..6]);
            session.admit(Transport::Uart, 5, &signed, Some(&signature))
        };
        assert_eq!(come(&seal(5, 1), 4), Admission::Ours);
        assert_eq!(come(&seal(5, 1), 4), Admission::Replayed);
        assert_eq!(come(&seal(5, 1), 3), Admission::Replayed);
        assert_eq!(come(&seal(4, 1), 9), Admission::WrongKey);
        assert_eq!(come(&seal(5, 2), 9), Admission::WrongKey);
        assert_eq!(come(&seal(5, 1), 5), Admission::Ours);
        assert_eq!(
            session.admit(Transport::Uart, 5, &[], None),
            Admission::Unsigned
        );
        assert_eq!(
            session.admit(Transport::Uart, 6, &[], None),
            Admission::Foreign
        );
    }

    /// After 65 535 greetings the number repeats. With the old boot nonce, recorded frames would be valid again.
    #[test]
    fn no_number_comes_twice_with_the_same_boot_nonce() {
        let mut session = Session::new(0xFFF0, 7);
        let mut seen = std::collections::HashSet::new();
        for nonce in 0..200_000 {
            let number = session.greet(Transport::Uart, nonce, None);
            assert!(seen.insert((session.boot_nonce(), number)));
            // A repeated greeting returns the same session.
            assert_eq!(session.greet(Transport::Uart, nonce, None), number);
            assert!(seen.contains(&(session.boot_nonce(), number)));
        }
    }
}
