//! Who may ask, and in which order: one session at a time, each request at most once.

use heapless::Vec;
use link_protocol::{MAX_BODY, Reply};

/// A link is silent when no valid frame of its session came for this long. With the tick that finds out, the ramp
/// starts 480 ms after the last frame: 500 ms are promised.
pub(crate) const LEASE_US: u64 = 460_000;

/// The open session.
#[derive(Clone)]
pub(crate) struct Session {
    open: Option<Open>,
    next: u16,
    pub(super) heard_us: Option<u64>,
}

#[derive(Clone)]
struct Open {
    number: u16,
    host_nonce: u32,
    last: Option<u16>,
    /// Body of the reply to `last`; empty while there is none yet.
    reply: Vec<u8, MAX_BODY>,
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
    pub(crate) fn new(seed: u16) -> Self {
        Self {
            open: None,
            next: seed.max(1),
            heard_us: None,
        }
    }

    /// Number of the open session; 0 where none is.
    pub(crate) fn number(&self) -> u16 {
        self.open.as_ref().map_or(0, |open| open.number)
    }

    /// Opens a session for a greeting, or finds it open already.
    pub(crate) fn greet(&mut self, host_nonce: u32) -> u16 {
        if let Some(open) = &self.open
            && open.host_nonce == host_nonce
        {
            return open.number;
        }
        let number = self.next;
        self.next = self.next.checked_add(1).unwrap_or(1);
        self.open = Some(Open {
            number,
            host_nonce,
            last: None,
            reply: Vec::new(),
        });
        number
    }

    /// A valid frame came; true where it is of the open session, and so keeps the link alive.
    pub(crate) fn hear(&mut self, now_us: u64, number: u16) -> bool {
        let ours = number != 0 && number == self.number();
        if ours {
            self.heard_us = Some(now_us);
        }
        ours
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
        let mut session = Session::new(0xFFFE);
        assert_eq!(session.number(), 0);
        assert_eq!(
            [
                session.greet(1),
                session.greet(1),
                session.greet(2),
                session.greet(3)
            ],
            [0xFFFE, 0xFFFE, 0xFFFF, 1]
        );
        assert_eq!(Session::new(0).greet(9), 1);
    }

    #[test]
    fn numbers_count_modulo_two_to_the_sixteenth() {
        let mut session = Session::new(5);
        session.greet(1);
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
        let mut session = Session::new(5);
        session.greet(1);
        session.order(1);
        assert_eq!(session.kept(), None);
        session.order(2);
        session.keep(1, &Reply::Done);
        assert_eq!(session.kept(), None);
        session.keep(2, &Reply::Done);
        assert_eq!(session.kept(), Some(&[0][..]));
        session.greet(2);
        assert_eq!(session.kept(), None);
    }

    #[test]
    fn only_the_open_session_keeps_the_link_alive() {
        let mut session = Session::new(5);
        assert!(session.silent(0) && !session.hear(0, 0));
        session.greet(1);
        assert!(!session.hear(10, 4) && session.silent(10));
        assert!(session.hear(10, 5));
        assert!(!session.silent(10 + LEASE_US) && session.silent(11 + LEASE_US));
    }
}
