//! The host end of the wire: ports (serial, pseudo-terminal, TCP, in memory, with faults, with a witness), the session, and
//! a blocking robot over any of them.
//!
//! A state machine without I/O (the session) decides; the shell  moves its bytes.

pub mod port;

pub use port::Port;
