//! Port in memory, whose bytes and times the page provides and takes.

use std::collections::VecDeque;
use std::io;
use std::time::Duration;

use host_link::Port;

/// Bytes in both directions, and the current time.
#[derive(Debug, Default)]
pub(super) struct MemoryPort {
    pub(super) now: Duration,
    pub(super) received: VecDeque<u8>,
    pub(super) sent: Vec<u8>,
}

impl Port for MemoryPort {
    fn read(&mut self, buf: &mut [u8], _timeout: Duration) -> io::Result<usize> {
        let count = self.received.len().min(buf.len());
        for (place, byte) in buf.iter_mut().zip(self.received.drain(..count)) {
            *place = byte;
        }
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.sent.extend_from_slice(bytes);
        Ok(())
    }

    fn now(&self) -> Duration {
        self.now
    }
}
