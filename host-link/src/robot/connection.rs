//! Port and session of a robot, and the one loop in which every blocking call waits.

use std::fmt;
use std::io;
use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{Request, Telemetry};

use super::{BEAT, Observer};
use crate::port::{Port, SendQueue};
use crate::session::{Event, LinkError, Session, Ticket};

/// Silence after which it is reported.
pub const SILENCE_REPORTED: Duration = Duration::from_secs(2);
/// A virtual clock moves only while somebody waits.
const SHORTEST_WAIT: Duration = Duration::from_micros(100);
/// Wait before a port that took not all of the bytes is offered the rest.
const OFFER_AGAIN: Duration = Duration::from_millis(2);
/// A port that takes no byte for so long has failed.
const STUCK: Duration = Duration::from_secs(1);
/// Longest gap between two looks at the port that counts as listening.
const LISTENING: Duration = Duration::from_millis(500);

/// Report of a silent link, and of its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Silence {
    /// No valid frame has come for [`SILENCE_REPORTED`]; the call goes on trying.
    Began {
        /// Completes "while …".
        doing: &'static str,
        /// Time without a valid frame.
        silent: Duration,
    },
    /// A valid frame came again.
    Ended {
        /// Time that passed without one.
        silent: Duration,
    },
}

impl fmt::Display for Silence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Began { doing, silent } => write!(
                f,
                "while {doing}: nothing valid heard from the robot for {:.1} s; still trying",
                silent.as_secs_f64()
            ),
            Self::Ended { silent } => write!(
                f,
                "the robot is heard again after {:.1} s of silence",
                silent.as_secs_f64()
            ),
        }
    }
}

/// Kind of a stop.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Halt {
    /// Ramp to neutral.
    Stop,
    /// Pulses off at once.
    EStop,
}

impl From<Halt> for Request {
    fn from(halt: Halt) -> Self {
        match halt {
            Halt::Stop => Self::Stop,
            Halt::EStop => Self::EStop,
        }
    }
}

/// Callbacks of a blocking robot, called while it waits.
#[derive(Default)]
pub struct Callbacks {
    /// Gets the report of a silent link.
    pub silence: Option<Box<dyn FnMut(Silence) + Send>>,
    /// Looked at every 20 ms while a request waits for its reply: a stop ends that wait, and goes out at once. Also looked at when
    /// the program itself stops the robot; then the result is dropped.
    pub halt: Option<Box<dyn FnMut() -> Option<Halt> + Send>>,
}

/// Port and session, with what came of them last.
pub(super) struct Connection<P> {
    pub(super) port: P,
    pub(super) session: Session,
    pub(super) latest: Option<Telemetry>,
    pub(super) observer: Option<Observer>,
    pub(super) callbacks: Callbacks,
    queue: SendQueue,
    /// Start of the present silence.
    silent_since: Duration,
    silence_reported: bool,
    /// Last look at the port.
    looked: Option<Duration>,
}

impl<P: Port> Connection<P> {
    pub(super) fn new(port: P, session: Session, callbacks: Callbacks) -> Self {
        Self {
            port,
            session,
            latest: None,
            observer: None,
            callbacks,
            queue: SendQueue::default(),
            silent_since: Duration::ZERO,
            silence_reported: false,
            looked: None,
        }
    }

    /// The same connection over a port around the present one.
    pub(super) fn map_port<Q: Port>(self, wrap: impl FnOnce(P) -> Q) -> Connection<Q> {
        Connection {
            port: wrap(self.port),
            session: self.session,
            latest: self.latest,
            observer: self.observer,
            callbacks: self.callbacks,
            queue: self.queue,
            silent_since: self.silent_since,
            silence_reported: self.silence_reported,
            looked: self.looked,
        }
    }

    /// Goes on over another port; what the old one had not taken is lost.
    pub(super) fn replace_port(&mut self, port: P) -> P {
        self.queue = SendQueue::default();
        self.looked = None;
        std::mem::replace(&mut self.port, port)
    }

    pub(super) fn now(&self) -> Duration {
        self.port.now()
    }

    /// [`wait_by`](Self::wait_by) without an end.
    ///
    /// # Errors
    /// As there.
    pub(super) fn wait<T>(
        &mut self,
        doing: &'static str,
        each: impl FnMut(&mut Self, Option<Event>) -> Result<ControlFlow<T>, LinkError>,
    ) -> Result<T, LinkError> {
        self.wait_by(doing, Duration::MAX, each)
    }

    /// Moves bytes and passes each event to `each`, `None` at least every 20 ms of the port's clock and at `end`, until it breaks.
    /// No other loop of this crate waits for a robot.
    ///
    /// # Errors
    /// The port's, and those of `each`.
    pub(super) fn wait_by<T>(
        &mut self,
        doing: &'static str,
        end: Duration,
        mut each: impl FnMut(&mut Self, Option<Event>) -> Result<ControlFlow<T>, LinkError>,
    ) -> Result<T, LinkError> {
        let now = self.now();
        let listening = self
            .looked
            .is_some_and(|looked| now.saturating_sub(looked) < LISTENING);
        if !listening {
            self.silent_since = now;
        }
        loop {
            let event = self.step((self.now() + BEAT).min(end), doing)?;
            self.watch_silence(doing);
            if let ControlFlow::Break(result) = each(self, event)? {
                return Ok(result);
            }
        }
    }

    /// Waits for the event that ends `ticket`.
    ///
    /// # Errors
    /// The ticket's, the port's; [`LinkError::Dropped`] if the caller's [`Callbacks::halt`] ended the wait.
    pub(super) fn outcome(
        &mut self,
        ticket: Ticket,
        doing: &'static str,
    ) -> Result<Event, LinkError> {
        let mut halting = None;
        self.wait(doing, |connection, event| {
            match event {
                Some(event) if halting.is_some() && event.ended() == halting => {
                    return Err(match event {
                        Event::Failed { error, .. } => error,
                        _ => LinkError::Dropped { doing },
                    });
                }
                Some(event) if halting.is_none() && event.ended() == Some(ticket) => {
                    return match event {
                        Event::Failed { error, .. } => Err(error),
                        event => Ok(ControlFlow::Break(event)),
                    };
                }
                _ => {}
            }
            if halting.is_none()
                && let Some(halt) = connection.requested_halt()
            {
                let now = connection.now();
                halting = Some(connection.session.request(now, halt.into()));
            }
            Ok(ControlFlow::Continue(()))
        })
    }

    /// Sends a stop and waits for what ends it. An e-stop that the caller requests meanwhile takes its place.
    ///
    /// # Errors
    /// No reply, or the port's.
    pub(super) fn halt(&mut self, halt: Halt, doing: &'static str) -> Result<Event, LinkError> {
        let mut halt = match self.requested_halt() {
            Some(Halt::EStop) => Halt::EStop,
            _ => halt,
        };
        let mut ticket = self.session.request(self.now(), halt.into());
        // Telemetry from before the stop says nothing about the motion after it.
        self.latest = None;
        self.wait(doing, |connection, event| {
            match event {
                Some(event) if event.ended() == Some(ticket) => {
                    return match event {
                        Event::Failed { error, .. } => Err(error),
                        event => Ok(ControlFlow::Break(event)),
                    };
                }
                _ => {}
            }
            if halt == Halt::Stop && connection.requested_halt() == Some(Halt::EStop) {
                halt = Halt::EStop;
                let now = connection.now();
                ticket = connection.session.request(now, halt.into());
            }
            Ok(ControlFlow::Continue(()))
        })
    }

    fn requested_halt(&mut self) -> Option<Halt> {
        self.callbacks.halt.as_mut().and_then(|halt| halt())
    }

    /// Moves bytes until an event comes or `until` has passed.
    fn step(&mut self, until: Duration, doing: &'static str) -> Result<Option<Event>, LinkError> {
        let fail = |source| LinkError::Port { doing, source };
        loop {
            let now = self.now();
            self.looked = Some(now);
            self.session.poll(now);
            let outgoing = self.session.take_outgoing();
            self.queue.push(&outgoing);
            self.queue.drive(&mut self.port).map_err(fail)?;
            if self.queue.stuck_for(now) >= STUCK {
                return Err(fail(io::ErrorKind::TimedOut.into()));
            }
            if let Some(event) = self.session.next_event() {
                if let Event::Telemetry { telemetry, at } = &event {
                    if let Some(observer) = &mut self.observer {
                        observer(telemetry, *at);
                    }
                    self.latest = Some(*telemetry);
                }
                return Ok(Some(event));
            }
            if now >= until {
                return Ok(None);
            }
            let mut wake = self
                .session
                .next_deadline()
                .map_or(until, |deadline| deadline.min(until));
            if !self.queue.is_empty() {
                wake = wake.min(now + OFFER_AGAIN);
            }
            let mut buf = [0; 512];
            let count = self
                .port
                .read(&mut buf, wake.saturating_sub(now).max(SHORTEST_WAIT))
                .map_err(fail)?;
            if count > 0 {
                let bytes = buf.get(..count).unwrap_or(&buf);
                self.session.receive(self.port.now(), bytes);
            }
        }
    }

    /// Reports a silence that has become long, and its end.
    fn watch_silence(&mut self, doing: &'static str) {
        let now = self.now();
        let heard = self.session.last_heard();
        if heard > self.silent_since {
            let silent = heard.saturating_sub(self.silent_since);
            self.silent_since = heard;
            if std::mem::take(&mut self.silence_reported) {
                self.report(Silence::Ended { silent });
            }
        }
        let silent = now.saturating_sub(self.silent_since);
        if silent >= SILENCE_REPORTED && !self.silence_reported {
            self.silence_reported = true;
            self.report(Silence::Began { doing, silent });
        }
    }

    fn report(&mut self, silence: Silence) {
        if let Some(report) = &mut self.callbacks.silence {
            report(silence);
        }
    }
}
