//! Waiting for the end of a play, over a link that comes and goes: a robot that is no longer heard is looked for, greeted
//! anew and asked what became of the play. It may have gone on (detached), stopped by itself, or restarted.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{Flags, Reply, Request, StateName, Status, StopCause, Telemetry};

use super::{BEAT, Robot};
use crate::port::Port;
use crate::session::{Event, LinkError, Ticket};

const WAITING: &str = "waiting for the end of the play";
/// Time after which the status is asked for when no telemetry tells it.
const QUIET: Duration = Duration::from_secs(1);
/// How long a robot that does not answer is looked for; one that plays detached until so long after its end.
const SEARCH: Duration = Duration::from_secs(30);
/// How long a robot that has told the end of its play is asked for its status as well. It may hear nothing any more: that is
/// the most frequent reason to stop.
const LAST_WORD: Duration = Duration::from_millis(1_500);

/// Time until the last cycle of a play is done; `None` where nothing plays, or without end. A pause and the soft start are
/// not counted: nobody knows when a pause ends, and a soft start takes two seconds at most.
pub fn time_left(status: &Status) -> Option<Duration> {
    let playing = matches!(
        status.state,
        StateName::Starting | StateName::Playing | StateName::Paused
    );
    if !playing || status.cycles == 0 {
        return None;
    }
    // In 2⁻¹⁶ of a cycle.
    let done = (u64::from(status.cycle) << 16) | u64::from(status.phase);
    let left = (u64::from(status.cycles) << 16).saturating_sub(done);
    let us = (u128::from(left) * u128::from(status.period_us)) >> 16;
    Some(Duration::from_micros(u64::try_from(us).unwrap_or(u64::MAX)))
}

/// What is known, and what was asked to know more.
struct Watch {
    /// When the robot last told something, on the port's clock.
    told: Duration,
    /// Until when a silent robot is looked for.
    search_until: Duration,
    asked: Option<Ticket>,
    greeted: Option<Ticket>,
    /// The status that came last.
    status: Option<Status>,
    /// The telemetry that told the end of the play, and when the first such came.
    ended: Option<(Duration, Telemetry)>,
}

impl Watch {
    /// What the robot told of its end, where it says no more than that.
    fn last_word(&self, now: Duration) -> Option<Status> {
        let (since, telemetry) = self.ended.as_ref()?;
        (now.saturating_sub(*since) >= LAST_WORD).then(|| told_by(telemetry, self.status.as_ref()))
    }
}

/// The status of a piece of telemetry, with what that does not hold from an earlier status.
fn told_by(telemetry: &Telemetry, before: Option<&Status>) -> Status {
    Status {
        robot_us: telemetry.robot_us,
        state: telemetry.state,
        cause: telemetry.cause,
        flags: telemetry.flags,
        cycle: telemetry.cycle,
        cycles: telemetry.cycles,
        period_us: before.map_or(0, |status| status.period_us),
        phase: telemetry.phase,
        setpoint: telemetry.setpoint,
        battery_mv: telemetry.battery_mv,
        table: before.and_then(|status| status.table),
        upload: before.and_then(|status| status.upload),
        settings_crc32: before.map_or(0, |status| status.settings_crc32),
        estops: before.map_or(0, |status| status.estops),
    }
}

impl<P: Port> Robot<P> {
    /// Waits until the robot has played its last cycle. `watch` sees each telemetry, at least every 20 ms of the port's
    /// clock, and may break off, which stops the robot. Where the link is lost meanwhile, the robot is looked for for 30 s,
    /// one that plays detached until 30 s after its end. A robot that still tells that its play is over is believed after
    /// 1.5 s, whether it answers or not.
    ///
    /// Returns the status at the end.
    ///
    /// # Errors
    /// [`LinkError::StoppedEarly`] when it stops for another reason, [`LinkError::Interrupted`] after breaking off (the stop
    /// was answered), and the link's own.
    pub fn wait_until_finished(
        &mut self,
        watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<Status, LinkError> {
        if let Some(status) = self.wait_while(watch)? {
            return Ok(status);
        }
        self.stop()?;
        Err(LinkError::Interrupted { doing: WAITING })
    }

    /// [`wait_until_finished`](Self::wait_until_finished) for a caller that has something else to do now and then: breaking
    /// off returns `None` and leaves the robot as it is. Waiting may go on afterwards.
    ///
    /// # Errors
    /// As there, but for the interruption.
    pub fn wait_while(
        &mut self,
        mut watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<Option<Status>, LinkError> {
        // What was said before the play began tells nothing about its end.
        self.latest = None;
        let now = self.port.now();
        let mut known = Watch {
            told: now,
            search_until: now + SEARCH,
            asked: Some(self.session.request(now, Request::Status)),
            greeted: None,
            status: None,
            ended: None,
        };
        loop {
            let beat = self.port.now() + BEAT;
            let event = self.step(beat, WAITING)?;
            if watch(self.latest.as_ref()).is_break() {
                return Ok(None);
            }
            if let Some(status) = self.learn(event, &mut known)? {
                return finished(status).map(Some);
            }
            if let Some(status) = known.last_word(self.port.now()) {
                if let Some(asked) = known.asked {
                    self.session.forget(asked);
                }
                return finished(status).map(Some);
            }
        }
    }

    /// Takes an event; gives the status where the play is over.
    fn learn(
        &mut self,
        event: Option<Event>,
        known: &mut Watch,
    ) -> Result<Option<Status>, LinkError> {
        let now = self.port.now();
        match event {
            Some(Event::Telemetry { telemetry, .. }) => {
                known.told = now;
                known.search_until = known.search_until.max(now + SEARCH);
                if at_rest(telemetry.state, telemetry.cause) {
                    let since = known.ended.map_or(now, |(since, _)| since);
                    known.ended = Some((since, telemetry));
                    self.ask_status(known);
                } else {
                    known.ended = None;
                }
            }
            Some(Event::Answered { ticket, reply }) if known.asked == Some(ticket) => {
                known.asked = None;
                known.told = now;
                if let Reply::Status(status) = reply {
                    known.status = Some(status);
                    if at_rest(status.state, status.cause) {
                        return Ok(Some(status));
                    }
                    let alone = status.flags.contains(Flags::DETACHED);
                    let left = time_left(&status).filter(|_| alone).unwrap_or_default();
                    known.search_until = now + left + SEARCH;
                }
            }
            Some(Event::Connected { ticket, .. }) if known.greeted == Some(ticket) => {
                known.greeted = None;
                if let Some(hello) = self.session.hello() {
                    self.hello = *hello;
                }
                self.ask_status(known);
            }
            Some(Event::Failed { ticket, error })
                if known.asked == Some(ticket) || known.greeted == Some(ticket) =>
            {
                let lost = matches!(
                    error,
                    LinkError::NoAnswer { .. }
                        | LinkError::SessionLost { .. }
                        | LinkError::NotConnected { .. }
                );
                if !lost || now >= known.search_until {
                    return Err(error);
                }
                known.asked = None;
                known.greeted = Some(self.session.connect(now));
            }
            _ => {
                if now.saturating_sub(known.told) >= QUIET {
                    self.ask_status(known);
                }
            }
        }
        Ok(None)
    }

    fn ask_status(&mut self, known: &mut Watch) {
        if known.asked.is_none() && known.greeted.is_none() {
            known.asked = Some(self.session.request(self.port.now(), Request::Status));
        }
    }
}

/// The play is over, one way or another.
pub fn at_rest(state: StateName, cause: StopCause) -> bool {
    match state {
        StateName::Stopped | StateName::EStopped | StateName::Stopping | StateName::Settling => {
            true
        }
        StateName::Holding => cause == StopCause::Finished,
        StateName::Starting | StateName::Playing | StateName::Paused => false,
    }
}

/// The status of a robot at rest as the result of its play.
///
/// # Errors
/// [`LinkError::StoppedEarly`] where it did not come to the end of the last cycle.
pub fn finished(status: Status) -> Result<Status, LinkError> {
    if status.cause == StopCause::Finished {
        return Ok(status);
    }
    Err(LinkError::StoppedEarly {
        cause: status.cause,
        state: status.state,
        cycle: status.cycle,
        cycles: status.cycles,
        flags: status.flags,
    })
}
