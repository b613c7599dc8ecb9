//! Robot's port shared with a driver outside this program: bytes pass unchanged, and this program has no session
//! of its own, so that nobody but the driver keeps the lease alive.
//!
//! Two things it does itself: a stop for those who may not drive (a session that sends nothing but stops, until the robot has
//! acknowledged one), and to open the port again after its cable was pulled. Nothing here waits for a port that takes no bytes:
//! frames go through a bounded queue that stops overtake.

use std::io;
use std::time::{Duration, Instant};

use host_link::Port as _;
use host_link::port::SendQueue;
use host_link::robot::Halt;
use host_link::session::{Event, Session, SessionConfig, Ticket};
use link_protocol::{Decoder, Message, StateName, Telemetry};

use super::access::{A_MOMENT, open_when_free};
use super::link_monitor::CamerasOverLink;
use super::outputs::{Done, state};
use super::port::{AnyPort, BAUD, Means, Pace, fresh, open, open_filmed, session_seed};
use super::port_owner::{PortHolder, PortRequest, Relayed};
use crate::failure::Outcome;
use crate::virtual_robot::EmulatedBoard;

/// Seed of a fresh virtual robot.
const SEED: u64 = 1;

/// Port and speed.
#[derive(Debug, clap::Args)]
pub(crate) struct SharedPortOptions {
    /// Let the page drive this robot: a serial port, pseudo-terminal, tcp:HOST:PORT, `twin` or `emulator`
    #[arg(long, value_name = "PORT")]
    port: Option<String>,
    /// Speed of the serial line: that of the firmware's build
    #[arg(long, value_name = "BAUD", default_value_t = BAUD, value_parser = clap::value_parser!(u32).range(1200..=4_000_000), hide_short_help = true)]
    baud: u32,
    #[command(flatten)]
    board: EmulatedBoard,
}

/// A port whose bytes others send and read.
pub(crate) struct SharedPort {
    name: String,
    means: Means,
    /// `None` while the cable is pulled.
    port: Option<AnyPort>,
    holder: PortHolder,
    outbound: SendQueue,
    /// Repeats a stop until the robot has acknowledged it.
    stopping: Option<(Session, Ticket)>,
    decoder: Decoder,
    telemetry: Option<Telemetry>,
    last_try: Instant,
}

/// Result of a short wait at the port.
#[derive(Debug, PartialEq, Eq)]
pub(crate) enum PortEvent {
    /// Number of bytes; 0 after a timeout.
    Bytes(usize),
    /// The port went away; it is looked for from now on.
    Gone(String),
    /// It is back.
    Back,
}

impl SharedPortOptions {
    /// Returns `true` if the port is a fresh virtual robot.
    pub(crate) fn is_fresh(&self) -> bool {
        self.port.as_deref().and_then(fresh).is_some()
    }

    /// Opens the port, if one was named; other processes see `command` as its holder. Frames of the cameras over a fresh virtual
    /// robot go to `cameras`.
    ///
    /// # Errors
    /// [`crate::failure::Failure::Tried`] when it cannot be opened or somebody else has it.
    pub(crate) fn open(
        self,
        command: &str,
        cameras: Option<&CamerasOverLink>,
    ) -> Outcome<Option<SharedPort>> {
        let Some(name) = self.port else {
            return Ok(None);
        };
        let means = Means {
            pace: Pace::RealTime,
            baud: self.baud,
            session: SessionConfig::new(session_seed()),
            board: self.board,
        };
        let opened = match cameras.filter(|cameras| cameras.are_virtual()) {
            Some(CamerasOverLink { file, tank, .. }) => {
                open_filmed(&name, &means, file, SEED, tank)?
            }
            None => open_when_free(&name, &means)?,
        };
        Ok(Some(SharedPort {
            holder: PortHolder::announce(&name, command),
            name,
            outbound: SendQueue::paced(bytes_per_second(&means)),
            means,
            port: Some(opened.port),
            stopping: None,
            decoder: Decoder::new(),
            telemetry: None,
            last_try: Instant::now(),
        }))
    }
}

impl SharedPort {
    /// Name of the port.
    pub(crate) fn name(&self) -> &str {
        &self.name
    }

    /// Present time on the port's clock; `None` while it is gone.
    pub(crate) fn now(&self) -> Option<Duration> {
        self.port.as_ref().map(host_link::Port::now)
    }

    /// `true` if it is open.
    pub(crate) fn is_open(&self) -> bool {
        self.port.is_some()
    }

    /// Bytes per second that the line carries.
    pub(crate) fn bytes_per_second(&self) -> f64 {
        bytes_per_second(&self.means)
    }

    /// `true` if every stop of this program was acknowledged.
    pub(crate) fn is_stopped(&self) -> bool {
        self.stopping.is_none()
    }

    /// Waits for bytes of the robot, serves requests of other programs, and repeats a stop that was not acknowledged.
    pub(crate) fn read(&mut self, buf: &mut [u8], timeout: Duration) -> PortEvent {
        self.serve_others();
        let Some(port) = &mut self.port else {
            return self.reopen(timeout);
        };
        let count = match self
            .outbound
            .drive(port)
            .and_then(|()| port.read(buf, timeout))
        {
            Ok(count) => count,
            Err(error) => return self.gone(&error),
        };
        let bytes = buf.get(..count).unwrap_or_default();
        self.decode(bytes);
        match self.drive_stop(bytes) {
            Ok(()) => PortEvent::Bytes(count),
            Err(error) => self.gone(&error),
        }
    }

    /// Sends whole frames. A port that is too slow or gone loses them, as any link does; stops overtake all others.
    pub(crate) fn write(&mut self, frames: &[u8]) -> Option<PortEvent> {
        let port = self.port.as_mut()?;
        self.outbound.push(frames);
        let error = self.outbound.drive(port).err()?;
        Some(self.gone(&error))
    }

    /// Stops the robot, whoever drives it: at once, and again until it has acknowledged.
    pub(crate) fn stop(&mut self, halt: Halt) {
        let Some(port) = &mut self.port else {
            return;
        };
        // The same session as of a stop that is still unanswered: it knows that an e-stop must not become a plain one.
        let mut session = self.stopping.take().map_or_else(
            || {
                Session::new(SessionConfig {
                    seed: session_seed(),
                    ..self.means.session
                })
            },
            |(session, _)| session,
        );
        let ticket = session.request(port.now(), halt.into());
        self.stopping = Some((session, ticket));
        if let Err(error) = self.drive_stop(&[]) {
            self.gone(&error);
        }
    }

    /// State of the robot, according to the last telemetry that passed through.
    fn state(&self) -> Option<StateName> {
        self.telemetry.map(|telemetry| telemetry.state)
    }

    fn decode(&mut self, bytes: &[u8]) {
        for byte in bytes {
            if let Some(Message::Telemetry(telemetry)) = self
                .decoder
                .push(*byte)
                .and_then(|received| received.message.ok())
            {
                self.telemetry = Some(telemetry);
            }
        }
    }

    fn drive_stop(&mut self, bytes: &[u8]) -> io::Result<()> {
        let (Some((session, stop_ticket)), Some(port)) = (&mut self.stopping, &mut self.port)
        else {
            return Ok(());
        };
        let now = port.now();
        session.receive(now, bytes);
        session.poll(now);
        let frames = session.take_outgoing();
        let mut ended = false;
        // Only stops were sent: the last event of a stop ends the session.
        while let Some(event) = session.next_event() {
            ended |= matches!(
                event,
                Event::Answered { ticket, .. }
                | Event::StoppedByItself { ticket, .. }
                | Event::Failed { ticket, .. } if ticket == *stop_ticket
            );
        }
        if ended {
            self.stopping = None;
        }
        self.outbound.push(&frames);
        self.outbound.drive(port)
    }

    fn gone(&mut self, error: &io::Error) -> PortEvent {
        self.port = None;
        self.outbound = SendQueue::paced(bytes_per_second(&self.means));
        self.stopping = None;
        self.telemetry = None;
        self.decoder = Decoder::new();
        self.last_try = Instant::now();
        PortEvent::Gone(format!("{} is gone: {error}", self.name))
    }

    fn reopen(&mut self, wait: Duration) -> PortEvent {
        if self.last_try.elapsed() < A_MOMENT / 2 {
            std::thread::sleep(wait);
            return PortEvent::Bytes(0);
        }
        self.last_try = Instant::now();
        // Others know already that it is ours.
        match open(&self.name, &self.means) {
            Ok(opened) => {
                self.port = Some(opened.port);
                PortEvent::Back
            }
            Err(_) => PortEvent::Bytes(0),
        }
    }

    /// Serves requests of other `swimmer` processes: a stop, or the state.
    fn serve_others(&mut self) {
        for (ask, requester) in self.holder.take_requests() {
            if let Some(halt) = ask.halt() {
                self.stop(halt);
            }
            let answer = match ask {
                PortRequest::Stop | PortRequest::EStop => Relayed::of(&Done {
                    state: "stopping",
                    sentence: "Stopping: the lab page's server passed it on.".to_owned(),
                }),
                PortRequest::Status if self.state().is_some() => Relayed::of(&Done {
                    state: self.state().map_or("stopping", state),
                    sentence: "By the robot's last report.".to_owned(),
                }),
                _ => Relayed::refused(format!(
                    "the lab page's server has {} and asks the robot nothing by itself: look at the page, or end `swimmer lab`",
                    self.name
                )),
            };
            requester.answer(&answer);
        }
    }
}

fn bytes_per_second(means: &Means) -> f64 {
    f64::from(means.baud) / 10.0
}
