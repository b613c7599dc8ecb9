//! A port with a simulated device behind it: waiting on the port is what lets the device live.

use std::error::Error;
use std::io;
use std::time::Duration;

use super::Port;
use super::wire::{Wire, WireSpeed};

/// Something that lives in virtual time at the far end of a wire.
pub trait Device: Send {
    /// Lives on until `to`. Never goes backwards: an earlier time does nothing.
    fn advance(&mut self, to: Duration);

    /// Takes bytes that arrive at the time reached last.
    fn receive(&mut self, bytes: &[u8]);

    /// Appends to `out` at most `room` bytes of what the device has to send.
    fn transmit(&mut self, room: usize, out: &mut Vec<u8>);

    /// Before it is advanced: nothing will arrive before `until`, nor before what it sends has been under way for `travel`.
    /// A device may live ahead within these limits and hand out what it sends when its time has come; most need not.
    fn expect_quiet(&mut self, until: Duration, travel: Duration) {
        let _ = (until, travel);
    }

    /// Why it went out of order for good, where it did: from then on it is silent and stands still.
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

/// The host's end of a serial line to a [`Device`], in virtual time.
#[derive(Debug)]
pub struct VirtualPort<D> {
    device: D,
    now: Duration,
    to_device: Wire,
    to_host: Wire,
    ready: Vec<u8>,
}

/// How finely device and wire take turns: a device that speaks between two turns is heard up to this much later.
const TURN: Duration = Duration::from_millis(1);

impl<D: Device> VirtualPort<D> {
    /// A line of the given speed, both ways, to `device`, at time zero.
    pub fn new(device: D, speed: WireSpeed) -> Self {
        Self {
            device,
            now: Duration::ZERO,
            to_device: Wire::new(speed),
            to_host: Wire::new(speed),
            ready: Vec::new(),
        }
    }

    /// The device at the far end.
    pub fn device(&self) -> &D {
        &self.device
    }

    /// The device at the far end.
    pub fn device_mut(&mut self) -> &mut D {
        &mut self.device
    }

    /// Puts another device in the place of this one, with the line as it is: one in a box, say.
    pub fn map_device<E: Device>(self, wrap: impl FnOnce(D) -> E) -> VirtualPort<E> {
        VirtualPort {
            device: wrap(self.device),
            now: self.now,
            to_device: self.to_device,
            to_host: self.to_host,
            ready: self.ready,
        }
    }

    /// Ends the line and gives the device back.
    pub fn into_device(self) -> D {
        self.device
    }

    /// Lets time pass without reading; what arrives meanwhile lies ready afterwards.
    pub fn pass(&mut self, time: Duration) {
        let end = self.now + time;
        while self.now < end {
            self.turn(end);
        }
    }

    fn turn(&mut self, end: Duration) {
        self.now = (self.now + TURN).min(end);
        let mut bytes = Vec::new();
        // Nobody writes before this read ends: at `end`, or when the next byte is there.
        let next = [&self.to_device, &self.to_host].map(Wire::next_arrival);
        let quiet = next.into_iter().flatten().fold(end, Duration::min);
        self.device.expect_quiet(quiet, self.to_host.latency());
        self.device.advance(self.now);
        self.to_device.pop(self.now, &mut bytes);
        if !bytes.is_empty() {
            self.device.receive(&bytes);
            bytes.clear();
        }
        // A transmitter takes no more than the line carries until the next turn.
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

    /// Sends back whatever comes.
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
        // The echo streams: one line time of 8.7 ms, two latencies of 5 ms, and turns of 1 ms.
        let ms = port.now().as_millis();
        assert!((18..=21).contains(&ms), "{ms} ms");
        assert_eq!(port.read(&mut buf, Duration::from_secs(1)).unwrap(), 0);
        assert_eq!(port.device().now, port.now());
    }
}
