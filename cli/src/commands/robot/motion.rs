//! Commands that move the robot, and those that stop it. After any failure with powered servos, the robot is stopped before the
//! command ends.

use std::fmt;
use std::ops::ControlFlow;
use std::time::Duration;

use host_link::robot::await_play::{at_rest, finished};
use host_link::{LinkError, Robot};
use link_protocol::{Checked, Refusal, Status, Telemetry};
use serde::Serialize;

use super::access::{Access, Contact, RobotConnection};
use super::outputs::{Done, PAUSED_DETACHED, cause, state};
use super::playing::{self, Playing};
use super::playlist;
use super::port::{AnyPort, Pace};
use super::port_owner::PortRequest;
use super::rest::{nothing_under_way, ready, stopped_on_failure, wait_for_rest};
use super::upload::BeforePlay;
use super::{Arm, Pause, Play, tracked_play};
use crate::failure::{Failure, Outcome};
use crate::interrupt::{CTRL_C, Interrupt};
use crate::output::{Output, aside};

/// Longest detached play that a robot accepts, s.
const ALONE_S: f64 = 3600.0;

/// Warning before the first pulses.
pub(super) const MAY_JUMP: &str =
    "The pulses begin: servos that stand elsewhere may jump to neutral.";

/// Result of a play.
#[derive(Debug, Serialize)]
pub(super) struct Played {
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
    pub(super) fn new(status: &Status, detached: bool) -> Self {
        Self {
            state: state(status.state),
            cause: cause(status.cause),
            cycles: status.cycle,
            period_s: f64::from(status.period_us) / 1e6,
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
    let interrupt = Interrupt::install_with_a_robot()?;
    let mut line = access.connect("swimmer robot arm", Pace::RealTime)?;
    line.stops_on(&interrupt);
    output.line(MAY_JUMP);
    line.robot.arm(arm.clear_estop)?;
    output.line("Armed: the servos hold their pose. Ctrl-C stops.");
    hold(&mut line, &interrupt)?;
    output.print(&Done::stopped());
    line.close()
}

/// `swimmer robot play`: arms, starts softly and waits for the end of the last cycle.
pub(super) fn play(access: &Access, play: &Play, output: Output) -> Outcome {
    let interrupt = Interrupt::install_with_a_robot()?;
    if play.attach {
        let mut line = access.connect("swimmer robot play --attach", Pace::RealTime)?;
        line.stops_on(&interrupt);
        attach(&mut line, &interrupt, output)?;
        return line.close();
    }
    play.room.check()?;
    if play.room.tank.is_some() && play.playlist.is_none() && play.track.is_none() {
        return Err(Failure::BadInput(
            "--tank looks ahead along a playlist, or watches the walls with --track: name one of them; `swimmer robot upload --tank` \
             forecasts a gait"
                .to_owned(),
        ));
    }
    if let Some(source) = &play.track {
        let cameras = play.visible.of(source);
        return tracked_play::play(access, play, cameras, &interrupt, output);
    }
    if let Some(path) = &play.playlist {
        return playlist::play(access, play, path, &interrupt, output);
    }
    let pace = if play.cycles.is_some() && !play.detach {
        Pace::AsFastAsPossible
    } else {
        Pace::RealTime
    };
    alone_for_long(play)?;
    let gait = play.gait.as_ref();
    let upload = gait
        .map(|gait| BeforePlay::new(gait, &play.owner))
        .transpose()?;
    let mut line = access.connect("swimmer robot play", pace)?;
    line.stops_on(&interrupt);
    let status = line.robot.status()?;
    nothing_under_way(&status)?;
    let checked = match upload {
        // The upload may have set the passive joint.
        Some(upload) => Checked {
            table_crc32: upload.send(&mut line, &interrupt)?,
            ..line.robot.held()?
        },
        None => status.held(),
    };
    let request = PlayRequest {
        cycles: play.cycles,
        period_s: play.period,
        detached: play.detach,
    };
    begin(&mut line.robot, &request, checked)?;
    if play.detach {
        let status = line.robot.status()?;
        output.print(&Played::new(&status, true));
        return line.close();
    }
    output.line(&playing::announcement(play.cycles, play.period));
    wait(&mut line, &interrupt, output)?;
    line.close()
}

/// Play of the gait that the robot holds.
pub(super) struct PlayRequest {
    /// `None`: without end.
    pub(super) cycles: Option<u32>,
    pub(super) period_s: f64,
    pub(super) detached: bool,
}

/// Arms the robot and begins a play. `checked` are table and settings that it must hold.
///
/// # Errors
/// The robot's refusal, and the link's; the robot is stopped.
pub(super) fn begin(robot: &mut Robot<AnyPort>, play: &PlayRequest, checked: Checked) -> Outcome {
    match robot.arm(false) {
        // Nothing was powered by this, and what the robot does instead is not ours to stop.
        Err(LinkError::Refused {
            refusal: Refusal::NoTable,
            ..
        }) => return Err(no_gait()),
        Err(refused @ LinkError::Refused { .. }) => return Err(refused.into()),
        armed => stopped_on_failure(robot, armed)?,
    }
    let period = Duration::from_secs_f64(play.period_s);
    let begun = robot.play_checked(play.cycles.unwrap_or(0), period, play.detached, checked);
    let has_no_gait = matches!(
        begun,
        Err(LinkError::Refused {
            refusal: Refusal::NoTable,
            ..
        })
    );
    stopped_on_failure(robot, begun)
        .map_err(|failure| if has_no_gait { no_gait() } else { failure })
}

fn no_gait() -> Failure {
    Failure::Tried(
        "the robot holds no gait: name one, as `swimmer robot play --gait circle:70deg`, or send one with `swimmer robot upload`"
            .to_owned(),
    )
}

/// Refuses a detached play that is too long: it has no link to end it.
fn alone_for_long(play: &Play) -> Outcome {
    let Some(cycles) = play.cycles.filter(|_| play.detach) else {
        return Ok(());
    };
    let limit = play.at_most.unwrap_or(ALONE_S).min(ALONE_S);
    let takes = f64::from(cycles) * play.period;
    if takes <= limit {
        return Ok(());
    }
    Err(Failure::BadInput(format!(
        "{cycles} cycles of {} s take {}, and the robot would play them by itself for longer than {}: give fewer cycles, or leave out --detach",
        play.period,
        playing::duration(takes),
        playing::duration(limit),
    )))
}

/// Waits for the end of a play that began detached.
fn attach(line: &mut RobotConnection, interrupt: &Interrupt, output: Output) -> Outcome {
    let status = line.robot.status()?;
    if at_rest(status.state, status.cause) {
        if status.cycles == 0 && status.period_us == 0 {
            return Err(Failure::Tried(
                "nothing to attach to: the robot has played nothing since its start".to_owned(),
            ));
        }
        // It has ended before we came; how it ended is the answer all the same.
        output.print(&Played::new(&ready(line, finished(status)?), false));
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
    let interrupt = Interrupt::install_with_a_robot()?;
    let ask = if pause.detach {
        PortRequest::PauseDetached
    } else {
        PortRequest::Pause
    };
    let mut line = match access.contact(ask, "swimmer robot pause", Pace::RealTime)? {
        Contact::Direct(line) => line,
        Contact::Relayed(relayed) => {
            output.print(&relayed.into_output());
            return Ok(());
        }
    };
    line.stops_on(&interrupt);
    line.robot.pause(pause.detach)?;
    if pause.detach {
        output.print(&Done {
            state: "paused",
            sentence: PAUSED_DETACHED.into(),
        });
        return line.close();
    }
    output.line("Paused: the robot holds its pose. Ctrl-C stops.");
    hold(&mut line, &interrupt)?;
    output.print(&Done::stopped());
    line.close()
}

/// `swimmer robot resume`: continues the play and waits for the end of the last cycle.
pub(super) fn resume(access: &Access, output: Output) -> Outcome {
    let interrupt = Interrupt::install_with_a_robot()?;
    let mut line =
        match access.contact(PortRequest::Resume, "swimmer robot resume", Pace::RealTime)? {
            Contact::Direct(line) => line,
            Contact::Relayed(relayed) => {
                output.print(&relayed.into_output());
                return Ok(());
            }
        };
    line.stops_on(&interrupt);
    line.robot.resume()?;
    wait(&mut line, &interrupt, output)?;
    line.close()
}

/// Keeps the link until Ctrl-C, then stops the robot.
fn hold(line: &mut RobotConnection, interrupt: &Interrupt) -> Outcome {
    loop {
        let news = line.beat();
        let news = stopped_on_failure(&mut line.robot, news)?;
        // It need not be at rest yet: what it says now may be the last that comes through.
        if let Some(telemetry) = news.filter(|telemetry| at_rest(telemetry.state, telemetry.cause))
        {
            return Err(Failure::Tried(format!(
                "the robot stopped: {}",
                host_link::session::cause_in_words(telemetry.cause)
            )));
        }
        if interrupt.requested() {
            line.robot.stop()?;
            wait_for_rest(&mut line.robot)?;
            if interrupt.pressed() != CTRL_C {
                aside(&format!("{}.", interrupt.pressed()));
            }
            return Ok(());
        }
    }
}

/// Waits for the end of the last cycle, with progress; Ctrl-C stops the robot. Other processes are served meanwhile.
fn wait(line: &mut RobotConnection, interrupt: &Interrupt, output: Output) -> Outcome {
    let status = line.robot.status()?;
    let mut shown = playing::PlayProgress::new(Playing::of(&status));
    let ended = until_end(line, interrupt, |telemetry| shown.update(telemetry));
    drop(shown);
    output.print(&ended?);
    Ok(())
}

/// Waits for the end of the last cycle, and serves other processes meanwhile. An interrupt stops the robot.
///
/// # Errors
/// [`Failure::Tried`] if the play is interrupted, unless it is one without end; the robot's and the link's.
pub(super) fn until_end(
    line: &mut RobotConnection,
    interrupt: &Interrupt,
    mut shown: impl FnMut(&Telemetry),
) -> Outcome<Played> {
    let (robot, holder) = line.split();
    let status = loop {
        let waited = robot.wait_while(|telemetry| {
            if let Some(telemetry) = telemetry {
                shown(telemetry);
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
                robot.stop()?;
                wait_for_rest(robot)?;
                let status = robot.status()?;
                if status.cycles == 0 && interrupt.pressed() == CTRL_C {
                    // Without end this is how it ends, and the robot has confirmed it.
                    return Ok(Played::new(&status, false));
                }
                return Err(Failure::Tried(format!(
                    "{}: the robot was stopped after {} whole cycles",
                    interrupt.pressed(),
                    status.cycle
                )));
            }
            None => holder.serve(robot),
        }
    };
    Ok(Played::new(&ready(line, status), false))
}
