//! `swimmer robot log` and `replay`: records every frame on the wire in a file, and replays the file to the brain.

use std::fmt;
use std::time::Duration;

use serde::Serialize;
use swimmer_files::read_link_log;
use twin::{Difference, Reason, ReplayError, Replayed, Verdict, replay};

use super::access::Access;
use super::outputs::{print_refusal, state, telemetry_angles};
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
    output.print(&Logged {
        file: arguments.file.display().to_string(),
        frames: frames.unwrap_or_default(),
    });
    Ok(())
}

/// Comparison of a log and the brain.
#[derive(Debug, Serialize)]
struct Comparison {
    file: String,
    /// Shown to be the same: false for a comparison that decides nothing, too.
    same: bool,
    /// same, differs, undecided
    verdict: &'static str,
    /// Reason for an undecided comparison; `null` otherwise.
    undecided: Option<String>,
    compared: usize,
    different: usize,
    requests: usize,
    seconds: f64,
    /// The robot restarted later in the log; what follows is not compared.
    restarted: bool,
    first_difference: Option<FirstDifference>,
}

/// Robot and brain at the first difference.
#[derive(Debug, Serialize)]
struct FirstDifference {
    robot_time_s: f64,
    logged: LoggedState,
    replayed: Option<LoggedState>,
}

#[derive(Debug, Serialize)]
struct LoggedState {
    state: &'static str,
    cycle: f64,
    setpoint_rad: [f64; 2],
    pulse_ns: [u32; 2],
}

impl LoggedState {
    fn new(telemetry: &link_protocol::Telemetry) -> Self {
        Self {
            state: state(telemetry.state),
            cycle: f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 65_536.0,
            setpoint_rad: telemetry_angles(telemetry),
            pulse_ns: telemetry.pulse_ns,
        }
    }
}

impl fmt::Display for LoggedState {
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

impl Comparison {
    fn new(file: String, replayed: &Replayed) -> Self {
        let (verdict, undecided) = match replayed.verdict {
            Verdict::Same => ("same", None),
            Verdict::Differs => ("differs", None),
            Verdict::Undecided(reason) => ("undecided", Some(sentence(reason))),
        };
        Self {
            file,
            same: replayed.verdict == Verdict::Same,
            verdict,
            undecided,
            compared: replayed.compared,
            different: replayed.different,
            requests: replayed.requests,
            seconds: replayed.seconds,
            restarted: replayed.restarted,
            first_difference: replayed.first.map(|Difference { logged, replayed }| {
                FirstDifference {
                    robot_time_s: Duration::from_micros(logged.robot_us).as_secs_f64(),
                    logged: LoggedState::new(&logged),
                    replayed: replayed.as_ref().map(LoggedState::new),
                }
            }),
        }
    }
}

/// Reason for an undecided comparison, with the next step.
fn sentence(reason: Reason) -> String {
    match reason {
        Reason::NothingCompared => {
            "the log holds no telemetry that could be compared; record for longer than a second"
                .to_owned()
        }
        Reason::MissingTable(crc32) => format!(
            "the robot held a gait with CRC {crc32:08x} when the log began: name it with --gait"
        ),
        Reason::OtherSettings(crc32) => format!(
            "the robot had settings (hash {crc32:08x}) that the log does not hold: record after `swimmer robot servo` and `swimmer robot configure` in one session"
        ),
        Reason::LostFrames => {
            "frames were lost shortly before the first difference, and the log does not show which of them the robot read, and when; record over a cable or nearer to the robot"
                .to_owned()
        }
        Reason::TooManyTicks => {
            "the log leaves open for too long when the robot read a request; record over a cable or nearer to the robot"
                .to_owned()
        }
    }
}

impl fmt::Display for Comparison {
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
            if *compared == 0 {
                return write!(f, "undecided.");
            }
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
                .map_or_else(|| "no telemetry".to_owned(), ToString::to_string)
        )?;
        if self.undecided.is_some() {
            write!(f, "\nThat decides nothing.")?;
        }
        Ok(())
    }
}

/// `swimmer robot replay`: exit status 1 if the brain does something else, or if the log decides nothing.
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
    let answer = Comparison::new(arguments.file.display().to_string(), &replayed);
    if replayed.restarted {
        aside(&format!(
            "note: the robot restarts in {}: the {:.1} s before are compared",
            arguments.file.display(),
            replayed.seconds
        ));
    }
    if answer.same {
        output.print(&answer);
        return Ok(());
    }
    let reason = answer.undecided.as_ref().map_or_else(
        || "the log and the brain differ".to_owned(),
        |reason| format!("undecided: {reason}"),
    );
    print_refusal(output, &answer, reason)
}

impl From<ReplayError> for Failure {
    fn from(error: ReplayError) -> Self {
        Self::bad_input(&error)
    }
}
