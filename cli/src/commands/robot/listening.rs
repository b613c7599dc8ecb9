//! `swimmer robot watch` and `log`: listen until Ctrl-C, move nothing.

use std::fmt;
use std::ops::ControlFlow;
use std::sync::{Arc, Mutex, PoisonError};
use std::time::Duration;

use host_link::Robot;
use host_link::port::TracedPort;
use link_protocol::Telemetry;
use serde::Serialize;
use swimmer_files::{LinkFrame, LinkLogError, LinkLogWriter};

use super::answers::{Doing, telemetry_line};
use super::port::{AnyPort, Pace, connect, open, session_seed};
use super::{Log, Watch};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::link_log::link_frame;
use crate::output::Output;

/// Robot time between two lines.
const LINE_EVERY: Duration = Duration::from_secs(1);

/// `swimmer robot watch`: a line each second; at the end the status.
pub(super) fn watch(port: Option<&str>, arguments: &Watch, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    let mut robot = connect(port, Pace::RealTime)?;
    let mut due = 0;
    listen(&mut robot, arguments.seconds, &interrupt, |telemetry| {
        if telemetry.robot_us >= due {
            due = telemetry.robot_us + u64::try_from(LINE_EVERY.as_micros()).unwrap_or(u64::MAX);
            output.line(&telemetry_line(telemetry));
        }
    })?;
    let status = robot.status()?;
    if output.json {
        output.answer(&Doing::new(&status));
    }
    Ok(())
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
pub(super) fn log(port: Option<&str>, arguments: &Log, output: Output) -> Outcome {
    let interrupt = Interrupt::install()?;
    if arguments.file.exists() {
        let shown = arguments.file.display();
        return Err(Failure::BadInput(format!(
            "{shown} exists; name a new file for the link log"
        )));
    }
    let log = Arc::new(Mutex::new(Recording {
        writer: LinkLogWriter::create(&arguments.file)?,
        frames: 0,
        failed: None,
    }));
    let sink = Arc::clone(&log);
    let traced: AnyPort = Box::new(TracedPort::new(
        open(port, Pace::RealTime)?,
        move |frame: host_link::port::TracedFrame<'_>| {
            sink.lock()
                .unwrap_or_else(PoisonError::into_inner)
                .add(&link_frame(&frame));
        },
    ));
    let mut robot = Robot::connect(traced, session_seed())?;
    listen(&mut robot, arguments.seconds, &interrupt, |_| {})?;
    drop(robot);
    let Some(recording) = Arc::into_inner(log).and_then(|log| log.into_inner().ok()) else {
        return Err(Failure::Tried(
            "the link log is still in use; nothing was written".into(),
        ));
    };
    if let Some(error) = recording.failed {
        return Err(Failure::tried(&error));
    }
    recording.writer.finish()?;
    output.answer(&Logged {
        file: arguments.file.display().to_string(),
        frames: recording.frames,
    });
    Ok(())
}

struct Recording {
    writer: LinkLogWriter,
    frames: u64,
    failed: Option<LinkLogError>,
}

impl Recording {
    fn add(&mut self, frame: &LinkFrame) {
        if self.failed.is_none() {
            self.failed = self.writer.write(frame).err();
            self.frames += 1;
        }
    }
}

/// Listens for so many seconds, or until Ctrl-C.
fn listen(
    robot: &mut Robot<AnyPort>,
    seconds: Option<f64>,
    interrupt: &Interrupt,
    mut each: impl FnMut(&Telemetry),
) -> Outcome {
    let time = seconds.map_or(
        Duration::from_secs(u64::from(u32::MAX)),
        Duration::from_secs_f64,
    );
    robot.listen(time, |telemetry| {
        if let Some(telemetry) = telemetry {
            each(telemetry);
        }
        if interrupt.requested() {
            ControlFlow::Break(())
        } else {
            ControlFlow::Continue(())
        }
    })?;
    Ok(())
}
