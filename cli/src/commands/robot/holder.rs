//! One program has a serial port at a time. While a `swimmer` has the robot's port, another one of the same user can ask it,
//! through a local socket named after the port, to stop the robot or to tell what it does, also again and again (`watch`): an operator in a hurry need not
//! find the terminal that plays.
//!
//! ```text
//!  swimmer robot play ──── port ──── robot          one line each way:
//!        ▲ socket                                    → stop | estop | pause | resume | status | …
//!  swimmer robot stop                                ← {"done": …, "text": …, "answer": …}
//! ```
//!
//! The socket lies in a folder that only its user may enter. The holder looks at it at every beat (20 ms of waiting), also
//! during an upload; it disappears with the holder, and one left behind by a crash is replaced.

#[cfg(not(unix))]
mod nobody;
mod others;
mod relay;
#[cfg(unix)]
mod socket;

#[cfg(not(unix))]
pub(super) use nobody::{HeldBy, Holder};
pub(super) use others::program_with;
pub(super) use relay::{Ask, Introduction, News, Relayed};
#[cfg(unix)]
pub(super) use socket::{HeldBy, Holder};
