//! What moves the robot, and what stops it. Whatever goes wrong after the servos have power, the robot is stopped before
//! the command ends.

use std::fmt;
use std::ops::ControlFlow;
use std::thread::sleep;
use std::time::{Duration, Instant};

use host_link::robot::finish::{at_rest, finished};
use host_link::{LinkError, Robot};
use link_protocol::{StateName, Status, Telemetry};
use serde::Serialize;

use super::access::{Access, LOOK_AGAIN, Line, Met, Reached};
use super::answers::{Done, E_STOPPED, PAUSED_DETACHED, STOPPED, cause, is_under_way, state};
use super::holder::{Ask, Relayed};
use super::playing::{self, Playing};
use super::port::{AnyPort, Pace, session_seed};
use super::upload::BeforePlay;
use super::{Arm, Pause, Play};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::Output;

/// Longest time from a stop to pulses off: a second of ramp, half a second of rest, and some for the link.
const TO_REST: Duration = Duration::from_secs(5);

/// How a play ended.
#[derive(Debug, Serialize)]
struct Played {
    state: &'static str,
    cause: &'static str,
    /// Cycles played to their end.
    cycles: u32,
    period_s: f64,
    detached: bool,
    /// Time to the end of the last cycle; 0 at the end, `null` for a play without end.
    remaining_s: Option<f64>,
}

impl Played {
    fn new(status: &Status, detached: bool) -> Self {
        Self {
            state: state(status.state),
            cause: cause(status.cause),
            cycles: status.cycle,
            period_s: f64::from(status.period_us) * 1e-6,
            detached,
            remaining_s: Playing::of(status).remaining_s(),
        }
    }
}

impl fmt::Display for Played {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if self.detached {
            let end = self.remaining_s.map_or_else(String::new, |seconds| {
                format!(" for another {}", playing::duration(seconds))
            });
            return write!(
                f,
                "The robot plays on by itself{end}; `swimmer robot play --attach` waits for its end, `swimmer robot stop` ends it."
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
pub(super) fn arm(access: &Access, arm: &Arm, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut line = access.connect("swimmer robot arm", Pace::RealTime)?;
    line.robot.arm(arm.clear_estop)?;
    output.line("Armed: the servos hold their pose. Ctrl-C stops.");
    hold(&mut line, &interrupt)?;
    output.answer(&Done::stopped());
    line.close()
}

/// `swimmer robot play`: arms, starts softly and waits for the end of the last cycle.
pub(super) fn play(access: &Access, play: &Play, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    if play.attach {
        let mut line = access.connect("swimmer robot play --attach", Pace::RealTime)?;
        attach(&mut line, &interrupt, output)?;
        return line.close();
    }
    let pace = if play.cycles.is_some() && !play.detach {
        Pace::AsFastAsPossible
    } else {
        Pace::RealTime
    };
    let gait = play.gait.as_ref();
    let upload = gait
        .map(|gait| BeforePlay::new(gait, &play.owner))
        .transpose()?;
    let mut line = access.connect("swimmer robot play", pace)?;
    nothing_under_way(&line.robot.status()?)?;
    if let Some(upload) = upload {
        upload.send(&mut line, &interrupt)?;
    }
    let cycles = play.cycles.unwrap_or(0);
    let robot = &mut line.robot;
    match robot.arm(false) {
        // Nothing was powered by this, and what the robot does instead is not ours to stop.
        Err(refused @ LinkError::Refused { .. }) => return Err(refused.into()),
        armed => stopped_on_failure(robot, armed)?,
    }
    let begun = robot.play(cycles, Duration::from_secs_f64(play.period), play.detach);
    stopped_on_failure(robot, begun)?;
    if play.detach {
        let status = robot.status()?;
        output.answer(&Played::new(&status, true));
        return line.close();
    }
    output.line(&match play.cycles {
        Some(cycles) => format!(
            "Playing {cycles} cycles of {} s: {} and the start. Ctrl-C stops.",
            play.period,
            playing::duration(f64::from(cycles) * play.period)
        ),
        None => "Playing without end. Ctrl-C stops.".to_owned(),
    });
    wait(&mut line, &interrupt, output)?;
    line.close()
}

/// A play that goes on detached is left alone: another begins only when it has ended or was stopped.
fn nothing_under_way(status: &Status) -> Outcome {
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

/// Waits for the end of a play that began detached.
fn attach(line: &mut Line, interrupt: &Interrupt, output: Output) -> Outcome {
    let status = line.robot.status()?;
    if at_rest(status.state, status.cause) {
        if status.cycles == 0 && status.period_us == 0 {
            return Err(Failure::Tried(
                "nothing to attach to: the robot has played nothing since its start".to_owned(),
            ));
        }
        // It has ended before we came; how it ended is the answer all the same.
        output.answer(&Played::new(&finished(status)?, false));
        return Ok(());
    }
    output.line(&format!(
        "The robot is {}: {}. Ctrl-C stops it.",
        state(status.state),
        Playing::of(&status)
    ));
    wait(line, interrupt, output)
}

/// `swimmer robot pause`: holds the pose, and the link until Ctrl-C unless detached.
pub(super) fn pause(access: &Access, pause: &Pause, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let ask = if pause.detach {
        Ask::PauseDetached
    } else {
        Ask::Pause
    };
    let mut line = match access.meet(ask, "swimmer robot pause", Pace::RealTime)? {
        Met::Line(line) => line,
        Met::Relayed(relayed) => {
            output.answer(&relayed.told());
            return Ok(());
        }
    };
    line.robot.pause(pause.detach)?;
    if pause.detach {
        output.answer(&Done {
            state: "paused",
            sentence: PAUSED_DETACHED.into(),
        });
        return line.close();
    }
    output.line("Paused: the robot holds its pose. Ctrl-C stops.");
    hold(&mut line, &interrupt)?;
    output.answer(&Done::stopped());
    line.close()
}

/// `swimmer robot resume`: goes on and waits for the end of the last cycle.
pub(super) fn resume(access: &Access, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut line = match access.meet(Ask::Resume, "swimmer robot resume", Pace::RealTime)? {
        Met::Line(line) => line,
        Met::Relayed(relayed) => {
            output.answer(&relayed.told());
            return Ok(());
        }
    };
    line.robot.resume()?;
    wait(&mut line, &interrupt, output)?;
    line.close()
}

/// `swimmer robot stop` and `estop`: act first, ask afterwards. Where another `swimmer` has the port, it passes the stop on.
pub(super) fn stop(access: &Access, estop: bool, output: Output) -> Outcome {
    let ask = if estop { Ask::EStop } else { Ask::Stop };
    let access = &access.for_a_stop();
    let begun = Instant::now();
    let mut robot = loop {
        if let Some(relayed) = access.ask_holder(ask)?
            && let Some(at_rest) = rest_by_holder(access, relayed)
        {
            output.answer(&at_rest.told());
            return Ok(());
        }
        match access.reach_named(Pace::AsFastAsPossible)? {
            Some(Reached::Free(opened)) => {
                let port = Robot::stop_at_once(opened.port, session_seed(), estop)?;
                // The stop is done; how it goes on is only good to know.
                break Robot::connect_with(port, access.session()?);
            }
            // Another process has just taken the port: it can be asked now.
            Some(Reached::Held(_)) if begun.elapsed() < TO_REST => sleep(LOOK_AGAIN),
            Some(Reached::Held(held_by)) => return Err(Failure::Tried(held_by.to_string())),
            None => {
                let (_, mut robot) = access.find(Pace::AsFastAsPossible)?;
                if estop {
                    robot.estop()?;
                } else {
                    robot.stop()?;
                }
                break Ok(robot);
            }
        }
    };
    let state_now = match &mut robot {
        Ok(robot) => wait_for_rest(robot).ok(),
        Err(_) => None,
    };
    let sentence = match (&state_now, estop) {
        (Some(StateName::EStopped), _) => E_STOPPED,
        (Some(StateName::Stopped), _) => STOPPED,
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

/// The stop is passed on; follows the robot to its rest. `None`: the holder ended first, and the port is free to see for
/// ourselves.
fn rest_by_holder(access: &Access, stopped: Relayed) -> Option<Relayed> {
    let begun = Instant::now();
    let mut last = stopped;
    while !matches!(last.state(), "stopped" | "e-stopped") && begun.elapsed() < TO_REST {
        sleep(LOOK_AGAIN);
        match access.ask_holder(Ask::Status) {
            Ok(Some(status)) if status.state() == "stopped" => last = Relayed::of(&Done::at_rest()),
            Ok(Some(_)) => {}
            Ok(None) => return None,
            Err(_) => break,
        }
    }
    Some(last)
}

/// Keeps the link until Ctrl-C, then stops the robot.
fn hold(line: &mut Line, interrupt: &Interrupt) -> Outcome {
    loop {
        let news = line.beat();
        let news = stopped_on_failure(&mut line.robot, news)?;
        if let Some(telemetry) = news.filter(is_off) {
            return Err(Failure::Tried(format!(
                "the robot stopped: {}",
                host_link::session::cause_in_words(telemetry.cause)
            )));
        }
        if interrupt.requested() {
            line.robot.stop()?;
            wait_for_rest(&mut line.robot)?;
            return Ok(());
        }
    }
}

/// Waits for the end of the last cycle, with progress; Ctrl-C stops the robot. Other processes are served meanwhile.
fn wait(line: &mut Line, interrupt: &Interrupt, output: Output) -> Outcome {
    let status = line.robot.status()?;
    let mut shown = playing::Shown::new(Playing::of(&status));
    let (robot, holder) = line.split();
    let status = loop {
        let waited = robot.wait_while(|telemetry| {
            if let Some(telemetry) = telemetry {
                shown.tell(telemetry);
            }
            if interrupt.requested() || holder.asked() {
                ControlFlow::Break(())
            } else {
                ControlFlow::Continue(())
            }
        });
        match stopped_on_failure(robot, waited)? {
            Some(status) => break status,
            None if interrupt.requested() => {
                drop(shown);
                robot.stop()?;
                wait_for_rest(robot)?;
                let status = robot.status()?;
                return Err(Failure::Tried(format!(
                    "Ctrl-C: the robot was stopped after {} whole cycles",
                    status.cycle
                )));
            }
            None => holder.serve(robot),
        }
    };
    drop(shown);
    output.answer(&Played::new(&status, false));
    Ok(())
}

/// Passes a result on; a failure stops the robot first, as far as the link still allows.
fn stopped_on_failure<T>(robot: &mut Robot<AnyPort>, result: Result<T, LinkError>) -> Outcome<T> {
    if result.is_err() {
        let _ = robot.stop();
    }
    Ok(result?)
}

/// Waits until the pulses are off.
pub(super) fn wait_for_rest(robot: &mut Robot<AnyPort>) -> Result<StateName, LinkError> {
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
