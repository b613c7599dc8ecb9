//! `swimmer robot watch` and `log`: listen until Ctrl-C, move nothing.

use std::fmt;
use std::time::Duration;

use link_protocol::Telemetry;
use serde::Serialize;

use super::access::{Access, BEAT, Line};
use super::answers::{Doing, telemetry_line};
use super::port::Pace;
use super::{Log, Watch};
use crate::failure::Outcome;
use crate::interrupt::Interrupt;
use crate::output::Output;

/// Robot time between two lines.
const LINE_EVERY: Duration = Duration::from_secs(1);

/// `swimmer robot watch`: a line each second; at the end the status.
pub(super) fn watch(access: &Access, arguments: &Watch, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut line = access.connect("swimmer robot watch", Pace::RealTime)?;
    let mut due = 0;
    listen(&mut line, arguments.seconds, &interrupt, |telemetry| {
        if telemetry.robot_us >= due {
            due = telemetry.robot_us + u64::try_from(LINE_EVERY.as_micros()).unwrap_or(u64::MAX);
            output.line(&telemetry_line(telemetry));
        }
    })?;
    let status = line.robot.status()?;
    if output.json {
        output.answer(&Doing::new(&status));
    }
    line.close()
}

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

/// `swimmer robot log`: every frame both ways into an MCAP file.
pub(super) fn log(access: &Access, arguments: &Log, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let access = access.logging_to(arguments.file.clone());
    let mut line = access.connect("swimmer robot log", Pace::RealTime)?;
    listen(&mut line, arguments.seconds, &interrupt, |_| {})?;
    let frames = line.close_log()?;
    output.answer(&Logged {
        file: arguments.file.display().to_string(),
        frames: frames.unwrap_or_default(),
    });
    Ok(())
}

/// Listens for so many seconds, or until Ctrl-C.
fn listen(
    line: &mut Line,
    seconds: Option<f64>,
    interrupt: &Interrupt,
    mut each: impl FnMut(&Telemetry),
) -> Outcome {
    let mut left = seconds.map(Duration::from_secs_f64);
    while !interrupt.requested() && left.is_none_or(|left| !left.is_zero()) {
        if let Some(telemetry) = line.beat()? {
            each(&telemetry);
        }
        left = left.map(|left| left.saturating_sub(BEAT));
    }
    Ok(())
}
