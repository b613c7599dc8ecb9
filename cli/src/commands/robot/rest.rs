//! The robot at rest: before a play nothing else is under way, after it, or after anything that goes wrong, the pulses go off.

use std::ops::ControlFlow;
use std::time::Duration;

use host_link::{LinkError, Robot};
use link_protocol::{StateName, Status};

use super::access::{BEAT, RobotConnection};
use super::outputs::{is_under_way, state};
use super::playing::Playing;
use super::port::AnyPort;
use crate::failure::{Failure, Outcome};
use crate::output::aside;

/// Longest time from a stop to pulses off: a second of ramp, half a second of rest, and some for the link.
pub(super) const TO_REST: Duration = Duration::from_secs(5);

/// A detached play is left alone: another begins only when it has ended or was stopped.
pub(super) fn nothing_under_way(status: &Status) -> Outcome {
    if !is_under_way(status.state) {
        return Ok(());
    }
    let go_on = if status.state == StateName::Paused {
        "`swimmer robot resume` goes on with it"
    } else {
        "`swimmer robot play --attach` waits for its end"
    };
    Err(Failure::Tried(format!(
        "a play is under way and was left alone: the robot is {}, {}; {go_on}, `swimmer robot stop` ends it",
        state(status.state),
        Playing::of(status)
    )))
}

/// The same play after the robot has ramped to neutral and accepts further requests; unchanged if the link is lost before.
pub(super) fn ready(line: &mut RobotConnection, over: Status) -> Status {
    let mut waited = Duration::ZERO;
    let mut now = over;
    while !is_off(now.state) && waited < TO_REST {
        match line.beat() {
            Ok(Some(telemetry)) => now.state = telemetry.state,
            Ok(None) => {}
            Err(_) => {
                aside("note: the link was lost after the play's end; the robot stops by itself.");
                break;
            }
        }
        waited += BEAT;
    }
    now
}

/// Passes a result on; a failure stops the robot first, as far as the link still allows.
pub(super) fn stopped_on_failure<T>(
    robot: &mut Robot<AnyPort>,
    result: Result<T, LinkError>,
) -> Outcome<T> {
    // One that has stopped by itself needs no stop; it may not receive at all.
    if result
        .as_ref()
        .is_err_and(|error| !matches!(error, LinkError::StoppedEarly { .. }))
    {
        let _ = robot.stop();
    }
    Ok(result?)
}

/// Waits until the pulses are off.
pub(super) fn wait_for_rest(robot: &mut Robot<AnyPort>) -> Result<StateName, LinkError> {
    robot.listen(TO_REST, |telemetry| {
        if telemetry.is_some_and(|telemetry| is_off(telemetry.state)) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    Ok(robot.status()?.state)
}

/// Returns `true` if the pulses are off.
pub(super) fn is_off(state: StateName) -> bool {
    matches!(state, StateName::Stopped | StateName::EStopped)
}
