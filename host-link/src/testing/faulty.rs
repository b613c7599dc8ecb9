//! Port wrapper with faults in both directions, reproducible from a seed.

use std::io;
use std::time::Duration;

use rand::SeedableRng;
use rand_chacha::ChaCha8Rng;

use super::faults::{Faults, Outage};
use super::injector::{FaultCounts, FaultInjector};
use crate::Port;

/// Faults of the written and of the read bytes.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct FaultPlan {
    /// Faults of the written bytes.
    pub written: Faults,
    /// Faults of the read bytes.
    pub read: Faults,
}

impl FaultPlan {
    /// Plan for a port at the host's end: lumps affect reads, a slow rate affects writes.
    pub fn at_host(faults: Faults) -> Self {
        Self {
            written: Faults { clump: 0, ..faults },
            read: Faults {
                rate: None,
                ..faults
            },
        }
    }

    /// Plan for a port at the robot's end: lumps affect writes.
    pub fn at_robot(faults: Faults) -> Self {
        Self {
            written: Faults {
                rate: None,
                ..faults
            },
            read: Faults { clump: 0, ..faults },
        }
    }
}

/// Port with seeded faults around any other port, on that port's clock.
#[derive(Debug)]
pub struct FaultyPort<P> {
    port: P,
    written: FaultInjector,
    read: FaultInjector,
    /// Received bytes that did not fit the reader's buffer.
    ready: Vec<u8>,
}

impl<P: Port> FaultyPort<P> {
    /// Wraps `port`. The same plan, seed and traffic give the same faults.
    pub fn new(port: P, plan: FaultPlan, seed: u64) -> Self {
        let stream = |number| {
            let mut rng = ChaCha8Rng::seed_from_u64(seed);
            rng.set_stream(number);
            rng
        };
        Self {
            port,
            written: FaultInjector::new(plan.written, stream(1)),
            read: FaultInjector::new(plan.read, stream(2)),
            ready: Vec::new(),
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

    /// Fault counts of the written and of the read frames.
    pub fn counts(&self) -> (FaultCounts, FaultCounts) {
        (self.written.counts(), self.read.counts())
    }

    /// Interrupts the link in both directions.
    pub fn disconnect(&mut self, outage: Outage) {
        self.written.disconnect(outage);
        self.read.disconnect(outage);
    }

    /// Replaces the faults. Frames under way keep their outcome.
    pub fn set_plan(&mut self, plan: FaultPlan) {
        self.written.set_faults(plan.written);
        self.read.set_faults(plan.read);
    }

    /// Passes on the frames that are due at `now`.
    fn settle(&mut self, now: Duration) -> io::Result<()> {
        let mut due = Vec::new();
        self.written.pop(now, &mut due);
        if !due.is_empty() {
            self.port.write(&due)?;
        }
        self.read.pop(now, &mut self.ready);
        Ok(())
    }
}

impl<P: Port> Port for FaultyPort<P> {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let deadline = self.port.now() + timeout;
        let mut raw = [0; 512];
        loop {
            let now = self.port.now();
            self.settle(now)?;
            if !self.ready.is_empty() {
                let count = buf.len().min(self.ready.len());
                buf[..count].copy_from_slice(&self.ready[..count]);
                self.ready.drain(..count);
                return Ok(count);
            }
            // Waits for the next possible event. Available bytes are read without a wait, even at the deadline.
            let wake = [self.written.next_release(), self.read.next_release()]
                .into_iter()
                .flatten()
                .fold(deadline, Duration::min);
            let count = self.port.read(&mut raw, wake.saturating_sub(now))?;
            if count > 0 {
                let arrived = self.port.now();
                self.read.push(arrived, raw.get(..count).unwrap_or(&raw));
            } else if self.port.now() >= deadline {
                let now = self.port.now();
                self.settle(now)?;
                if self.ready.is_empty() {
                    return Ok(0);
                }
            }
        }
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        let now = self.port.now();
        self.written.push(now, bytes);
        self.settle(now)
    }

    fn now(&self) -> Duration {
        self.port.now()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::testing::MockPort;

    const MS: Duration = Duration::from_millis(1);

    #[test]
    fn delayed_writes_leave_while_the_port_is_read() {
        let (near, mut far) = MockPort::pair();
        let plan = FaultPlan::at_host("delay=30".parse().unwrap());
        let mut port = FaultyPort::new(near, plan, 1);
        let mut buf = [0; 16];
        port.write(&[5, 0]).unwrap();
        assert_eq!(far.read(&mut buf, Duration::ZERO).unwrap(), 0);
        assert_eq!(port.read(&mut buf, MS * 40).unwrap(), 0);
        assert_eq!(port.now(), MS * 40);
        assert_eq!(far.read(&mut buf, Duration::ZERO).unwrap(), 2);
    }

    #[test]
    fn both_directions_are_delayed() {
        let (near, mut far) = MockPort::pair();
        let plan = FaultPlan::at_host("delay=30".parse().unwrap());
        let mut port = FaultyPort::new(near, plan, 1);
        far.write(&[5, 0]).unwrap();
        let mut buf = [0; 16];
        assert_eq!(port.read(&mut buf, MS * 100).unwrap(), 2);
        assert_eq!(port.now(), MS * 30);
    }

    #[test]
    fn the_same_seed_drops_the_same_frames() {
        let survivors = |seed| {
            let (near, mut far) = MockPort::pair();
            let plan = FaultPlan::at_host("drop=50%".parse().unwrap());
            let mut port = FaultyPort::new(near, plan, seed);
            for byte in 1..=100 {
                port.write(&[byte, 0]).unwrap();
            }
            let mut buf = [0; 512];
            let count = far.read(&mut buf, Duration::ZERO).unwrap();
            buf[..count].to_vec()
        };
        assert_eq!(survivors(3), survivors(3));
        assert_ne!(survivors(3), survivors(4));
        assert!(survivors(3).len() > 60 && survivors(3).len() < 140);
    }
}
