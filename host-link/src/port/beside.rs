//! A second way to a device that another program has open and hangs on: only to stop what hangs there.
//!
//! The lock that [`super::SerialPort`] holds is advisory; this looks past it. Speed and mode are those that the other program
//! has set. Bytes that come back go to whoever reads first, so it is for a program that reads nothing any more.

use std::io;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::PollFlags;
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::termios::{QueueSelector, isatty, tcflush};

use super::{Port, tty};

/// A device that another program has open, opened beside it.
#[derive(Debug)]
pub struct BesidePort {
    device: OwnedFd,
    opened: Instant,
}

impl BesidePort {
    /// Opens the device without asking whose it is, and throws away what nobody has read: telemetry of before.
    ///
    /// # Errors
    /// What the system says: not there, not allowed, no terminal device, or locked by a program that is no `swimmer`.
    pub fn open(path: &Path) -> io::Result<Self> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC | OFlags::NONBLOCK;
        let device = rustix::fs::open(path, flags, Mode::empty())?;
        if !isatty(&device) {
            return Err(Errno::NOTTY.into());
        }
        // What the hung program has queued and never sent stays: it may be the end of a frame.
        tcflush(&device, QueueSelector::IFlush)?;
        Ok(Self {
            device,
            opened: Instant::now(),
        })
    }
}

impl Port for BesidePort {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        if buf.is_empty() {
            return Ok(0);
        }
        tty::wait(&self.device, PollFlags::IN, timeout)?;
        match rustix::io::read(&self.device, buf) {
            Ok(0) => Err(io::Error::new(
                io::ErrorKind::UnexpectedEof,
                "the serial port has gone away",
            )),
            Ok(count) => Ok(count),
            Err(Errno::AGAIN | Errno::INTR) => Ok(0),
            Err(errno) => Err(errno.into()),
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        tty::write_all(&self.device, bytes, Duration::from_secs(1))
    }

    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        tty::write_ready(&self.device, bytes)
    }

    fn now(&self) -> Duration {
        self.opened.elapsed()
    }
}

#[cfg(test)]
mod tests {
    use super::super::{OpenError, PtyPort, SerialPort};
    use super::*;

    /// A second program is told that the port is taken, and gets past the first all the same.
    #[test]
    fn a_held_port_is_busy_and_lets_a_stop_in() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("port");
        let mut robot = PtyPort::open(Some(&path)).unwrap();
        let name = path.to_str().unwrap();
        let holder = SerialPort::open(name, 115_200).unwrap();
        // Twice: a try that was turned away must not close the door behind it.
        for _ in 0..2 {
            let busy = SerialPort::open(name, 115_200).unwrap_err();
            assert!(matches!(busy, OpenError::Busy { .. }), "{busy:?}");
        }
        let mut buf = [0; 16];
        robot.write(b"telemetry").unwrap();
        let mut beside = BesidePort::open(&path).unwrap();
        beside.write(b"stop").unwrap();
        let count = robot.read(&mut buf, Duration::from_secs(2)).unwrap();
        assert_eq!(&buf[..count], b"stop");
        robot.write(b"done").unwrap();
        let count = beside.read(&mut buf, Duration::from_secs(2)).unwrap();
        assert_eq!(&buf[..count], b"done", "and nothing of before");
        drop((holder, beside));
        SerialPort::open(name, 115_200).unwrap();
    }

    #[test]
    fn a_file_is_no_device() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(BesidePort::open(file.path()).is_err());
    }
}
