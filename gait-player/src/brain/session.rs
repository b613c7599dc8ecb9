//! The session: one at a time, each request at most once, in order.

use super::Transport;
use heapless::Vec;
use link_protocol::{Binding, Header, Heartbeat, Key, Kind, MAX_BODY, Reply, Seal, Signature};

/// A link is silent when no fresh keep-alive of its session came for this long. With the tick that finds out, the ramp
/// starts 480 ms after the last one: 500 ms are promised.
pub(crate) const LEASE_US: u64 = 460_000;
/// A keep-alive is fresh where its host had heard the robot so short a time ago. Legal lines stay below: 200 ms each way,
/// 200 ms for a lump of 230 bytes to fill with telemetry, 100 ms until the host's next keep-alive (`docs/security.md`).
pub(crate) const FRESH_US: u64 = 1_000_000;

/// The open session.
#[derive(Clone)]
pub(crate) struct Session {
    open: Option<Open>,
    next: u16,
    /// The numbers have begun anew: the next session is of another boot nonce.
    anew: bool,
    boot_nonce: u32,
    /// When a fresh keep-alive last came.
    pub(super) fed_us: Option<u64>,
}

#[derive(Clone)]
struct Open {
    number: u16,
    /// Of the greeting: what comes otherwise is not of this session.
    transport: Transport,
    host_nonce: u32,
    /// The latest time of the robot's clock that the host has heard, by its keep-alives, µs.
    echoed_us: u64,
    last: Option<u16>,
    /// Body of the reply to `last`; empty while there is none yet.
    reply: Vec<u8, MAX_BODY>,
    guard: Option<Guard>,
    /// A key was set in it: it does nothing more than repeat the reply to that.
    closed: bool,
}

/// Lets in only what was signed with the key for this session, each frame once and none after a later one.
#[derive(Clone)]
struct Guard {
    seal: Seal,
    /// Counter of the last frame let in.
    last: u64,
    /// Counter of the last frame that the robot signed.
    signed: u64,
}

/// Standing of a frame with the open session.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Admission {
    /// Of the open session and, where there is a key, signed with it.
    Ours,
    /// Of no open session, or by another way than its greeting.
    Foreign,
    /// Of the session that the setting of a key closed; signed as that session requires.
    Closed,
    /// Of the open session, but not signed although there is a key.
    Unsigned,
    /// Signed with another key, or for another session of the same number.
    WrongKey,
    /// Signed with the key, but not later than what was let in before: an echo, or an adversary's copy.
    Replayed,
}

/// How a request's number stands to those before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Order {
    /// It may act.
    Next,
    /// It is the last one again.
    Repeat,
    /// A later one acted already.
    Superseded {
        /// That one.
        last: u16,
    },
}

impl Session {
    /// No session is open; the first will be `seed` or the one after.
    pub(crate) fn new(seed: u16, boot_nonce: u32) -> Self {
        Self {
            open: None,
            next: seed.max(1),
            anew: false,
            boot_nonce,
            fed_us: None,
        }
    }

    /// Number of the open session; 0 if there is none.
    pub(crate) fn number(&self) -> u16 {
        self.open().map_or(0, |open| open.number)
    }

    fn open(&self) -> Option<&Open> {
        self.open.as_ref().filter(|open| !open.closed)
    }

    /// Closes the session: a key holds from here on. The reply to the request that set it can still be repeated.
    pub(crate) fn close(&mut self) {
        if let Some(open) = &mut self.open {
            open.closed = true;
        }
        self.fed_us = None;
    }

    /// The request of this number is the last one that acted.
    pub(crate) fn is_last(&self, sequence: u16) -> bool {
        self.open
            .as_ref()
            .is_some_and(|open| open.last == Some(sequence))
    }

    /// What a host is told to know this start by. It changes too when the numbers of sessions begin anew, so that no two
    /// sessions of a start have both in common.
    pub(crate) fn boot_nonce(&self) -> u32 {
        self.boot_nonce
    }

    /// Transport of the open session.
    pub(crate) fn transport(&self) -> Option<Transport> {
        self.open().map(|open| open.transport)
    }

    /// Opens a session for a greeting, or finds it open already. The key stands for as long as the session.
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
            // The golden ratio's odd multiple: comes back to none before 2³² times.
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

    /// What a whole frame of this session number may do. `signed` are the bytes before its tag.
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

    /// The signature of a frame to the host of the open session; `None` if it has no key.
    pub(crate) fn sign(&mut self, header: Header, kind: Kind, body: &[u8]) -> Option<Signature> {
        let open = self.open.as_mut()?;
        let guard = open.guard.as_mut()?;
        if header.session != open.number {
            return None;
        }
        guard.signed += 1;
        Some(guard.seal.sign(header, kind, body, guard.signed))
    }

    /// A keep-alive of the open session: it feeds the lease where it is fresh. The time it echoes must be later than any
    /// before, so that none counts twice, and may not lie ahead.
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

    /// Nothing fresh was heard within the lease.
    pub(crate) fn silent(&self, now_us: u64) -> bool {
        self.fed_us
            .is_none_or(|fed| now_us.saturating_sub(fed) > LEASE_US)
    }

    /// The host of the open session is there: what fed the lease within it came from this host, not from one before.
    pub(crate) fn attended(&self, now_us: u64) -> bool {
        self.open().is_some_and(|open| open.echoed_us > 0) && !self.silent(now_us)
    }

    /// Where this number stands; [`Order::Next`] makes it the last one, without a reply yet.
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

    /// Keeps the body of the reply to a request, for its repeats. A later request's place is not taken.
    pub(crate) fn keep(&mut self, sequence: u16, reply: &Reply) {
        let Some(open) = &mut self.open else { return };
        if open.last == Some(sequence) {
            let _ = open.reply.resize_default(MAX_BODY);
            let len = postcard::to_slice(reply, &mut open.reply).map_or(0, |body| body.len());
            open.reply.truncate(len);
        }
    }

    /// The kept body of the reply to the last request; `None` while it has none yet.
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
        // The same greeting opens a session of its own now.
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
        // Nothing heard yet, ahead of the robot's clock, too old.
        assert!(!fed(now, 0) && !fed(now, now + 1) && !fed(now, now - FRESH_US - 1));
        assert!(fed(now, now - FRESH_US));
        // Recorded, or overtaken.
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
        // Another host: the motion's lease runs on, and still it says for itself that it is there.
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

    /// 65 535 greetings lead back to the same number; with the old boot nonce, recorded frames would count again.
    #[test]
    fn no_number_comes_twice_with_the_same_boot_nonce() {
        let mut session = Session::new(0xFFF0, 7);
        let mut seen = std::collections::HashSet::new();
        for nonce in 0..200_000 {
            let number = session.greet(Transport::Uart, nonce, None);
            assert!(seen.insert((session.boot_nonce(), number)));
            // The same greeting again is told the same.
            assert_eq!(session.greet(Transport::Uart, nonce, None), number);
            assert!(seen.contains(&(session.boot_nonce(), number)));
        }
    }
}
