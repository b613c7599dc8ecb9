//! Wait for the end of a play over an intermittent link. A silent robot is greeted again and its status requested: it may have
//! continued (detached), stopped by itself, or restarted.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{Flags, Reply, Request, StateName, Status, StopCause, Telemetry};

use super::Robot;
use super::connection::Connection;
use crate::port::Port;
use crate::session::{Event, LONGEST_SILENCE, LinkError, Ticket};

const WAITING: &str = "waiting for the end of the play";
/// Time without telemetry after which the status is requested.
const QUIET: Duration = Duration::from_secs(1);
/// Search time after the expected end of a detached play. A play that needs the link has stopped by itself; it is given up
/// after five seconds of silence, when pending attempts are over.
const SEARCH: Duration = Duration::from_secs(30);
/// Time for which the status is requested after telemetry reported the end of the play. The robot may receive nothing any more,
/// which is the most frequent cause of a stop.
const LAST_WORD: Duration = Duration::from_millis(1_500);

/// Time until the last cycle of a play is done. Returns `None` if nothing plays or the play is endless. Pause and soft start
/// are not counted: the end of a pause is unknown, and a soft start takes at most two seconds.
pub fn time_left(status: &Status) -> Option<Duration> {
    let playing = matches!(
        status.state,
        StateName::Starting | StateName::Playing | StateName::Paused
    );
    if !playing || status.cycles == 0 {
        return None;
    }
    // Fixed point, in units of 2⁻¹⁶ cycles.
    let done = (u64::from(status.cycle) << 16) | u64::from(status.phase);
    let left = (u64::from(status.cycles) << 16).saturating_sub(done);
    let us = (u128::from(left) * u128::from(status.period_us)) >> 16;
    Some(Duration::from_micros(u64::try_from(us).unwrap_or(u64::MAX)))
}

/// Known state of the play, and pending requests.
struct Watch {
    /// Time of the robot's last report, on the port's clock.
    reported_at: Duration,
    /// End of the search for a silent robot.
    search_until: Duration,
    asked: Option<Ticket>,
    greeted: Option<Ticket>,
    /// Latest status.
    status: Option<Status>,
    /// Telemetry that reported the end of the play, and the time of the first such report.
    ended: Option<(Duration, Telemetry)>,
}

impl Watch {
    /// Final status from telemetry, if the robot sends nothing else.
    fn last_word(&self, now: Duration) -> Option<Status> {
        let (since, telemetry) = self.ended.as_ref()?;
        (now.saturating_sub(*since) >= LAST_WORD)
            .then(|| status_of(telemetry, self.status.as_ref()))
    }
}

/// Status derived from telemetry; the remaining fields come from an earlier status.
fn status_of(telemetry: &Telemetry, before: Option<&Status>) -> Status {
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
    /// Waits for the end of the last cycle. `watch` runs after each telemetry frame and at least every 20 ms of the port's
    /// clock; if it breaks, the robot is stopped. A lost robot is greeted again. It is given up after five seconds of silence,
    /// or, if it plays detached, 30 s after the end of its play. If telemetry keeps reporting the end of the play, it is
    /// accepted after 1.5 s even without a reply.
    ///
    /// Returns the status at the end.
    ///
    /// # Errors
    /// [`LinkError::StoppedEarly`] if the robot stopped for another cause, [`LinkError::Interrupted`] if `watch` broke (the
    /// stop got its reply), and errors of the link.
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

    /// [`wait_until_finished`](Self::wait_until_finished) for callers with interleaved work: if `watch` breaks, it returns
    /// `None` and leaves the robot unchanged. The wait may be continued later.
    ///
    /// # Errors
    /// As for [`wait_until_finished`](Self::wait_until_finished), except the interruption.
    pub fn wait_while(
        &mut self,
        mut watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<Option<Status>, LinkError> {
        // Telemetry from before the play does not show its end.
        self.connection.latest = None;
        let now = self.connection.now();
        let mut known = Watch {
            reported_at: now,
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

/// Handles an event. Returns the status if the play is over.
fn learn<P: Port>(
    connection: &mut Connection<P>,
    event: Option<Event>,
    known: &mut Watch,
) -> Result<Option<Status>, LinkError> {
    let now = connection.now();
    match event {
        Some(Event::Telemetry { telemetry, .. }) => {
            known.reported_at = now;
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
            known.reported_at = now;
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
            if now.saturating_sub(known.reported_at) >= QUIET {
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

/// Returns true if the play has ended, for any cause.
pub fn at_rest(state: StateName, cause: StopCause) -> bool {
    match state {
        StateName::Stopped | StateName::EStopped | StateName::Stopping | StateName::Settling => {
            true
        }
        StateName::Holding => cause == StopCause::Finished,
        StateName::Starting | StateName::Playing | StateName::Paused => false,
    }
}

/// Converts the status of a robot at rest to the result of its play.
///
/// # Errors
/// [`LinkError::StoppedEarly`] if the last cycle was not completed.
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
