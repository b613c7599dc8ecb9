//! Ports that `--port` may name.

use std::io;
use std::num::NonZeroU16;
use std::thread::sleep;
use std::time::{Duration, Instant, SystemTime, UNIX_EPOCH};

use host_link::Port;
use host_link::port::{OpenError, SerialPort, TcpPort};
use host_link::session::SessionConfig;
use swimmer_files::SwimmerFile;

use super::port_owner::program_with;
use super::tank_cameras::TankCameras;
use crate::arguments::load_swimmer;
use crate::failure::{Failure, Outcome};
use crate::virtual_robot::{Carrier, EmulatedBoard};

/// Any port.
pub(super) type AnyPort = Box<dyn Port>;

/// The speed of the robot's serial line unless its firmware was built for another.
pub(super) const BAUD: u32 = 115_200;

/// Clock of a fresh virtual robot.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Pace {
    /// Faster than real time, for commands that end by themselves.
    AsFastAsPossible,
    /// In the operator's time: for what waits for the operator.
    RealTime,
}

/// The names of fresh robots in a virtual tank, and what carries them.
const FRESH: [(&str, Carrier); 2] = [("twin", Carrier::Twin), ("emulator", Carrier::Emulator)];

/// Swimmer of a fresh robot if its name has none.
const USUAL_SWIMMER: &str = "robot";

/// A virtual robot that lasts as long as the command.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) struct Fresh<'a> {
    pub(super) carrier: Carrier,
    /// A preset or the path of a swimmer file, if the name has one.
    pub(super) swimmer: Option<&'a str>,
}

/// Returns `true` if the name is that of a serial port or a pseudo-terminal.
pub(super) fn is_a_path(name: &str) -> bool {
    !name.starts_with("tcp:") && fresh(name).is_none()
}

/// The fresh robot of this name, as `twin` or `twin:SWIMMER`. Returns `None` if the name is another port's.
pub(super) fn fresh(name: &str) -> Option<Fresh<'_>> {
    FRESH.into_iter().find_map(|(known, carrier)| {
        let swimmer = match name.strip_prefix(known)? {
            "" => None,
            rest => Some(rest.strip_prefix(':')?),
        };
        Some(Fresh { carrier, swimmer })
    })
}

/// Settings for the greeting of a robot, and for a fresh virtual one.
#[derive(Debug, Clone)]
pub(super) struct Means {
    pub(super) pace: Pace,
    /// Speed of a serial line.
    pub(super) baud: u32,
    /// Settings of the session.
    pub(super) session: SessionConfig,
    pub(super) board: EmulatedBoard,
}

/// A port, opened.
pub(super) struct Opened {
    pub(super) port: AnyPort,
    /// Name on the command line.
    pub(super) name: String,
}

/// Error of opening a port.
pub(super) enum NotOpen {
    /// Somebody else has it, perhaps only for the moment of a short command.
    Busy(Failure),
    /// Waiting helps nothing.
    Failed(Failure),
}

impl From<Failure> for NotOpen {
    fn from(failure: Failure) -> Self {
        Self::Failed(failure)
    }
}

/// Opens what `--port` names.
///
/// # Errors
/// [`NotOpen`], with [`Failure::Tried`], or [`Failure::BadInput`] where what an emulated robot needs is missing.
pub(super) fn open(name: &str, means: &Means) -> Result<Opened, NotOpen> {
    Ok(Opened {
        port: any_port(name, means)?,
        name: name.to_owned(),
    })
}

/// Opens a fresh virtual robot in whose tank the swimmer of its name, otherwise `file`, is the truth, and keeps the frames of its
/// cameras.
///
/// # Errors
/// [`Failure::BadInput`] if the name is another port's, and as [`open`].
pub(super) fn open_filmed(
    name: &str,
    means: &Means,
    file: &SwimmerFile,
    seed: u64,
    cameras: &TankCameras,
) -> Outcome<Opened> {
    let Some(Fresh { carrier, swimmer }) = fresh(name) else {
        return Err(Failure::BadInput(
            "--track twin sees a fresh virtual robot: use it with --port twin or --port emulator"
                .to_owned(),
        ));
    };
    let named = swimmer.map(load_swimmer).transpose()?;
    let line = carrier.line(named.as_ref().unwrap_or(file), seed, &means.board)?;
    let port = line.map_device(|robot| cameras.film(robot));
    Ok(Opened {
        port: paced(port, means.pace),
        name: name.to_owned(),
    })
}

fn paced(port: impl Port + 'static, pace: Pace) -> AnyPort {
    match pace {
        Pace::AsFastAsPossible => Box::new(port),
        Pace::RealTime => Box::new(Paced::new(port)),
    }
}

fn any_port(name: &str, means: &Means) -> Result<AnyPort, NotOpen> {
    if let Some(Fresh { carrier, swimmer }) = fresh(name) {
        let port = carrier.line(
            &load_swimmer(swimmer.unwrap_or(USUAL_SWIMMER))?,
            1,
            &means.board,
        )?;
        return Ok(paced(port, means.pace));
    }
    if let Some(address) = name.strip_prefix("tcp:") {
        is_an_address(address)?;
        let port = TcpPort::connect(address)
            .map_err(|error| Failure::Tried(format!("cannot connect to the robot at {address}: {error}; is `swimmer twin --tcp` running?")))?;
        return Ok(Box::new(port));
    }
    match SerialPort::open(name, means.baud) {
        Ok(port) => Ok(Box::new(port)),
        Err(error @ OpenError::Busy { .. }) => {
            let by = program_with(name)
                .map_or_else(String::new, |program| format!("; {program} has it"));
            let no_way_past = if cfg!(unix) {
                ""
            } else {
                " On this system no second program can be let past the first."
            };
            Err(NotOpen::Busy(Failure::Tried(format!(
                "{error}{by}.{no_way_past} To stop the robot now, end that program: half a second later the robot stops by itself, unless \
                 it plays detached; then, or in doubt, switch its power off"
            ))))
        }
        Err(error) => Err(Failure::tried(&error).into()),
    }
}

/// A host and a port to call there; whether they are reached is another matter.
///
/// # Errors
/// [`Failure::BadInput`].
fn is_an_address(text: &str) -> Result<(), Failure> {
    let parts = text.rsplit_once(':');
    if parts.is_some_and(|(host, port)| !host.is_empty() && port.parse::<NonZeroU16>().is_ok()) {
        return Ok(());
    }
    Err(Failure::BadInput(format!(
        "`{text}` is no address: write --port tcp:HOST:PORT, as tcp:127.0.0.1:7000"
    )))
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_fresh_robot_may_name_its_swimmer() {
        let swimmer = |name| fresh(name).map(|robot| robot.swimmer);
        assert_eq!(swimmer("twin"), Some(None));
        assert_eq!(swimmer("twin:ours.toml"), Some(Some("ours.toml")));
        assert_eq!(
            swimmer("emulator:C:\\ours.toml"),
            Some(Some("C:\\ours.toml"))
        );
        for path in ["twins", "./twin", "/tmp/twin", "tcp:twin:7000"] {
            assert_eq!(swimmer(path), None, "{path}");
        }
        assert!(is_a_path("/tmp/twin") && !is_a_path("twin:robot"));
    }

    #[test]
    fn an_address_is_a_host_and_a_port() {
        for text in ["127.0.0.1:7000", "[::1]:7000", "robot.local:1"] {
            assert!(is_an_address(text).is_ok(), "{text}");
        }
        for text in [
            "",
            ":",
            "127.0.0.1",
            ":7000",
            "host:",
            "host:0",
            "host:70000",
            "host:x",
        ] {
            assert!(
                matches!(is_an_address(text), Err(Failure::BadInput(_))),
                "{text}"
            );
        }
    }
}
