//! Wait for the end of a play, over a link that comes and goes: a robot that is no longer heard is greeted
//! anew and its status requested. It may have gone on (detached), stopped by itself, or restarted.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{Flags, Reply, Request, StateName, Status, StopCause, Telemetry};

use super::Robot;
use super::connection::Connection;
use crate::port::Port;
use crate::session::{Event, LONGEST_SILENCE, LinkError, Ticket};

const WAITING: &str = "waiting for the end of the play";
/// Time after which the status is asked for when no telemetry tells it.
const QUIET: Duration = Duration::from_secs(1);
/// A robot that plays detached is searched for until so long after the end of its play. One whose play needs the link has stopped
/// by itself: it is given up after five seconds of silence, when the tries under way are over.
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

/// State of the play as far as it is known, and the requests under way.
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
    /// clock, and may break off, which stops the robot. If the link is lost meanwhile, the robot is greeted again; it is given up
    /// after five seconds of silence, one that plays detached 30 s after its end. A robot that still tells that its play is over is believed after
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
        // Telemetry from before the play says nothing about its end.
        self.connection.latest = None;
        let now = self.connection.now();
        let mut known = Watch {
            told: now,
            search_until: now + LONGEST_SILENCE,
            asked: Some(self.connection.session.request(now, Request::Status)),
            greeted: None,
            status: None,
            ended: None,
        };
        let Self { connection, hello } = self;
        let status = connection.wait(WAITING, |connection, event| {
            if watch(connection.latest.as_ref()).is_break() {
                return Ok(ControlFlow::Break(None));
            }
            let over = learn(connection, event, &mut known)?;
            if let Some(greeted) = connection.session.hello() {
                *hello = *greeted;
            }
            if over.is_some() {
                return Ok(ControlFlow::Break(over));
            }
            let last = known.last_word(connection.now());
            if let (Some(_), Some(asked)) = (&last, known.asked) {
                connection.session.forget(asked);
            }
            Ok(match last {
                Some(status) => ControlFlow::Break(Some(status)),
                None => ControlFlow::Continue(()),
            })
        })?;
        status.map(finished).transpose()
    }
}

/// Takes an event; returns the status if the play is over.
fn learn<P: Port>(
    connection: &mut Connection<P>,
    event: Option<Event>,
    known: &mut Watch,
) -> Result<Option<Status>, LinkError> {
    let now = connection.now();
    match event {
        Some(Event::Telemetry { telemetry, .. }) => {
            known.told = now;
            known.search_until = known.search_until.max(now + LONGEST_SILENCE);
            if at_rest(telemetry.state, telemetry.cause) {
                let since = known.ended.map_or(now, |(since, _)| since);
                known.ended = Some((since, telemetry));
                ask_status(connection, known);
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
                known.search_until = now
                    + if status.flags.contains(Flags::DETACHED) {
                        time_left(&status).unwrap_or_default() + SEARCH
                    } else {
                        LONGEST_SILENCE
                    };
            }
        }
        Some(Event::Connected { ticket, .. }) if known.greeted == Some(ticket) => {
            known.greeted = None;
            ask_status(connection, known);
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
            known.greeted = Some(connection.session.connect(now));
        }
        _ => {
            if now.saturating_sub(known.told) >= QUIET {
                ask_status(connection, known);
            }
        }
    }
    Ok(None)
}

fn ask_status<P: Port>(connection: &mut Connection<P>, known: &mut Watch) {
    if known.asked.is_none() && known.greeted.is_none() {
        known.asked = Some(
            connection
                .session
                .request(connection.now(), Request::Status),
        );
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
