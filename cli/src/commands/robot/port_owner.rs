//! One program has a serial port at a time. While a `swimmer` has the robot's port, another one of the same user can ask it,
//! through a local socket named after the port, to stop the robot or to tell what it does, also again and again (`watch`): an operator in a hurry need not
//! find the terminal that plays.
//!
//! ```text
//!  swimmer robot play ──── port ──── robot          one line to the holder, two back:
//!        ▲ socket                                    → stop | estop | pause | resume | status | …
//!  swimmer robot stop                                ← heard
//!                                                    ← {"done": …, "text": …, "answer": …}
//! ```
//!
//! The socket lies in a folder that only its user may enter. A thread of the holder says `heard` at once; the holder itself
//! looks at what was asked at every beat (20 ms of waiting), also during an upload. The socket disappears with the holder, and
//! one left behind by a crash is replaced.
//!
//! A holder that hangs (suspended, or stuck in a driver) says nothing within a third of a second. A stop then goes past it: the
//! port's lock binds only who looks at it, so that the stop is written beside the holder; where that cannot be (TCP), the
//! holder is ended ([`take_over`]).

mod halt_signal;
#[cfg(unix)]
mod held_by;
#[cfg(unix)]
mod holder;
mod open_by;
mod relay;
#[cfg(unix)]
mod socket;
#[cfg(unix)]
mod take_over;
#[cfg(not(unix))]
mod unsupported;

#[cfg(unix)]
pub(super) use self::held_by::HeldBy;
#[cfg(unix)]
pub(super) use self::holder::Holder;
pub(super) use open_by::program_with;
pub(super) use relay::{Ask, Introduction, News, Relayed, Unanswered};
#[cfg(not(unix))]
pub(super) use unsupported::{HeldBy, Holder};
