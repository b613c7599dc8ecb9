//! Blocking calls to a robot over any port. The [`Session`] is the state machine; this module moves its bytes and waits, in one
//! loop (`connection`).

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

/// Longest interval between two calls of a callback while nothing happens.
const BEAT: Duration = Duration::from_millis(20);

/// Callback for each telemetry frame, with its time of arrival on the port's clock.
pub type Observer = Box<dyn FnMut(&Telemetry, Duration) + Send>;

/// Cause that ended the motion after a stop was sent.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum StoppedBy {
    /// The stop: the robot replied to it.
    Request,
    /// The robot itself, for this cause, according to telemetry; there was no reply to the stop.
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

/// Robot at the far end of a port.
///
/// The robot stops without a fresh keep-alive for half a second. Every method renews the lease while it waits, but nothing does
/// between calls, so call [`listen`](Robot::listen) there.
pub struct Robot<P> {
    connection: Connection<P>,
    hello: HelloReply,
}

impl<P: Port> Robot<P> {
    /// Greets the robot at `port`. `seed` must differ between programs and runs (for example time and process id); tests use a
    /// constant.
    ///
    /// # Errors
    /// No reply, incompatible versions, or a failed port.
    pub fn connect(port: P, seed: u64) -> Result<Self, LinkError> {
        Self::connect_with(port, SessionConfig::new(seed))
    }

    /// [`connect`](Self::connect) with all settings of a session.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn connect_with(port: P, config: SessionConfig) -> Result<Self, LinkError> {
        Self::connect_observed(port, config, Callbacks::default())
    }

    /// [`connect_with`](Self::connect_with) with callbacks, which also run during the greeting.
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

    /// Sends a stop without a greeting, until it gets a reply: the fastest stop. Returns the port and the cause that ended the
    /// motion, because the robot may stop by itself while the stop waits behind other bytes.
    ///
    /// # Errors
    /// No reply, or a failed port.
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

    /// Greets again: after a link error, or to take over the robot. The motion continues.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn reconnect(&mut self) -> Result<(), LinkError> {
        self.hello = greet(&mut self.connection)?;
        Ok(())
    }

    /// Continues over another port, for example after a Bluetooth module reconnected under a new handle. Greets again.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn replace_port(&mut self, port: P) -> Result<P, LinkError> {
        let old = self.connection.replace_port(port);
        self.reconnect().map(|()| old)
    }

    /// Reply of the robot to the greeting.
    pub fn info(&self) -> &HelloReply {
        &self.hello
    }

    /// Version and commit of the firmware, as text.
    pub fn firmware(&self) -> String {
        crate::session::firmware_name(&self.hello.firmware)
    }

    /// Counts of the link at the host. [`counters`](Self::counters) returns the robot's counts.
    pub fn link_counters(&self) -> LinkCounters {
        self.connection.session.counters()
    }

    /// Fit of the robot's clock to the port's clock. Returns `None` before the first reply to a ping.
    pub fn clock(&self) -> Option<ClockFit> {
        self.connection.session.clock()
    }

    /// Returns true if the robot has proved in this session that it has the key, by signed replies. `None` without a key.
    pub fn answers_signed(&self) -> Option<bool> {
        self.connection.session.answers_signed()
    }

    /// Latest telemetry.
    pub fn telemetry(&self) -> Option<&Telemetry> {
        self.connection.latest.as_ref()
    }

    /// Sets the callback for telemetry.
    pub fn observe(&mut self, observer: Observer) {
        self.connection.observer = Some(observer);
    }

    /// Port of the robot.
    pub fn port(&self) -> &P {
        &self.connection.port
    }

    /// Port of the robot.
    pub fn port_mut(&mut self) -> &mut P {
        &mut self.connection.port
    }

    /// Wraps or replaces the port and keeps the session, for example to add a trace.
    pub fn map_port<Q: Port>(self, wrap: impl FnOnce(P) -> Q) -> Robot<Q> {
        Robot {
            connection: self.connection.map_port(wrap),
            hello: self.hello,
        }
    }

    /// Returns the port and leaves the robot unchanged. Unless it plays detached, it stops when its lease runs out.
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

    /// Keeps the session alive for `time`, or until `watch` breaks. `watch` runs after each telemetry frame, and at least every
    /// 20 ms of the port's clock with the latest one, if any.
    ///
    /// # Errors
    /// The port failed, or no valid frame arrived for 5 s.
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

    /// Uploads a gait table (four bytes per knot, as `gait-player` writes it) and makes it active. Takes at most `patience`.
    /// Repeating a failed upload of the same table resumes it. `progress` runs after each step and may cancel the upload.
    ///
    /// # Errors
    /// [`LinkError::Refused`] with the invalid knot or angle, [`LinkError::Silent`], [`LinkError::Deadline`],
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

    /// Expected duration of [`upload`](Self::upload) for a table of `bytes` without losses, while the robot is at rest; zero
    /// without a session.
    pub fn expected_upload(&self, bytes: usize) -> Duration {
        self.connection
            .session
            .expected_upload(bytes)
            .unwrap_or_default()
    }

    /// Sends a request and waits for its reply. A refusal is an error.
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

/// Cause that ended the motion, from the event that ended a stop.
fn stopped_by(event: &Event) -> StoppedBy {
    match event {
        Event::StoppedByItself { cause, .. } => StoppedBy::Itself(*cause),
        _ => StoppedBy::Request,
    }
}
