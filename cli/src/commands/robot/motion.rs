//! What moves the robot, and what stops it. Whatever goes wrong after the servos have power, the robot is stopped before
//! the command ends.

use std::fmt;
use std::ops::ControlFlow;
use std::time::Duration;

use host_link::{LinkError, Robot};
use link_protocol::{StateName, Status, Telemetry};
use serde::Serialize;

use super::answers::{Done, cause, state};
use super::port::{AnyPort, Pace, connect, open, session_seed};
use super::upload::before_play;
use super::{Arm, Pause, Play};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;
use crate::progress::Progress;

/// Longest time from a stop to pulses off: a second of ramp, half a second of rest, and some for the link.
const TO_REST: Duration = Duration::from_secs(5);
/// A hold that only Ctrl-C ends.
const FOR_EVER: Duration = Duration::from_secs(u32::MAX as u64);

/// How a play ended.
#[derive(Debug, Serialize)]
struct Played {
    state: &'static str,
    cause: &'static str,
    /// Cycles played to their end.
    cycles: u32,
    period_s: f64,
    detached: bool,
}

impl Played {
    fn new(status: &Status, detached: bool) -> Self {
        Self {
            state: state(status.state),
            cause: cause(status.cause),
            cycles: status.cycle,
            period_s: f64::from(status.period_us) * 1e-6,
            detached,
        }
    }
}

impl fmt::Display for Played {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.detached {
            return write!(
                f,
                "The robot plays on by itself; `swimmer robot stop` ends it."
            );
        }
        write!(
            f,
            "Played {} cycles of {} s; the robot is {} ({}).",
            self.cycles, self.period_s, self.state, self.cause
        )
    }
}

/// `swimmer robot arm`: power on, and hold the link until Ctrl-C.
pub(super) fn arm(port: Option<&str>, arm: &Arm, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut robot = connect(port, Pace::RealTime)?;
    robot.arm(arm.clear_estop)?;
    output.line("Armed: the servos hold their pose. Ctrl-C stops.");
    hold(&mut robot, &interrupt)?;
    output.answer(&Done {
        state: "stopped",
        sentence: "Stopped.".into(),
    });
    Ok(())
}

/// `swimmer robot play`: arms, starts softly and waits for the end of the last cycle.
pub(super) fn play(port: Option<&str>, play: &Play, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let pace = if play.cycles.is_some() && !play.detach {
        Pace::AsFastAsPossible
    } else {
        Pace::RealTime
    };
    let mut robot = connect(port, pace)?;
    if let Some(gait) = &play.gait {
        before_play(&mut robot, gait, &play.owner, &interrupt)?;
    }
    let cycles = play.cycles.unwrap_or(0);
    let begun = robot
        .arm(false)
        .and_then(|()| robot.play(cycles, Duration::from_secs_f64(play.period), play.detach));
    stopped_on_failure(&mut robot, begun)?;
    if play.detach {
        let status = robot.status()?;
        output.answer(&Played::new(&status, true));
        return Ok(());
    }
    if cycles == 0 {
        output.line("Playing without end. Ctrl-C stops.");
    }
    wait(&mut robot, &interrupt, output)
}

/// `swimmer robot pause`: holds the pose, and the link until Ctrl-C unless detached.
pub(super) fn pause(port: Option<&str>, pause: &Pause, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut robot = connect(port, Pace::RealTime)?;
    robot.pause(pause.detach)?;
    if pause.detach {
        let sentence = "Paused: the robot holds its pose for at most 60 s, then stops; `swimmer robot resume` goes on.";
        output.answer(&Done {
            state: "paused",
            sentence: sentence.into(),
        });
        return Ok(());
    }
    output.line("Paused: the robot holds its pose. Ctrl-C stops.");
    hold(&mut robot, &interrupt)?;
    output.answer(&Done {
        state: "stopped",
        sentence: "Stopped.".into(),
    });
    Ok(())
}

/// `swimmer robot resume`: goes on and waits for the end of the last cycle.
pub(super) fn resume(port: Option<&str>, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut robot = connect(port, Pace::RealTime)?;
    robot.resume()?;
    wait(&mut robot, &interrupt, output)
}

/// `swimmer robot stop` and `estop`: act first, ask afterwards.
pub(super) fn stop(port: Option<&str>, estop: bool, output: Output) -> Outcome {
    let port = Robot::stop_at_once(open(port, Pace::AsFastAsPossible)?, session_seed(), estop)?;
    // The stop is done; how it goes on is only good to know.
    let state_now =
        Robot::connect(port, session_seed()).and_then(|mut robot| wait_for_rest(&mut robot));
    let sentence = match (&state_now, estop) {
        (Ok(StateName::EStopped), _) => {
            "E-stopped: the pulses are off; only `swimmer robot arm --clear-estop` ends it."
        }
        (Ok(StateName::Stopped), _) => "Stopped: the pulses are off.",
        (_, false) => "The robot acknowledged the stop.",
        (_, true) => "The robot acknowledged the e-stop.",
    };
    let state_now = state_now.map_or(if estop { "e-stopped" } else { "stopping" }, state);
    output.answer(&Done {
        state: state_now,
        sentence: sentence.into(),
    });
    Ok(())
}

/// Keeps the link until Ctrl-C, then stops the robot.
fn hold(robot: &mut Robot<AnyPort>, interrupt: &Interrupt) -> Outcome {
    let mut ended = None;
    let held = robot.listen(FOR_EVER, |telemetry| {
        ended = telemetry.filter(|telemetry| is_off(telemetry)).copied();
        if interrupt.requested() || ended.is_some() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    stopped_on_failure(robot, held)?;
    if let Some(telemetry) = ended {
        return Err(Failure::Tried(format!(
            "the robot stopped by itself: {}",
            cause(telemetry.cause)
        )));
    }
    robot.stop()?;
    wait_for_rest(robot)?;
    Ok(())
}

/// Waits for the end of the last cycle, with progress; Ctrl-C stops the robot.
fn wait(robot: &mut Robot<AnyPort>, interrupt: &Interrupt, output: Output) -> Outcome {
    let progress = Progress::of_steps(1000);
    let finished = robot.wait_until_finished(|telemetry| {
        if let Some(telemetry) = telemetry {
            let done = f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 65_536.0;
            if telemetry.cycles > 0 {
                #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
                // between 0 and 1000
                progress.at((1000.0 * done / f64::from(telemetry.cycles)) as u64);
                progress.doing(format!(
                    "{}: cycle {done:.2} of {}",
                    state(telemetry.state),
                    telemetry.cycles
                ));
            } else {
                progress.doing(format!("{}: cycle {done:.2}", state(telemetry.state)));
            }
        }
        if interrupt.requested() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    });
    drop(progress);
    match finished {
        Ok(status) => {
            output.answer(&Played::new(&status, false));
            Ok(())
        }
        Err(LinkError::Interrupted { .. }) => {
            wait_for_rest(robot)?;
            let status = robot.status()?;
            Err(Failure::Tried(format!(
                "Ctrl-C: the robot was stopped after {} whole cycles",
                status.cycle
            )))
        }
        Err(error) => stopped_on_failure(robot, Err(error)),
    }
}

/// Passes a result on; a failure stops the robot first, as far as the link still allows.
fn stopped_on_failure(robot: &mut Robot<AnyPort>, result: Result<(), LinkError>) -> Outcome {
    if result.is_err() {
        let _ = robot.stop();
    }
    Ok(result?)
}

/// Waits until the pulses are off.
fn wait_for_rest(robot: &mut Robot<AnyPort>) -> Result<StateName, LinkError> {
    robot.listen(TO_REST, |telemetry| {
        if telemetry.is_some_and(is_off) {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    Ok(robot.status()?.state)
}

fn is_off(telemetry: &Telemetry) -> bool {
    matches!(telemetry.state, StateName::Stopped | StateName::EStopped)
}
