//! Writes to a terminal device without waiting, or within a time limit.

use std::io;
use std::os::fd::OwnedFd;
use std::time::{Duration, Instant};

use rustix::event::{PollFd, PollFlags, Timespec, poll};
use rustix::io::Errno;

/// Waits until the device is ready, at most for `timeout`.
pub(super) fn wait(device: &OwnedFd, wanted: PollFlags, timeout: Duration) -> io::Result<()> {
    let timeout = Timespec {
        tv_sec: i64::try_from(timeout.as_secs()).unwrap_or(i64::MAX),
        tv_nsec: timeout.subsec_nanos().into(),
    };
    match poll(&mut [PollFd::new(device, wanted)], Some(&timeout)) {
        Ok(_) | Err(Errno::INTR) => Ok(()),
        Err(errno) => Err(errno.into()),
    }
}

/// Writes the bytes that a non-blocking device accepts at once; returns their number.
pub(super) fn write_ready(device: &OwnedFd, bytes: &[u8]) -> io::Result<usize> {
    match rustix::io::write(device, bytes) {
        Ok(count) => Ok(count),
        Err(Errno::AGAIN | Errno::INTR) => Ok(0),
        Err(errno) => Err(errno.into()),
    }
}

/// Writes all bytes to a non-blocking device.
///
/// # Errors
/// The system's error; [`io::ErrorKind::TimedOut`] if the device has not accepted all bytes `within` this time.
pub(super) fn write_all(device: &OwnedFd, bytes: &[u8], within: Duration) -> io::Result<()> {
    let until = Instant::now() + within;
    let mut rest = bytes;
    loop {
        rest = rest.get(write_ready(device, rest)?..).unwrap_or_default();
        if rest.is_empty() {
            return Ok(());
        }
        let left = until.saturating_duration_since(Instant::now());
        if left.is_zero() {
            return Err(io::ErrorKind::TimedOut.into());
        }
        wait(device, PollFlags::OUT, left)?;
    }
}
