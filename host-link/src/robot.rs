//! A robot as a program uses it: blocking calls over any port. Everything is decided in the [`Session`]; this moves its
//! bytes and waits.

pub mod await_play;
mod requests;
pub mod sequence;

pub use await_play::time_left;
pub use sequence::{Leg, Sequence, SequenceProgress};

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{HelloReply, Reply, Request, StopCause, TableInfo, Telemetry};

use crate::port::Port;
use crate::session::{
    ClockFit, Event, LONGEST_SILENCE, LinkCounters, LinkError, Session, SessionConfig, Ticket,
    UploadProgress, cause_in_words,
};

/// How often a caller is asked whether to go on while nothing happens.
const BEAT: Duration = Duration::from_millis(20);

/// A virtual clock moves only while somebody waits.
const SHORTEST_WAIT: Duration = Duration::from_micros(100);

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
    port: P,
    session: Session,
    hello: HelloReply,
    latest: Option<Telemetry>,
    observer: Option<Observer>,
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

    /// [`connect`](Self::connect) with everything a session can be told.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn connect_with(port: P, config: SessionConfig) -> Result<Self, LinkError> {
        let mut shell = Shell {
            port,
            session: Session::new(config),
        };
        let now = shell.port.now();
        let ticket = shell.session.connect(now);
        let hello = shell.wait_connected(ticket)?;
        let Shell { port, session } = shell;
        Ok(Self {
            port,
            session,
            hello,
            latest: None,
            observer: None,
        })
    }

    /// Sends a stop, or an e-stop, without greeting first, until it is answered: the quickest way to a robot at rest.
    /// Gives the port back, and says what ended the motion: where the stop waits behind other bytes, the robot may have
    /// stopped by itself before.
    ///
    /// # Errors
    /// No answer, or a port that failed.
    pub fn stop_at_once(port: P, seed: u64, estop: bool) -> Result<(P, StoppedBy), LinkError> {
        let mut shell = Shell {
            port,
            session: Session::new(SessionConfig::new(seed)),
        };
        let request = if estop { Request::EStop } else { Request::Stop };
        let now = shell.port.now();
        let ticket = shell.session.request(now, request);
        loop {
            match shell.step(now + Duration::from_hours(1), "stopping")? {
                Some(Event::Answered {
                    ticket: answered, ..
                }) if answered == ticket => return Ok((shell.port, StoppedBy::Request)),
                Some(Event::StoppedByItself {
                    ticket: stopped,
                    cause,
                }) if stopped == ticket => return Ok((shell.port, StoppedBy::Itself(cause))),
                Some(Event::Failed {
                    ticket: failed,
                    error,
                }) if failed == ticket => return Err(error),
                _ => {}
            }
        }
    }

    /// Greets again: after an error of the link, or to take a robot back. The robot's motion is left as it is.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn reconnect(&mut self) -> Result<(), LinkError> {
        let now = self.port.now();
        let ticket = self.session.connect(now);
        loop {
            match self.step(now + Duration::from_hours(1), "connecting")? {
                Some(Event::Connected {
                    ticket: connected, ..
                }) if connected == ticket => {
                    if let Some(hello) = self.session.hello() {
                        self.hello = *hello;
                    }
                    return Ok(());
                }
                Some(Event::Failed {
                    ticket: failed,
                    error,
                }) if failed == ticket => return Err(error),
                _ => {}
            }
        }
    }

    /// Goes on over another port, as after a Bluetooth module came back under a new handle. Greets again.
    ///
    /// # Errors
    /// As [`connect`](Self::connect).
    pub fn replace_port(&mut self, port: P) -> Result<P, LinkError> {
        let old = std::mem::replace(&mut self.port, port);
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
        self.session.counters()
    }

    /// The robot's clock on the port's; `None` before the first ping came back.
    pub fn clock(&self) -> Option<ClockFit> {
        self.session.clock()
    }

    /// Whether the robot has shown in this session that it has the key: it signs its answers. `None` without a key.
    pub fn answers_signed(&self) -> Option<bool> {
        self.session.answers_signed()
    }

    /// The last telemetry that came.
    pub fn telemetry(&self) -> Option<&Telemetry> {
        self.latest.as_ref()
    }

    /// Shows every later piece of telemetry to `observer`.
    pub fn observe(&mut self, observer: Observer) {
        self.observer = Some(observer);
    }

    /// The port.
    pub fn port(&self) -> &P {
        &self.port
    }

    /// The port.
    pub fn port_mut(&mut self) -> &mut P {
        &mut self.port
    }

    /// Puts another port around or in place of the present one, with the session as it is: a trace, say.
    pub fn map_port<Q: Port>(self, wrap: impl FnOnce(P) -> Q) -> Robot<Q> {
        Robot {
            port: wrap(self.port),
            session: self.session,
            hello: self.hello,
            latest: self.latest,
            observer: self.observer,
        }
    }

    /// Leaves the robot as it is and gives the port back. Unless it plays detached, the robot stops when its lease ends.
    pub fn into_port(self) -> P {
        self.port
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
        let end = self.port.now() + time;
        while self.port.now() < end {
            let beat = (self.port.now() + BEAT).min(end);
            self.step(beat, doing)?;
            if watch(self.latest.as_ref()).is_break() {
                return Ok(());
            }
            self.check_heard(doing)?;
        }
        Ok(())
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
        let now = self.port.now();
        let wanted = self.session.upload(now, 0, table, now + patience);
        let mut last = UploadProgress {
            phase: crate::session::UploadPhase::Begin,
            done: 0,
            total: table.len(),
        };
        loop {
            let beat = self.port.now() + BEAT;
            match self.step(beat, doing)? {
                Some(Event::Uploaded { ticket, table }) if ticket == wanted => return Ok(table),
                Some(Event::Failed { ticket, error }) if ticket == wanted => return Err(error),
                Some(Event::Progress {
                    ticket,
                    progress: now,
                }) if ticket == wanted => last = now,
                _ => {}
            }
            if progress(last).is_break() {
                self.session.cancel_upload();
                return Err(LinkError::Interrupted { doing });
            }
        }
    }

    /// What [`upload`](Self::upload) takes for a table of `bytes` where nothing is lost and the robot stands still; zero without a
    /// session.
    pub fn expected_upload(&self, bytes: usize) -> Duration {
        self.session.expected_upload(bytes).unwrap_or_default()
    }

    fn check_heard(&self, doing: &'static str) -> Result<(), LinkError> {
        let silent = self.port.now().saturating_sub(self.session.last_heard());
        if silent < LONGEST_SILENCE {
            return Ok(());
        }
        let counters = Box::new(self.session.counters());
        Err(LinkError::Silent {
            doing,
            silent,
            counters,
        })
    }

    /// Asks and waits for the answer, which is no refusal.
    fn ask(&mut self, request: Request, doing: &'static str) -> Result<Reply, LinkError> {
        let now = self.port.now();
        let wanted = self.session.request(now, request);
        loop {
            match self.step(self.port.now() + BEAT, doing)? {
                Some(Event::Answered { ticket, reply }) if ticket == wanted => return Ok(reply),
                Some(Event::Failed { ticket, error }) if ticket == wanted => return Err(error),
                _ => {}
            }
        }
    }

    /// Moves bytes until an event comes or `until` has passed.
    fn step(&mut self, until: Duration, doing: &'static str) -> Result<Option<Event>, LinkError> {
        let event = step(&mut self.port, &mut self.session, until, doing)?;
        if let Some(Event::Telemetry { telemetry, at }) = &event {
            if let Some(observer) = &mut self.observer {
                observer(telemetry, *at);
            }
            self.latest = Some(*telemetry);
        }
        Ok(event)
    }
}

/// A port and a session that have no robot yet.
struct Shell<P> {
    port: P,
    session: Session,
}

impl<P: Port> Shell<P> {
    fn step(&mut self, until: Duration, doing: &'static str) -> Result<Option<Event>, LinkError> {
        step(&mut self.port, &mut self.session, until, doing)
    }

    fn wait_connected(&mut self, wanted: Ticket) -> Result<HelloReply, LinkError> {
        let doing = "connecting";
        loop {
            let beat = self.port.now() + BEAT;
            match self.step(beat, doing)? {
                Some(Event::Connected { ticket, .. }) if ticket == wanted => {
                    return self
                        .session
                        .hello()
                        .copied()
                        .ok_or(LinkError::NotConnected { doing });
                }
                Some(Event::Failed { ticket, error }) if ticket == wanted => return Err(error),
                _ => {}
            }
        }
    }
}

fn step<P: Port>(
    port: &mut P,
    session: &mut Session,
    until: Duration,
    doing: &'static str,
) -> Result<Option<Event>, LinkError> {
    let fail = |source| LinkError::Port { doing, source };
    loop {
        let now = port.now();
        session.poll(now);
        let outgoing = session.take_outgoing();
        if !outgoing.is_empty() {
            port.write(&outgoing).map_err(fail)?;
        }
        if let Some(event) = session.next_event() {
            return Ok(Some(event));
        }
        if now >= until {
            return Ok(None);
        }
        let wake = session
            .next_deadline()
            .map_or(until, |deadline| deadline.min(until));
        let mut buf = [0; 512];
        let count = port
            .read(&mut buf, wake.saturating_sub(now).max(SHORTEST_WAIT))
            .map_err(fail)?;
        if count > 0 {
            session.receive(port.now(), buf.get(..count).unwrap_or(&buf));
        }
    }
}
