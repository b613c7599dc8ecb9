//! Port with a simulated device: waiting on the port advances the device.

use std::error::Error;
use std::io;
use std::time::Duration;

use super::Port;
use super::wire::{Wire, WireSpeed};

/// Device in virtual time at the far end of a wire.
pub trait Device: Send {
    /// Advances the device to the time `to`. An earlier time has no effect.
    fn advance(&mut self, to: Duration);

    /// Receives bytes at the current time of the device.
    fn receive(&mut self, bytes: &[u8]);

    /// Appends at most `room` bytes to send to `out`.
    fn transmit(&mut self, room: usize, out: &mut Vec<u8>);

    /// Announces a quiet period before the device is advanced. Nothing will arrive before `until`, nor within `travel` after
    /// the device sends something. A device may run ahead within these limits and release its bytes at their time; most devices
    /// ignore it.
    fn expect_quiet(&mut self, until: Duration, travel: Duration) {
        let _ = (until, travel);
    }

    /// Permanent failure of the device, if any. After it the device is silent and does not advance.
    fn failure(&self) -> Option<&(dyn Error + Send + Sync + 'static)> {
        None
    }
}

impl<D: Device + ?Sized> Device for Box<D> {
    fn advance(&mut self, to: Duration) {
        (**self).advance(to);
    }

    fn receive(&mut self, bytes: &[u8]) {
        (**self).receive(bytes);
    }

    fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
        (**self).transmit(room, out);
    }

    fn expect_quiet(&mut self, until: Duration, travel: Duration) {
        (**self).expect_quiet(until, travel);
    }

    fn failure(&self) -> Option<&(dyn Error + Send + Sync + 'static)> {
        (**self).failure()
    }
}

/// Host end of a serial line to a [`Device`], in virtual time.
#[derive(Debug)]
pub struct VirtualPort<D> {
    device: D,
    now: Duration,
    to_device: Wire,
    to_host: Wire,
    ready: Vec<u8>,
}

/// Time step between device and wire; bytes of the device arrive at most this much later.
const TURN: Duration = Duration::from_millis(1);

impl<D: Device> VirtualPort<D> {
    /// Returns a line of this speed, in both directions, to `device`, at time zero.
    pub fn new(device: D, speed: WireSpeed) -> Self {
        Self {
            device,
            now: Duration::ZERO,
            to_device: Wire::new(speed),
            to_host: Wire::new(speed),
            ready: Vec::new(),
        }
    }

    /// Device at the far end.
    pub fn device(&self) -> &D {
        &self.device
    }

    /// Device at the far end.
    pub fn device_mut(&mut self) -> &mut D {
        &mut self.device
    }

    /// Replaces the device and keeps the line, for example to box the device.
    pub fn map_device<E: Device>(self, wrap: impl FnOnce(D) -> E) -> VirtualPort<E> {
        VirtualPort {
            device: wrap(self.device),
            now: self.now,
            to_device: self.to_device,
            to_host: self.to_host,
            ready: self.ready,
        }
    }

    /// Returns the device.
    pub fn into_device(self) -> D {
        self.device
    }

    /// Advances the time without reading; bytes that arrive remain readable.
    pub fn pass(&mut self, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            self.turn(end);
        }
    }

    fn turn(&mut self, end: Duration) {
        self.now = (self.now + TURN).min(end);
        let mut bytes = Vec::new();
        // Nothing is written before this read ends: at `end`, or when the next byte arrives.
        let next = [&self.to_device, &self.to_host].map(Wire::next_arrival);
        let quiet = next.into_iter().flatten().fold(end, Duration::min);
        self.device.expect_quiet(quiet, self.to_host.latency());
        self.device.advance(self.now);
        self.to_device.pop(self.now, &mut bytes);
        if !bytes.is_empty() {
            self.device.receive(&bytes);
            bytes.clear();
        }
        // A transmitter accepts no more than the line carries until the next step.
        let room = self.to_host.room(self.now + TURN);
        self.device.transmit(room, &mut bytes);
        if !bytes.is_empty() {
            self.to_host.push(self.now, &bytes);
        }
        self.to_host.pop(self.now, &mut self.ready);
    }
}

impl<D: Device> Port for VirtualPort<D> {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let end = self.now + timeout;
        while self.ready.is_empty() && self.now < end {
            self.turn(end);
        }
        if let Some(failure) = self.device.failure() {
            return Err(io::Error::other(failure.to_string()));
        }
        let count = buf.len().min(self.ready.len());
        buf[..count].copy_from_slice(&self.ready[..count]);
        self.ready.drain(..count);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.to_device.push(self.now, bytes);
        Ok(())
    }

    fn now(&self) -> Duration {
        self.now
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Returns every byte that it receives.
    #[derive(Default)]
    struct Echo {
        pending: Vec<u8>,
        now: Duration,
    }

    impl Device for Echo {
        fn advance(&mut self, to: Duration) {
            self.now = to;
        }

        fn receive(&mut self, bytes: &[u8]) {
            self.pending.extend_from_slice(bytes);
        }

        fn transmit(&mut self, room: usize, out: &mut Vec<u8>) {
            let count = room.min(self.pending.len());
            out.extend(self.pending.drain(..count));
        }
    }

    #[test]
    fn an_echo_takes_two_line_times_and_two_latencies() {
        let mut port = VirtualPort::new(Echo::default(), WireSpeed::robot());
        port.write(&[1; 100]).unwrap();
        let mut buf = [0; 256];
        let mut total = 0;
        while total < 100 {
            total += port.read(&mut buf, Duration::from_secs(1)).unwrap();
        }
        // The echo overlaps: one line time of 8.7 ms, two latencies of 5 ms, and steps of 1 ms.
        let ms = port.now().as_millis();
        assert!((18..=21).contains(&ms), "{ms} ms");
        assert_eq!(port.read(&mut buf, Duration::from_secs(1)).unwrap(), 0);
        assert_eq!(port.device().now, port.now());
    }
}
