//! `swimmer robot log` and `replay`: every frame on the wire into a file, and the file held against the brain.

use std::fmt;
use std::time::Duration;

use serde::Serialize;
use swimmer_files::read_link_log;
use twin::{Difference, ReplayError, Replayed, replay};

use super::access::Access;
use super::answers::{answer_no, state, telemetry_angles};
use super::port::Pace;
use super::upload::table_of;
use super::watch::listen;
use super::{Log, Replay};
use crate::arguments::load_gait;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::{Output, aside};
use crate::quantity;

#[derive(Debug, Serialize)]
struct Logged {
    file: String,
    frames: u64,
}

impl fmt::Display for Logged {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "Wrote {} frames to {}.", self.frames, self.file)
    }
}

/// `swimmer robot log`: listens and writes until Ctrl-C.
pub(super) fn log(access: &Access, arguments: &Log, output: Output) -> Outcome {
    let interrupt = Interrupt::install_with_a_robot()?;
    let access = access.logging_to(arguments.file.clone());
    let mut line = access.connect("swimmer robot log", Pace::RealTime)?;
    let end = arguments.seconds.map(Duration::from_secs_f64);
    listen(&mut line, end, &interrupt, |_| {})?;
    let frames = line.close_log()?;
    output.answer(&Logged {
        file: arguments.file.display().to_string(),
        frames: frames.unwrap_or_default(),
    });
    Ok(())
}

/// How a log and the brain compare.
#[derive(Debug, Serialize)]
struct Verdict {
    file: String,
    same: bool,
    compared: usize,
    different: usize,
    requests: usize,
    seconds: f64,
    first_difference: Option<Told>,
}

/// What was told at the first difference.
#[derive(Debug, Serialize)]
struct Told {
    robot_time_s: f64,
    logged: Doing,
    replayed: Option<Doing>,
}

#[derive(Debug, Serialize)]
struct Doing {
    state: &'static str,
    cycle: f64,
    setpoint_rad: [f64; 2],
    pulse_ns: [u32; 2],
}

impl Doing {
    fn new(telemetry: &link_protocol::Telemetry) -> Self {
        Self {
            state: state(telemetry.state),
            cycle: f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 65_536.0,
            setpoint_rad: telemetry_angles(telemetry),
            pulse_ns: telemetry.pulse_ns,
        }
    }
}

impl fmt::Display for Doing {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [front, back] = self.setpoint_rad;
        write!(
            f,
            "{}, cycle {:.3}, {}, {}",
            self.state,
            self.cycle,
            quantity::angle(front),
            quantity::angle(back)
        )
    }
}

impl Verdict {
    fn new(file: String, replayed: &Replayed) -> Self {
        Self {
            file,
            same: replayed.different == 0,
            compared: replayed.compared,
            different: replayed.different,
            requests: replayed.requests,
            seconds: replayed.seconds,
            first_difference: replayed.first.map(|Difference { logged, replayed }| Told {
                robot_time_s: Duration::from_micros(logged.robot_us).as_secs_f64(),
                logged: Doing::new(&logged),
                replayed: replayed.as_ref().map(Doing::new),
            }),
        }
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            file,
            compared,
            different,
            requests,
            seconds,
            ..
        } = self;
        write!(
            f,
            "{file}: {seconds:.1} s, {requests} requests that move the robot, {compared} pieces of telemetry; "
        )?;
        let Some(first) = &self.first_difference else {
            return write!(
                f,
                "the brain gives the same set-points and pulses in all of them."
            );
        };
        write!(
            f,
            "the brain differs in {different} of them, first at {:.2} s of the robot's clock:\n  logged    {}\n  replayed  {}",
            first.robot_time_s,
            first.logged,
            first
                .replayed
                .as_ref()
                .map_or_else(|| "nothing told".to_owned(), ToString::to_string)
        )
    }
}

/// `swimmer robot replay`: exit status 1 where the brain does something else.
pub(super) fn replay_log(arguments: &Replay, output: Output) -> Outcome {
    let log = read_link_log(&arguments.file).map_err(|error| Failure::bad_input(&error))?;
    if !log.ended {
        aside(&format!(
            "note: {} has no end: its writer was killed or its disk was full; what follows is of the {} frames before",
            arguments.file.display(),
            log.frames.len()
        ));
    }
    let table = arguments
        .gait
        .as_ref()
        .map(|gait| {
            table_of(&load_gait(gait)?).map_err(|error| {
                Failure::BadInput(format!(
                    "the gait {} makes no table for the robot: {error}",
                    gait.readable()
                ))
            })
        })
        .transpose()?;
    let replayed = replay(&log.frames, table.as_ref())?;
    let answer = Verdict::new(arguments.file.display().to_string(), &replayed);
    if answer.same {
        output.answer(&answer);
        return Ok(());
    }
    let missing = replayed.missing_table.map_or_else(String::new, |crc32| {
        format!(
            "; the robot held a gait with CRC {crc32:08x} when the log began: name it with --gait"
        )
    });
    let settings = replayed.other_settings.map_or_else(String::new, |crc32| {
        format!(
            "; the robot had settings (hash {crc32:08x}) that the log does not hold: record after \
             `swimmer robot servo` and `swimmer robot configure` in one session"
        )
    });
    answer_no(
        output,
        &answer,
        format!("the log and the brain differ{missing}{settings}"),
    )
}

impl From<ReplayError> for Failure {
    fn from(error: ReplayError) -> Self {
        Self::bad_input(&error)
    }
}
