//! `swimmer robot stop` and `estop`: act first, ask afterwards. If another `swimmer` has the port, it passes the stop on; if that
//! one hangs, the stop bypasses it.

use std::io::{self, BufRead as _, IsTerminal as _};
use std::thread::sleep;
use std::time::Instant;

use host_link::robot::{Halt, StoppedBy};
use host_link::{LinkError, Robot};
use link_protocol::StateName;

use super::access::{Access, LOOK_AGAIN, PortState, report_silence};
use super::outputs::{Done, E_STOPPED, STOPPED, state};
use super::port::{AnyPort, Pace, session_seed};
use super::port_owner::{HeldBy, PortRequest, Relayed, Unanswered};
use super::rest::{TO_REST, wait_for_rest};
use super::{Estop, Stop};
use crate::failure::{Failure, Outcome};
use crate::output::{Output, aside};

/// Permission to bypass a `swimmer` that has the port and hangs.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum TakeOver {
    Yes,
    PortRequest,
    No,
}

/// `swimmer robot stop`.
pub(super) fn stop(access: &Access, arguments: &Stop, output: Output) -> Outcome {
    let take_over = if arguments.take_over {
        TakeOver::Yes
    } else {
        TakeOver::PortRequest
    };
    run(access, PortRequest::Stop, take_over, output)
}

/// `swimmer robot estop`.
pub(super) fn estop(access: &Access, arguments: &Estop, output: Output) -> Outcome {
    if arguments.clear {
        return clear(access, arguments.yes, output);
    }
    let take_over = if arguments.no_take_over {
        TakeOver::No
    } else {
        TakeOver::Yes
    };
    run(access, PortRequest::EStop, take_over, output)
}

/// Ends the latch; any motion afterwards needs a new request.
fn clear(access: &Access, yes: bool, output: Output) -> Outcome {
    let mut line = access.connect("swimmer robot estop --clear", Pace::AsFastAsPossible)?;
    // Before the question: an e-stop that comes while the operator looks stays latched.
    let before = line.robot.status()?;
    let estopped = before.state == StateName::EStopped;
    if estopped && !yes && !confirmed("Is it safe to end the e-stop? [y/N]") {
        return Err(Failure::Tried(
            "the e-stop is still latched: nobody said yes; without a terminal say so with --yes"
                .to_owned(),
        ));
    }
    line.robot.clear_estops(before.estops)?;
    let sentence = if estopped {
        "Cleared: the robot is stopped, and `arm` or `play` powers it again."
    } else {
        "No e-stop was latched; the robot is stopped."
    };
    output.print(&Done {
        state: state(line.robot.status()?.state),
        sentence: sentence.into(),
    });
    line.close()
}

fn run(access: &Access, ask: PortRequest, take_over: TakeOver, output: Output) -> Outcome {
    let access = &access.for_a_stop();
    let estop = ask == PortRequest::EStop;
    let begun = Instant::now();
    let robot = loop {
        if let Some(held_by) = access.held_by() {
            match held_by.try_request(ask) {
                Ok(Some(relayed)) => {
                    if let Some(at_rest) = rest_by_holder(access, relayed) {
                        output.print(&at_rest.into_output());
                        return Ok(());
                    }
                }
                Ok(None) => {}
                Err(Unanswered::Refused(failure)) => return Err(failure),
                Err(Unanswered::Hangs) => {
                    allow(take_over, &held_by, estop)?;
                    if let Some(robot) = past(access, &held_by, estop)? {
                        break robot;
                    }
                }
            }
        }
        match access.open_named(Pace::AsFastAsPossible)? {
            Some(PortState::Free(opened)) => break stop_at_once(access, opened.port, estop)?,
            // Another process has just taken the port: the request can go to it.
            Some(PortState::Held(_)) if begun.elapsed() < TO_REST => sleep(LOOK_AGAIN),
            Some(PortState::Held(held_by)) => return Err(Failure::Tried(held_by.to_string())),
            None => {
                let (_, mut robot) = access.find(Pace::AsFastAsPossible)?;
                say_if_by_itself(if estop { robot.estop()? } else { robot.stop()? });
                break Ok(robot);
            }
        }
    };
    output.print(&rest(robot, estop));
    Ok(())
}

/// Sends the stop first; the state afterwards is for information only.
fn stop_at_once(
    access: &Access,
    port: AnyPort,
    estop: bool,
) -> Outcome<Result<Robot<AnyPort>, LinkError>> {
    let halt = if estop { Halt::EStop } else { Halt::Stop };
    let (port, by) = Robot::stop_at_once(port, session_seed(), halt, report_silence())?;
    say_if_by_itself(by);
    Ok(Robot::connect_observed(
        port,
        access.session()?,
        report_silence(),
    ))
}

/// Notes that the robot may have stopped by itself, if the stop had to wait behind other bytes.
fn say_if_by_itself(by: StoppedBy) {
    if by != StoppedBy::Request {
        aside(&format!("{by}."));
    }
}

/// Says at once that the holder hangs, and whether to go past it.
///
/// # Errors
/// [`Failure::Tried`] where not, with the command that does.
fn allow(take_over: TakeOver, held_by: &HeldBy, estop: bool) -> Outcome {
    let hangs = held_by.hangs();
    aside(&format!("{hangs}."));
    let again = if estop {
        "without --no-take-over this goes past it"
    } else {
        "`--take-over` stops the robot past it, and so does `estop`"
    };
    let yes = match take_over {
        TakeOver::Yes => true,
        TakeOver::No => false,
        TakeOver::PortRequest => confirmed("Stop the robot past it? [y/N]"),
    };
    if yes {
        return Ok(());
    }
    Err(Failure::Tried(format!(
        "the robot was not stopped: {hangs}; {again}"
    )))
}

/// Asks the operator, if standard input is a terminal.
fn confirmed(question: &str) -> bool {
    if !(io::stdin().is_terminal() && io::stderr().is_terminal()) {
        return false;
    }
    aside(question);
    let mut answer = String::new();
    let heard = io::stdin().lock().read_line(&mut answer).is_ok();
    heard && matches!(answer.trim(), "y" | "Y" | "yes")
}

/// Stops the robot past a holder that hangs, or ends the holder. Returns `None` if it is ended and the port is free.
fn past(
    access: &Access,
    held_by: &HeldBy,
    estop: bool,
) -> Outcome<Option<Result<Robot<AnyPort>, LinkError>>> {
    if let Some(occupied) = held_by.occupied() {
        match stop_at_once(access, Box::new(occupied), estop) {
            Ok(robot) => {
                let process = held_by.process();
                aside(&format!(
                    "The stop went past it. Process {process} still hangs with the port: end it (kill -9 {process}), or continue it (fg, or kill -CONT {process}), and it finds the robot stopped."
                ));
                return Ok(Some(robot));
            }
            Err(failure) => aside(&format!("Beside it nothing came through ({failure}).")),
        }
    }
    held_by.end()?;
    let process = held_by.process();
    aside(&format!("Process {process} was ended; its port is free."));
    Ok(None)
}

/// Follows the robot to its rest, and says how it stands.
fn rest(robot: Result<Robot<AnyPort>, LinkError>, estop: bool) -> Done {
    let state_now = robot
        .ok()
        .and_then(|mut robot| wait_for_rest(&mut robot).ok());
    let sentence = match (&state_now, estop) {
        (Some(StateName::EStopped), _) => E_STOPPED,
        (Some(StateName::Stopped), _) => STOPPED,
        (_, false) => "The robot acknowledged the stop.",
        (_, true) => "The robot acknowledged the e-stop.",
    };
    let state_now = state_now.map_or(if estop { "e-stopped" } else { "stopping" }, state);
    Done {
        state: state_now,
        sentence: sentence.into(),
    }
}

/// The stop is passed on; follows the robot to its rest. `None`: the holder ended first, and the port is free to see for
/// ourselves.
fn rest_by_holder(access: &Access, stopped: Relayed) -> Option<Relayed> {
    let begun = Instant::now();
    let mut last = stopped;
    while !matches!(last.state(), "stopped" | "e-stopped") && begun.elapsed() < TO_REST {
        sleep(LOOK_AGAIN);
        match access.request_holder(PortRequest::Status) {
            Ok(Some(status)) if status.state() == "stopped" => last = Relayed::of(&Done::at_rest()),
            Ok(Some(_)) => {}
            Ok(None) => return None,
            Err(_) => break,
        }
    }
    Some(last)
}
