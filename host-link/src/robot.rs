//! Blocking calls to a robot over any port. The [`Session`] decides everything; this module moves its bytes and waits, in one loop
//! (`connection`).

pub mod await_play;
mod connection;
mod requests;
pub mod sequence;

pub use await_play::time_left;
pub use connection::{Callbacks, Halt, SILENCE_REPORTED, Silence};
pub use sequence::{Leg, Sequence, SequenceProgress};

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{HelloReply, Reply, Request, StopCause, TableInfo, Telemetry};

use self::connection::Connection;
use crate::port::Port;
use crate::session::{
    ClockFit, Event, LONGEST_SILENCE, LinkCounters, LinkError, Session, SessionConfig,
    UploadProgress, cause_in_words,
};

/// How often a caller is asked whether to go on while nothing happens.
const BEAT: Duration = Duration::from_millis(20);

/// Sees every piece of telemetry and when it arrived, on the port's clock.
pub type Observer = Box<dyn FnMut(&Telemetry, Duration) + Send>;

/// What ended the motion after a stop was sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// The stop: the robot answered it.
    Request,
    /// The robot itself, for this reason, by its telemetry; the stop's answer has not come.
    Itself(StopCause),
}

impl std::fmt::Display for StoppedBy {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Request => write!(f, "the robot answered the stop"),
            Self::Itself(cause) => write!(
                f,
                "the robot has stopped by itself ({}); the stop is still on its way",
                cause_in_words(*cause)
            ),
        }
    }
}

/// A robot behind a port.
///
/// The robot stops by itself when it hears nothing fresh for half a second, so that between requests somebody must
/// [`listen`](Robot::listen): every method here keeps the lease fed while it waits, and none does between calls.
pub struct Robot<P> {
    connection: Connection<P>,
    hello: HelloReply,
}

impl<P: Port> Robot<P> {
    /// Greets the robot behind `port`. `seed` must differ between programs and runs (the time and the process, say); tests
    /// give a constant.
    ///
    /// # Errors
    /// No answer, versions that do not meet, a port that failed.
    pub fn connect(port: P, seed: u64) -> Result<Self, LinkError> {
        Self::connect_with(port, SessionConfig::new(seed))
    }

    /// [`connect`](Self::connect) with every setting of a session.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn connect_with(port: P, config: SessionConfig) -> Result<Self, LinkError> {
        Self::connect_observed(port, config, Callbacks::default())
    }

    /// [`connect_with`](Self::connect_with) with callbacks, which are called while the robot is greeted too.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn connect_observed(
        port: P,
        config: SessionConfig,
        callbacks: Callbacks,
    ) -> Result<Self, LinkError> {
        let mut connection = Connection::new(port, Session::new(config), callbacks);
        let hello = greet(&mut connection)?;
        Ok(Self { connection, hello })
    }

    /// Sends a stop without greeting first, until it is answered: the quickest way to a robot at rest.
    /// Returns the port, and what ended the motion: where the stop waits behind other bytes, the robot may have
    /// stopped by itself before.
    ///
    /// # Errors
    /// No answer, or a port that failed.
    pub fn stop_at_once(
        port: P,
        seed: u64,
        halt: Halt,
        callbacks: Callbacks,
    ) -> Result<(P, StoppedBy), LinkError> {
        let session = Session::new(SessionConfig::new(seed));
        let mut connection = Connection::new(port, session, callbacks);
        let by = stopped_by(&connection.halt(halt, "stopping")?);
        Ok((connection.port, by))
    }

    /// Greets again: after an error of the link, or to take a robot back. The robot's motion is left as it is.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn reconnect(&mut self) -> Result<(), LinkError> {
        self.hello = greet(&mut self.connection)?;
        Ok(())
    }

    /// Goes on over another port, as after a Bluetooth module came back under a new handle. Greets again.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn replace_port(&mut self, port: P) -> Result<P, LinkError> {
        let old = self.connection.replace_port(port);
        self.reconnect().map(|()| old)
    }

    /// What the robot said of itself when it was greeted.
    pub fn info(&self) -> &HelloReply {
        &self.hello
    }

    /// The firmware's version and commit in words.
    pub fn firmware(&self) -> String {
        crate::session::firmware_name(&self.hello.firmware)
    }

    /// What crossed the link so far, as counted here. (What the robot counted: [`counters`](Self::counters).)
    pub fn link_counters(&self) -> LinkCounters {
        self.connection.session.counters()
    }

    /// The robot's clock on the port's; `None` before the first ping came back.
    pub fn clock(&self) -> Option<ClockFit> {
        self.connection.session.clock()
    }

    /// Whether the robot has shown in this session that it has the key: it signs its answers. `None` without a key.
    pub fn answers_signed(&self) -> Option<bool> {
        self.connection.session.answers_signed()
    }

    /// The last telemetry that came.
    pub fn telemetry(&self) -> Option<&Telemetry> {
        self.connection.latest.as_ref()
    }

    /// Shows every later piece of telemetry to `observer`.
    pub fn observe(&mut self, observer: Observer) {
        self.connection.observer = Some(observer);
    }

    /// The port.
    pub fn port(&self) -> &P {
        &self.connection.port
    }

    /// The port.
    pub fn port_mut(&mut self) -> &mut P {
        &mut self.connection.port
    }

    /// Puts another port around or in place of the present one, with the session as it is: a trace, say.
    pub fn map_port<Q: Port>(self, wrap: impl FnOnce(P) -> Q) -> Robot<Q> {
        Robot {
            connection: self.connection.map_port(wrap),
            hello: self.hello,
        }
    }

    /// Leaves the robot as it is and returns the port. Unless it plays detached, the robot stops when its lease ends.
    pub fn into_port(self) -> P {
        self.connection.port
    }

    /// Replaces the callbacks.
    pub fn call_back(&mut self, callbacks: Callbacks) {
        self.connection.callbacks = callbacks;
    }

    /// Replaces the callback that ends a wait by a stop ([`Callbacks::halt`]).
    pub fn halt_when(&mut self, halt: Box<dyn FnMut() -> Option<Halt> + Send>) {
        self.connection.callbacks.halt = Some(halt);
    }

    /// Keeps the session alive for `time`, or until `watch` breaks; `watch` is asked after each telemetry, and with the last
    /// one (or none yet) at least every 20 ms of the port's clock.
    ///
    /// # Errors
    /// The port failed, or nothing valid was heard for 5 s.
    pub fn listen(
        &mut self,
        time: Duration,
        mut watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<(), LinkError> {
        let doing = "listening to the robot";
        let end = self.connection.now() + time;
        if time.is_zero() {
            return Ok(());
        }
        self.connection.wait_by(doing, end, |connection, _| {
            if watch(connection.latest.as_ref()).is_break() {
                return Ok(ControlFlow::Break(()));
            }
            check_heard(connection, doing)?;
            Ok(if connection.now() < end {
                ControlFlow::Continue(())
            } else {
                ControlFlow::Break(())
            })
        })
    }

    /// Uploads a gait table (four bytes a knot, as `gait-player` writes it) and makes it the active one. Takes at most
    /// `patience`; a failed upload of the same table goes on where it was. `progress` sees each step and may break off.
    ///
    /// # Errors
    /// [`LinkError::Refused`] with the knot or angle that does not pass, [`LinkError::Silent`], [`LinkError::Deadline`],
    /// [`LinkError::Interrupted`].
    pub fn upload(
        &mut self,
        table: &[u8],
        patience: Duration,
        mut progress: impl FnMut(UploadProgress) -> ControlFlow<()>,
    ) -> Result<TableInfo, LinkError> {
        let doing = "uploading the gait";
        let now = self.connection.now();
        let wanted = self
            .connection
            .session
            .upload(now, 0, table, now + patience);
        let mut last = UploadProgress {
            phase: crate::session::UploadPhase::Begin,
            done: 0,
            total: table.len(),
        };
        self.connection.wait(doing, |connection, event| {
            match event {
                Some(Event::Uploaded { ticket, table }) if ticket == wanted => {
                    return Ok(ControlFlow::Break(table));
                }
                Some(Event::Failed { ticket, error }) if ticket == wanted => return Err(error),
                Some(Event::Progress {
                    ticket,
                    progress: now,
                }) if ticket == wanted => last = now,
                _ => {}
            }
            if progress(last).is_break() {
                connection.session.cancel_upload();
                return Err(LinkError::Interrupted { doing });
            }
            Ok(ControlFlow::Continue(()))
        })
    }

    /// What [`upload`](Self::upload) takes for a table of `bytes` where nothing is lost and the robot stands still; zero without a
    /// session.
    pub fn expected_upload(&self, bytes: usize) -> Duration {
        self.connection
            .session
            .expected_upload(bytes)
            .unwrap_or_default()
    }

    /// Sends a request and waits for its reply, which is not a refusal.
    fn ask(&mut self, request: Request, doing: &'static str) -> Result<Reply, LinkError> {
        let now = self.connection.now();
        let ticket = self.connection.session.request(now, request);
        match self.connection.outcome(ticket, doing)? {
            Event::Answered { reply, .. } => Ok(reply),
            event => Err(LinkError::WrongReply {
                doing,
                reply: format!("{event:?}"),
            }),
        }
    }
}

/// Opens a session.
fn greet<P: Port>(connection: &mut Connection<P>) -> Result<HelloReply, LinkError> {
    let doing = "connecting";
    let now = connection.now();
    let ticket = connection.session.connect(now);
    connection.outcome(ticket, doing)?;
    connection
        .session
        .hello()
        .copied()
        .ok_or(LinkError::NotConnected { doing })
}

fn check_heard<P: Port>(connection: &Connection<P>, doing: &'static str) -> Result<(), LinkError> {
    let silent = connection
        .now()
        .saturating_sub(connection.session.last_heard());
    if silent < LONGEST_SILENCE {
        return Ok(());
    }
    let counters = Box::new(connection.session.counters());
    Err(LinkError::Silent {
        doing,
        silent,
        counters,
    })
}

/// What ended the motion, by the event that ended a stop.
fn stopped_by(event: &Event) -> StoppedBy {
    match event {
        Event::StoppedByItself { cause, .. } => StoppedBy::Itself(*cause),
        _ => StoppedBy::Request,
    }
}
