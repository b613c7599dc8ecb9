//! Second access to a device that a hung program holds open, only to stop the robot.
//!
//! The lock of [`super::SerialPort`] is advisory, and this port ignores it. Speed and mode are those of the other program.
//! Received bytes go to whichever program reads first, so the other program must have stopped reading.

use std::io;
use std::os::fd::OwnedFd;
use std::path::Path;
use std::time::{Duration, Instant};

use rustix::event::PollFlags;
use rustix::fs::{Mode, OFlags};
use rustix::io::Errno;
use rustix::termios::{QueueSelector, isatty, tcflush};

use super::{Port, tty};

/// Device that another program holds open.
#[derive(Debug)]
pub struct OccupiedPort {
    device: OwnedFd,
    opened: Instant,
}

impl OccupiedPort {
    /// Opens the device regardless of its lock, and discards unread input, which is old telemetry.
    ///
    /// # Errors
    /// The system's error: missing, not allowed, no terminal device, or locked by a program other than `swimmer`.
    pub fn open(path: &Path) -> io::Result<Self> {
        let flags = OFlags::RDWR | OFlags::NOCTTY | OFlags::CLOEXEC | OFlags::NONBLOCK;
        let device = rustix::fs::open(path, flags, Mode::empty())?;
        if !isatty(&device) {
            return Err(Errno::NOTTY.into());
        }
        // Queued output of the hung program is kept: it may be the end of a frame.
        tcflush(&device, QueueSelector::IFlush)?;
        Ok(Self {
            device,
            opened: Instant::now(),
        })
    }
}

impl Port for OccupiedPort {
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

    /// `SerialPort` reports a busy port; this port opens it nevertheless.
    #[test]
    fn a_held_port_is_busy_and_lets_a_stop_in() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("port");
        let mut robot = PtyPort::open(Some(&path)).unwrap();
        let name = path.to_str().unwrap();
        let holder = SerialPort::open(name, 115_200).unwrap();
        // Twice: a refused attempt must not lock the device for the next one.
        for _ in 0..2 {
            let busy = SerialPort::open(name, 115_200).unwrap_err();
            assert!(matches!(busy, OpenError::Busy { .. }), "{busy:?}");
        }
        let mut buf = [0; 16];
        robot.write(b"telemetry").unwrap();
        let mut occupied = OccupiedPort::open(&path).unwrap();
        occupied.write(b"stop").unwrap();
        let count = robot.read(&mut buf, Duration::from_secs(2)).unwrap();
        assert_eq!(&buf[..count], b"stop");
        robot.write(b"done").unwrap();
        let count = occupied.read(&mut buf, Duration::from_secs(2)).unwrap();
        assert_eq!(&buf[..count], b"done", "and nothing of before");
        drop((holder, occupied));
        SerialPort::open(name, 115_200).unwrap();
    }

    #[test]
    fn a_file_is_no_device() {
        let file = tempfile::NamedTempFile::new().unwrap();
        assert!(OccupiedPort::open(file.path()).is_err());
    }
}
