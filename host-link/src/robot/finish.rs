//! Waiting for the end of a play.

use std::ops::ControlFlow;
use std::time::Duration;

use link_protocol::{StateName, Status, StopCause, Telemetry};

use super::{BEAT, Robot};
use crate::port::Port;
use crate::session::{Event, LinkError};

/// Time after which the status is asked for when no telemetry tells it.
const QUIET: Duration = Duration::from_secs(1);

impl<P: Port> Robot<P> {
    /// Waits until the robot has played its last cycle. `watch` sees each telemetry, at least every 20 ms of the port's
    /// clock, and may break off, which stops the robot.
    ///
    /// Returns the status at the end.
    ///
    /// # Errors
    /// [`LinkError::StoppedEarly`] when it stops for another reason, [`LinkError::Interrupted`] after breaking off (the stop
    /// was answered), and the link's own.
    pub fn wait_until_finished(
        &mut self,
        mut watch: impl FnMut(Option<&Telemetry>) -> ControlFlow<()>,
    ) -> Result<Status, LinkError> {
        let doing = "waiting for the end of the play";
        let mut told = self.port.now();
        // What was said before the play began tells nothing about its end.
        self.latest = None;
        loop {
            let beat = self.port.now() + BEAT;
            let news = matches!(self.step(beat, doing)?, Some(Event::Telemetry { .. }));
            if watch(self.latest.as_ref()).is_break() {
                self.stop()?;
                return Err(LinkError::Interrupted { doing });
            }
            let now = self.port.now();
            let over = match &self.latest {
                Some(telemetry) if news => {
                    told = now;
                    at_rest(telemetry.state, telemetry.cause)
                }
                _ => now.saturating_sub(told) >= QUIET,
            };
            if over {
                told = now;
                let status = self.status()?;
                if at_rest(status.state, status.cause) {
                    return finished(status);
                }
            }
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
