//! Host end of the link: ports (serial, pseudo-terminal, TCP, virtual), the session, and a blocking [`Robot`] over any port.
//!
//! [`session::Session`] is a state machine without I/O (sans-IO); [`Robot`] moves its bytes.
//!
//! ```
//! use std::time::Duration;
//! use host_link::port::{Device, VirtualPort, WireSpeed};
//! use host_link::Robot;
//!
//! /// A device that never answers.
//! struct Silent;
//!
//! impl Device for Silent {
//!     fn advance(&mut self, _: Duration) {}
//!     fn receive(&mut self, _: &[u8]) {}
//!     fn transmit(&mut self, _: usize, _: &mut Vec<u8>) {}
//! }
//!
//! let port = VirtualPort::new(Silent, WireSpeed::robot());
//! let silent = Robot::connect(port, 1).err().unwrap();
//! assert!(silent.to_string().contains("answer"), "{silent}");
//! ```

pub mod hc05;
pub mod port;
pub mod robot;
pub mod session;
#[cfg(any(test, feature = "testing"))]
pub mod testing;

pub use port::Port;
pub use robot::{Robot, StoppedBy};
pub use session::LinkError;
