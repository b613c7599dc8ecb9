//! Port wrapper that passes each frame of both directions to a sink, with its time.

use std::io;
use std::time::Duration;

use link_protocol::{Direction, redact_keys};

use super::FrameCutter;
use super::Port;

/// Frame that passed a [`TracedPort`] at the host's end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TracedFrame<'a> {
    /// Time on the port's clock when the last byte passed.
    pub at: Duration,
    /// Direction of the frame.
    pub direction: Direction,
    /// Bytes on the wire, with the final zero, including corrupted ones. A key in a frame is replaced by zeros
    /// ([`redact_keys`]).
    pub bytes: &'a [u8],
}

/// Port at the host's end that passes every frame to a sink, such as a link log.
pub struct TracedPort<P, S> {
    port: P,
    sink: S,
    written: FrameCutter,
    read: FrameCutter,
}

impl<P: Port, S: FnMut(TracedFrame<'_>) + Send> TracedPort<P, S> {
    /// Wraps `port`; `sink` gets each frame before the caller does.
    pub fn new(port: P, sink: S) -> Self {
        Self {
            port,
            sink,
            written: FrameCutter::default(),
            read: FrameCutter::default(),
        }
    }

    /// Wrapped port.
    pub fn inner(&self) -> &P {
        &self.port
    }

    /// Wrapped port.
    pub fn inner_mut(&mut self) -> &mut P {
        &mut self.port
    }

    /// Returns port and sink.
    pub fn into_parts(self) -> (P, S) {
        (self.port, self.sink)
    }
}

impl<P: Port, S: FnMut(TracedFrame<'_>) + Send> Port for TracedPort<P, S> {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let count = self.port.read(buf, timeout)?;
        let at = self.port.now();
        let (cutter, sink) = (&mut self.read, &mut self.sink);
        cutter.push(buf.get(..count).unwrap_or_default(), |bytes| {
            show(sink, at, Direction::ToHost, bytes);
        });
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.show_written(bytes);
        self.port.write(bytes)
    }

    fn write_ready(&mut self, bytes: &[u8]) -> io::Result<usize> {
        let count = self.port.write_ready(bytes)?;
        self.show_written(bytes.get(..count).unwrap_or(bytes));
        Ok(count)
    }

    fn discard_unsent(&mut self) {
        self.port.discard_unsent();
    }

    fn now(&self) -> Duration {
        self.port.now()
    }
}

impl<P: Port, S: FnMut(TracedFrame<'_>) + Send> TracedPort<P, S> {
    fn show_written(&mut self, bytes: &[u8]) {
        let at = self.port.now();
        let (cutter, sink) = (&mut self.written, &mut self.sink);
        cutter.push(bytes, |bytes| {
            show(sink, at, Direction::ToRobot, bytes);
        });
    }
}

/// Passes a frame without its secrets to the sink.
fn show(sink: &mut impl FnMut(TracedFrame<'_>), at: Duration, direction: Direction, bytes: &[u8]) {
    let mut bytes = bytes.to_vec();
    redact_keys(&mut bytes);
    sink(TracedFrame {
        at,
        direction,
        bytes: &bytes,
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::MockPort;

    #[test]
    fn every_frame_is_seen_once_with_its_time() {
        let (near, mut far) = MockPort::pair();
        let mut seen = Vec::new();
        let mut port = TracedPort::new(near, |frame: TracedFrame<'_>| {
            seen.push((frame.at.as_millis(), frame.direction, frame.bytes.to_vec()));
        });
        port.write(&[1, 0, 2]).unwrap();
        port.inner().pass(Duration::from_millis(7));
        port.write(&[0]).unwrap();
        far.write(&[9, 0]).unwrap();
        let mut one = [0; 1];
        for _ in 0..2 {
            port.read(&mut one, Duration::ZERO).unwrap();
        }
        drop(port);
        assert_eq!(
            seen,
            vec![
                (0, Direction::ToRobot, vec![1, 0]),
                (7, Direction::ToRobot, vec![2, 0]),
                (7, Direction::ToHost, vec![9, 0]),
            ]
        );
    }
}
