//! Pair of connected ports in memory, on one clock that advances only during waits.

use std::collections::VecDeque;
use std::io;
use std::sync::{Arc, Mutex, MutexGuard, PoisonError};
use std::time::Duration;

use crate::Port;

#[derive(Debug, Default)]
struct Shared {
    now: Duration,
    /// Readable bytes of end 0 and end 1.
    inbox: [VecDeque<u8>; 2],
    closed: bool,
}

/// One end of an in-memory link. Bytes arrive at once; a read without bytes advances the clock by its whole time-out.
#[derive(Debug)]
pub struct MockPort {
    shared: Arc<Mutex<Shared>>,
    end: usize,
}

impl MockPort {
    /// Returns both ends of a link, at time zero.
    pub fn pair() -> (Self, Self) {
        let shared = Arc::new(Mutex::new(Shared::default()));
        let end = |end| Self {
            shared: Arc::clone(&shared),
            end,
        };
        (end(0), end(1))
    }

    /// Advances the clock of both ends.
    pub fn pass(&self, time: Duration) {
        self.shared().now += time;
    }

    fn shared(&self) -> MutexGuard<'_, Shared> {
        self.shared.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

impl Drop for MockPort {
    fn drop(&mut self) {
        self.shared().closed = true;
    }
}

impl Port for MockPort {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let mut shared = self.shared();
        let end = self.end;
        if shared.inbox[end].is_empty() {
            if shared.closed {
                return Err(io::Error::new(
                    io::ErrorKind::BrokenPipe,
                    "the other end of the mock link is gone",
                ));
            }
            shared.now += timeout;
            return Ok(0);
        }
        let mut count = 0;
        for slot in buf {
            let Some(byte) = shared.inbox[end].pop_front() else {
                break;
            };
            *slot = byte;
            count += 1;
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let mut shared = self.shared();
        if shared.closed {
            return Err(io::Error::new(
                io::ErrorKind::BrokenPipe,
                "the other end of the mock link is gone",
            ));
        }
        shared.inbox[1 - self.end].extend(bytes);
        Ok(())
    }

    fn now(&self) -> Duration {
        self.shared().now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bytes_cross_and_waiting_moves_the_clock() {
        let (mut near, mut far) = MockPort::pair();
        near.write(b"abc").unwrap();
        let mut buf = [0; 2];
        assert_eq!(far.read(&mut buf, Duration::from_secs(1)).unwrap(), 2);
        assert_eq!(&buf, b"ab");
        assert_eq!(far.now(), Duration::ZERO);
        assert_eq!(far.read(&mut buf, Duration::ZERO).unwrap(), 1);
        assert_eq!(far.read(&mut buf, Duration::from_secs(1)).unwrap(), 0);
        assert_eq!(near.now(), Duration::from_secs(1));
        drop(far);
        assert_eq!(
            near.write(b"x").unwrap_err().kind(),
            io::ErrorKind::BrokenPipe
        );
    }
}
