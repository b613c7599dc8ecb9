//! Byte buffers between a transport and the control task: received and outgoing bytes.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;

/// Capacity for received bytes.
pub(crate) const RECEIVED: usize = 1024;
/// Capacity for outgoing bytes, a few frames.
const TO_SEND: usize = 512;

/// Buffers of a transport.
pub(crate) struct LinkBuffers {
    /// Bytes for the control task.
    pub(crate) received: Pipe<CriticalSectionRawMutex, RECEIVED>,
    /// Bytes from the control task.
    pub(crate) to_send: Pipe<CriticalSectionRawMutex, TO_SEND>,
}

impl LinkBuffers {
    pub(crate) const fn new() -> Self {
        Self {
            received: Pipe::new(),
            to_send: Pipe::new(),
        }
    }

    /// Copies bytes from `source` to the pipe, as far as they fit. Called only by the control task.
    pub(crate) fn fill(&self, mut source: impl FnMut(&mut [u8]) -> usize) {
        let mut bytes = [0; 64];
        loop {
            let room = self.to_send.free_capacity().min(bytes.len());
            let count = source(&mut bytes[..room]);
            if count == 0 {
                return;
            }
            // All bytes fit, because there is one writer; but one write ends where the pipe's ring wraps.
            let mut rest = &bytes[..count];
            while let Ok(written) = self.to_send.try_write(rest)
                && written < rest.len()
            {
                rest = &rest[written..];
            }
        }
    }
}
