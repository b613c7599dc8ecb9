//! Port and session of a robot, and the loop in which every blocking call waits.

use std::fmt;
use std::io;
use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{Request, Telemetry};

use super::{BEAT, Observer};
use crate::port::{Port, SendQueue};
use crate::session::{Event, LinkError, Session, Ticket};

/// Duration of a silence after which it is reported.
pub const SILENCE_REPORTED: Duration = Duration::from_secs(2);
/// Shortest wait: a virtual clock advances only during waits.
const SHORTEST_WAIT: Duration = Duration::from_micros(100);
/// Pause before the remaining bytes are offered to a full port again.
const OFFER_AGAIN: Duration = Duration::from_millis(2);
/// Time without an accepted byte after which a port has failed.
const STUCK: Duration = Duration::from_secs(1);
/// Longest gap between two reads of the port that counts as listening.
const LISTENING: Duration = Duration::from_millis(500);

/// Report of a silent link, or of the end of the silence.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Silence {
    /// No valid frame for [`SILENCE_REPORTED`]; the call keeps trying.
    Began {
        /// Completes "while …".
        doing: &'static str,
        /// Time without a valid frame.
        silent: Duration,
    },
    /// A valid frame arrived.
    Ended {
        /// Duration of the silence.
        silent: Duration,
    },
}

impl fmt::Display for Silence {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Began { doing, silent } => write!(
                f,
                "while {doing}: no valid frame from the robot for {:.1} s; still trying",
                silent.as_secs_f64()
            ),
            Self::Ended { silent } => write!(
                f,
                "the robot replies again after {:.1} s of silence",
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

/// Callbacks of a blocking robot, which run during waits.
#[derive(Default)]
pub struct Callbacks {
    /// Receives the reports of a silent link.
    pub silence: Option<Box<dyn FnMut(Silence) + Send>>,
    /// Polled every 20 ms while a request waits for its reply. A stop ends that wait and is sent at once. Also polled while the
    /// program itself stops the robot; that result is ignored.
    pub halt: Option<Box<dyn FnMut() -> Option<Halt> + Send>>,
}

/// Port and session, with their latest results.
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
    /// Time of the last read of the port.
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

    /// Wraps the port and keeps the connection.
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

    /// Replaces the port; unsent bytes of the old one are lost.
    pub(super) fn replace_port(&mut self, port: P) -> P {
        self.queue = SendQueue::default();
        self.looked = None;
        std::mem::replace(&mut self.port, port)
    }

    pub(super) fn now(&self) -> Duration {
        self.port.now()
    }

    /// [`wait_by`](Self::wait_by) without a deadline.
    ///
    /// # Errors
    /// As for [`wait_by`](Self::wait_by).
    pub(super) fn wait<T>(
        &mut self,
        doing: &'static str,
        each: impl FnMut(&mut Self, Option<Event>) -> Result<ControlFlow<T>, LinkError>,
    ) -> Result<T, LinkError> {
        self.wait_by(doing, Duration::MAX, each)
    }

    /// Moves bytes and passes each event to `each` until it breaks; passes `None` at least every 20 ms of the port's clock and
    /// at `end`. This is the only waiting loop of the crate.
    ///
    /// # Errors
    /// Errors of the port and of `each`.
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
    /// Errors of the ticket and the port; [`LinkError::Dropped`] if the caller's [`Callbacks::halt`] ended the wait.
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

    /// Sends a stop and waits for the event that ends it. An e-stop requested meanwhile replaces it.
    ///
    /// # Errors
    /// No reply, or an error of the port.
    pub(super) fn halt(&mut self, halt: Halt, doing: &'static str) -> Result<Event, LinkError> {
        let mut halt = match self.requested_halt() {
            Some(Halt::EStop) => Halt::EStop,
            _ => halt,
        };
        let mut ticket = self.session.request(self.now(), halt.into());
        // Telemetry from before the stop does not describe the motion after it.
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

    /// Moves bytes until an event arrives or `until` has passed.
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

    /// Reports a long silence, and its end.
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
