//! The host end of the wire: ports (serial, pseudo-terminal, TCP, in memory, with faults, with a witness), the session, and
//! a blocking [`Robot`] over any of them.
//!
//! A state machine without I/O ([`session::Session`]) decides; the shell ([`Robot`]) moves its bytes.

pub mod hc05;
pub mod port;
pub mod robot;
pub mod session;

pub use port::Port;
pub use robot::{Robot, StoppedBy};
pub use session::LinkError;
