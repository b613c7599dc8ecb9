//! What `--port` names, opened.

use std::io;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use host_link::port::{SerialPort, TcpPort};
use host_link::{Port, Robot};

use crate::commands::twin::fresh_twin;
use crate::failure::{Failure, Outcome};

/// Any port.
pub(super) type AnyPort = Box<dyn Port>;

/// The speed of the robot's Bluetooth module.
const BAUD: u32 = 115_200;

/// How a fresh twin keeps time.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pace {
    /// As fast as it can: for what ends by itself.
    AsFastAsPossible,
    /// In the operator's time: for what waits for the operator.
    RealTime,
}

/// Opens what `--port` names. `pace` matters only for a fresh twin.
///
/// # Errors
/// [`Failure::BadInput`] when nothing was named, [`Failure::Tried`] when it cannot be opened.
pub(super) fn open(name: Option<&str>, pace: Pace) -> Outcome<AnyPort> {
    let Some(name) = name else {
        return Err(Failure::BadInput(
            "name the robot's port: --port with a serial port, a pseudo-terminal, tcp:HOST:PORT, or `twin`".to_owned(),
        ));
    };
    if name == "twin" {
        let port = fresh_twin()?;
        return Ok(match pace {
            Pace::AsFastAsPossible => Box::new(port),
            Pace::RealTime => Box::new(Paced::new(port)),
        });
    }
    if let Some(address) = name.strip_prefix("tcp:") {
        let port = TcpPort::connect(address)
            .map_err(|error| Failure::Tried(format!("cannot connect to the robot at {address}: {error}; is `swimmer twin --tcp` running?")))?;
        return Ok(Box::new(port));
    }
    Ok(Box::new(
        SerialPort::open(name, BAUD).map_err(|error| Failure::tried(&error))?,
    ))
}

/// Opens the port and greets the robot.
///
/// # Errors
/// As [`open`], and [`Failure::Tried`] when no robot answers or it speaks another protocol.
pub(super) fn connect(name: Option<&str>, pace: Pace) -> Outcome<Robot<AnyPort>> {
    Ok(Robot::connect(open(name, pace)?, session_seed())?)
}

/// Differs between runs: the time and the process.
pub(super) fn session_seed() -> u64 {
    let time = SystemTime::now()
        .duration_since(UNIX_EPOCH)
        .unwrap_or_default();
    (time.as_secs() ^ (u64::from(time.subsec_nanos()) << 32))
        ^ (u64::from(std::process::id()) << 16)
}

/// A virtual port that does not run ahead of the wall clock.
struct Paced<P> {
    port: P,
    started: Instant,
    origin: Duration,
}

impl<P: Port> Paced<P> {
    fn new(port: P) -> Self {
        Self {
            started: Instant::now(),
            origin: port.now(),
            port,
        }
    }
}

impl<P: Port> Port for Paced<P> {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let count = self.port.read(buf, timeout)?;
        let ahead = self
            .port
            .now()
            .saturating_sub(self.origin)
            .saturating_sub(self.started.elapsed());
        sleep(ahead);
        Ok(count)
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write(bytes)
    }

    fn now(&self) -> Duration {
        self.port.now()
    }
}
