//! Shared use of a port, which only one program can open. While a `swimmer` has the robot's port, another one of the same user
//! can request, through a local socket named after the port, to stop the robot or to report its state, also repeatedly (`watch`):
//! an operator in a hurry need not find the terminal that plays.
//!
//! ```text
//!  swimmer robot play ──── port ──── robot          one line to the holder, two back:
//!        ▲ socket                                    → stop | estop | pause | resume | status | …
//!  swimmer robot stop                                ← heard
//!                                                    ← {"done": …, "text": …, "answer": …}
//! ```
//!
//! The socket is in a folder that only its user may enter. A thread of the holder acknowledges with `heard` at once; the holder
//! serves the request at its next beat (20 ms of waiting), also during an upload. The socket is removed with the holder, and one
//! left behind by a crash is replaced.
//!
//! A holder that hangs (suspended, or blocked in a driver) does not acknowledge within a third of a second. A stop then bypasses
//! it: the port's lock is advisory, so the stop is written to the port directly; if that is impossible (TCP), the holder is ended
//! ([`take_over`]).

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
pub(super) use self::holder::PortHolder;
pub(super) use open_by::program_with;
pub(super) use relay::{Introduction, LinkReport, PortRequest, Relayed, Unanswered};
#[cfg(not(unix))]
pub(super) use unsupported::{HeldBy, PortHolder};
