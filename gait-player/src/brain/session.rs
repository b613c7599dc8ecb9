//! Who may ask, and in which order: one session at a time, each request at most once.

use heapless::Vec;
use link_protocol::{Binding, Key, MAX_BODY, Reply, Seal, Signature};

/// A link is silent when no valid frame of its session came for this long. With the tick that finds out, the ramp
/// starts 480 ms after the last frame: 500 ms are promised.
pub(crate) const LEASE_US: u64 = 460_000;

/// The open session.
#[derive(Clone)]
pub(crate) struct Session {
    open: Option<Open>,
    next: u16,
    /// The numbers have begun anew: the next session is of another boot nonce.
    anew: bool,
    boot_nonce: u32,
    pub(super) heard_us: Option<u64>,
}

#[derive(Clone)]
struct Open {
    number: u16,
    host_nonce: u32,
    last: Option<u16>,
    /// Body of the reply to `last`; empty while there is none yet.
    reply: Vec<u8, MAX_BODY>,
    guard: Option<Guard>,
}

/// Lets in only what was signed with the key for this session, each frame once and none after a later one.
#[derive(Clone)]
struct Guard {
    seal: Seal,
    /// Counter of the last frame let in.
    last: u64,
}

/// What a frame may do.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Admission {
    /// Of the open session and, where there is a key, signed with it.
    Ours,
    /// Of no open session.
    Foreign,
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
            heard_us: None,
        }
    }

    /// Number of the open session; 0 where none is.
    pub(crate) fn number(&self) -> u16 {
        self.open.as_ref().map_or(0, |open| open.number)
    }

    /// What a host is told to know this start by. It changes too when the numbers of sessions begin anew, so that no two
    /// sessions of a start have both in common.
    pub(crate) fn boot_nonce(&self) -> u32 {
        self.boot_nonce
    }

    /// Opens a session for a greeting, or finds it open already. The key stands for as long as the session.
    pub(crate) fn greet(&mut self, host_nonce: u32, key: Option<&Key>) -> u16 {
        if let Some(open) = &self.open
            && open.host_nonce == host_nonce
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
            host_nonce,
            last: None,
            reply: Vec::new(),
            guard: key.map(|key| Guard {
                seal: Seal::new(key, binding),
                last: 0,
            }),
        });
        number
    }

    /// What a whole frame of this session number may do. `signed` are the bytes before its tag.
    pub(crate) fn admit(
        &mut self,
        number: u16,
        signed: &[u8],
        signature: Option<&Signature>,
    ) -> Admission {
        let Some(open) = self.open.as_mut().filter(|open| open.number == number) else {
            return Admission::Foreign;
        };
        match (&mut open.guard, signature) {
            (None, _) => Admission::Ours,
            (Some(_), None) => Admission::Unsigned,
            (Some(guard), Some(signature)) => {
                if !guard.seal.verifies(signed, signature) {
                    Admission::WrongKey
                } else if signature.counter <= guard.last {
                    Admission::Replayed
                } else {
                    guard.last = signature.counter;
                    Admission::Ours
                }
            }
        }
    }

    /// A frame of the open session came: the link is alive.
    pub(crate) fn hear(&mut self, now_us: u64) {
        self.heard_us = Some(now_us);
    }

    /// Nothing valid was heard within the lease.
    pub(crate) fn silent(&self, now_us: u64) -> bool {
        self.heard_us
            .is_none_or(|heard| now_us.saturating_sub(heard) > LEASE_US)
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
                session.greet(1, None),
                session.greet(1, None),
                session.greet(2, None),
                session.greet(3, None)
            ],
            [0xFFFE, 0xFFFE, 0xFFFF, 1]
        );
        assert_eq!(session.number(), 1);
        assert_eq!(Session::new(0, 7).greet(9, None), 1);
    }

    #[test]
    fn numbers_count_modulo_two_to_the_sixteenth() {
        let mut session = Session::new(5, 7);
        session.greet(1, None);
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
        session.greet(1, None);
        session.order(1);
        assert_eq!(session.kept(), None);
        session.order(2);
        session.keep(1, &Reply::Done);
        assert_eq!(session.kept(), None);
        session.keep(2, &Reply::Done);
        assert_eq!(session.kept(), Some(&[0][..]));
        session.greet(2, None);
        assert_eq!(session.kept(), None);
    }

    #[test]
    fn only_the_open_session_is_ours() {
        let mut session = Session::new(5, 7);
        assert!(session.silent(0));
        assert_eq!(session.admit(0, &[], None), Admission::Foreign);
        session.greet(1, None);
        assert_eq!(session.admit(0, &[], None), Admission::Foreign);
        assert_eq!(session.admit(4, &[], None), Admission::Foreign);
        assert_eq!(session.admit(5, &[], None), Admission::Ours);
        session.hear(10);
        assert!(!session.silent(10 + LEASE_US) && session.silent(11 + LEASE_US));
    }

    #[test]
    fn a_key_lets_in_what_it_signed_for_this_session_once_and_in_order() {
        let key = Key([3; Key::LEN]);
        let mut session = Session::new(5, 7);
        session.greet(1, Some(&key));
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
            let kind = link_protocol::Kind::KeepAlive;
            let signature = seal.sign(header, kind, &[], counter);
            let mut signed = std::vec![1, 5, 0, 0, 0, 0x86];
            signed.extend(&counter.to_le_bytes()[..6]);
            session.admit(5, &signed, Some(&signature))
        };
        assert_eq!(come(&seal(5, 1), 4), Admission::Ours);
        assert_eq!(come(&seal(5, 1), 4), Admission::Replayed);
        assert_eq!(come(&seal(5, 1), 3), Admission::Replayed);
        assert_eq!(come(&seal(4, 1), 9), Admission::WrongKey);
        assert_eq!(come(&seal(5, 2), 9), Admission::WrongKey);
        assert_eq!(come(&seal(5, 1), 5), Admission::Ours);
        assert_eq!(session.admit(5, &[], None), Admission::Unsigned);
        assert_eq!(session.admit(6, &[], None), Admission::Foreign);
    }

    /// 65 535 greetings lead back to the same number; with the old boot nonce, recorded frames would count again.
    #[test]
    fn no_number_comes_twice_with_the_same_boot_nonce() {
        let mut session = Session::new(0xFFF0, 7);
        let mut seen = std::collections::HashSet::new();
        for nonce in 0..200_000 {
            let number = session.greet(nonce, None);
            assert!(seen.insert((session.boot_nonce(), number)));
            // The same greeting again is told the same.
            assert_eq!(session.greet(nonce, None), number);
            assert!(seen.contains(&(session.boot_nonce(), number)));
        }
    }
}
