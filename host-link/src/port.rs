//! Port: one trait for every byte transport, so that the session is independent of it.
//!
//! A port owns its clock. A serial port uses real time. The clock of a virtual port advances only while the caller reads or
//! waits, so a test simulates an hour of link time in a second and is reproducible.
//!
//! Ports of the operating system are not compiled for WebAssembly.

mod frames;
#[cfg(not(target_family = "wasm"))]
mod listed;
#[cfg(unix)]
mod occupied;
#[cfg(unix)]
mod pty;
mod send_queue;
#[cfg(not(target_family = "wasm"))]
mod serial;
mod tcp;
mod traced;
#[cfg(unix)]
mod tty;
mod virtual_port;
mod wire;

use std::io;
use std::time::Duration;

pub(crate) use frames::FrameCutter;
#[cfg(not(target_family = "wasm"))]
pub use listed::{ListedPort, serial_ports};
#[cfg(unix)]
pub use occupied::OccupiedPort;
#[cfg(unix)]
pub use pty::{PtyError, PtyPort};
pub use send_queue::SendQueue;
#[cfg(not(target_family = "wasm"))]
pub use serial::{OpenError, SerialPort};
pub use tcp::TcpPort;
pub use traced::{TracedFrame, TracedPort};
pub use virtual_port::{Device, VirtualPort};
pub use wire::{Wire, WireSpeed};

/// Bidirectional byte stream with its own clock.
pub trait Port: Send {
    /// Reads available bytes; waits at most `timeout` for the first one.
    ///
    /// Returns the number of bytes written to `buf`; `Ok(0)` after a time-out. A virtual port advances its clock while it
    /// waits.
    ///
    /// # Errors
    /// The error of the operating system if the port is gone.
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize>;

    /// Sends all of `bytes`. It may return before the last byte has left, and waits at most a second for a port that accepts
    /// none.
    ///
    /// # Errors
    /// The error of the operating system if the port is gone; [`io::ErrorKind::TimedOut`].
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Sends as many of `bytes` as the port accepts without waiting. Returns their number, possibly 0.
    ///
    /// # Errors
    /// The error of the operating system if the port is gone.
    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write(bytes).map(|()| bytes.len())
    }

    /// Discards written bytes that have not left yet, if the system allows it: a stop must not wait behind them.
    fn discard_unsent(&mut self) {}

    /// Time on this port's clock, since an arbitrary origin.
    fn now(&self) -> Duration;
}

impl<P: Port + ?Sized> Port for Box<P> {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        (**self).read(buf, timeout)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).write(bytes)
    }

    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (**self).write_ready(bytes)
    }

    fn discard_unsent(&mut self) {
        (**self).discard_unsent();
    }

    fn now(&self) -> Duration {
        (**self).now()
    }
}

impl<P: Port + ?Sized> Port for &mut P {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        (**self).read(buf, timeout)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        (**self).write(bytes)
    }

    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        (**self).write_ready(bytes)
    }

    fn discard_unsent(&mut self) {
        (**self).discard_unsent();
    }

    fn now(&self) -> Duration {
        (**self).now()
    }
}
