//! One trait for everything bytes can travel through, so that the session never knows what carries it.
//!
//! A port owns its clock. A serial port's clock is the wall; a virtual port's clock stands still until somebody reads and
//! waits, so that an hour of link time is tested in a second and twice the same.
//!
//! The ports of an operating system are left out where there is none (WebAssembly in a browser).

#[cfg(unix)]
mod beside;
mod frames;
#[cfg(not(target_family = "wasm"))]
mod listed;
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

#[cfg(unix)]
pub use beside::BesidePort;
pub(crate) use frames::FrameCutter;
#[cfg(not(target_family = "wasm"))]
pub use listed::{ListedPort, serial_ports};
#[cfg(unix)]
pub use pty::{PtyError, PtyPort};
pub use send_queue::SendQueue;
#[cfg(not(target_family = "wasm"))]
pub use serial::{OpenError, SerialPort};
pub use tcp::TcpPort;
pub use traced::{TracedFrame, TracedPort};
pub use virtual_port::{Device, VirtualPort};
pub use wire::{Wire, WireSpeed};

/// A two-way stream of bytes with a clock of its own.
pub trait Port: Send {
    /// Reads what has arrived, waiting at most `timeout` for the first byte.
    ///
    /// Returns how many bytes were put into `buf`; `Ok(0)` says that the time passed without any. A virtual port moves its
    /// clock on while it waits.
    ///
    /// # Errors
    /// What the operating system says when the port is gone.
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize>;

    /// Sends all of `bytes`. May return before the last one has left; waits at most a second for a port that takes none.
    ///
    /// # Errors
    /// What the operating system says when the port is gone; [`io::ErrorKind::TimedOut`].
    fn write(&mut self, bytes: &[u8]) -> io::Result<()>;

    /// Sends as many of `bytes` as the port takes without waiting. Returns their number; 0 if it takes none at present.
    ///
    /// # Errors
    /// What the operating system says when the port is gone.
    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.write(bytes).map(|()| bytes.len())
    }

    /// Discards bytes that were written and have not left yet, as far as the system allows: for a stop, which must not wait
    /// behind them.
    fn discard_unsent(&mut self) {}

    /// The time on this port's clock, since an arbitrary origin.
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
