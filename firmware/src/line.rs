//! Between a way to the robot and the control task: bytes that came, bytes that are to leave. Each way has one.

use embassy_sync::blocking_mutex::raw::CriticalSectionRawMutex;
use embassy_sync::pipe::Pipe;

/// Bytes that may wait for the brain.
pub(crate) const RECEIVED: usize = 1024;
/// Bytes that may wait for the transmitter, a few frames.
const TO_SEND: usize = 512;

/// A way to the robot, as the control task sees it.
pub(crate) struct Line {
    /// Bytes for the control task.
    pub(crate) received: Pipe<CriticalSectionRawMutex, RECEIVED>,
    /// Bytes from the control task.
    pub(crate) to_send: Pipe<CriticalSectionRawMutex, TO_SEND>,
}

impl Line {
    pub(crate) const fn new() -> Self {
        Self {
            received: Pipe::new(),
            to_send: Pipe::new(),
        }
    }

    /// Moves what `source` has to say into the pipe, as far as there is room. To be called by the control task alone.
    pub(crate) fn fill(&self, mut source: impl FnMut(&mut [u8]) -> usize) {
        let mut bytes = [0; 64];
        loop {
            let room = self.to_send.free_capacity().min(bytes.len());
            let count = source(&mut bytes[..room]);
            if count == 0 {
                return;
            }
            // There is room, for there is one writer; but one write ends where the pipe's ring wraps.
            let mut rest = &bytes[..count];
            while let Ok(written) = self.to_send.try_write(rest)
                && written < rest.len()
            {
                rest = &rest[written..];
            }
        }
    }
}
