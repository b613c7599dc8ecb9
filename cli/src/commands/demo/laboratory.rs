//! The laboratory of the demo: a robot behind a link, its tank, and cameras that write a track of every play.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::port::TracedPort;
use host_link::{LinkError, Robot};
use link_protocol::{StateName, TableInfo};
use swimmer_files::{ServoFile, SwimmerFile};
use twin::{VirtualRobot as _, configuration};

use crate::failure::Outcome;
use crate::interrupt::Interrupt;
use crate::link_log::{Recorder, Sink};
use crate::virtual_robot::VirtualLine;

/// An upload takes less than a second; this is for a robot that never answers.
const PATIENCE: Duration = Duration::from_mins(1);
/// Longest time from the last cycle's end to pulses off.
const TO_REST: Duration = Duration::from_secs(5);

/// A robot in a virtual tank with cameras over it, reached only through its link; every frame on the link is logged.
pub(super) struct Laboratory {
    robot: Robot<TracedPort<VirtualLine, Sink>>,
    log: Recorder,
    interrupt: Interrupt,
}

impl Laboratory {
    /// Greets the robot behind `line`.
    pub(super) fn open(
        line: VirtualLine,
        seed: u64,
        log: &Path,
        interrupt: Interrupt,
    ) -> Outcome<Self> {
        let log = Recorder::create(log)?;
        let robot = Robot::connect(TracedPort::new(line, log.sink(Duration::ZERO)), seed)?;
        Ok(Self {
            robot,
            log,
            interrupt,
        })
    }

    /// Tells the robot its body, for the pose that it predicts on board.
    pub(super) fn configure(&mut self, body: &SwimmerFile, servo: &ServoFile) -> Outcome {
        Ok(self.robot.configure(configuration(&body.swimmer, servo)?)?)
    }

    /// Sends a table; the robot checks it.
    ///
    /// # Errors
    /// [`LinkError::Refused`] where the robot must not play it.
    pub(super) fn upload(&mut self, table: &GaitTable) -> Result<TableInfo, LinkError> {
        let interrupt = &self.interrupt;
        self.robot
            .upload(table.bytes(), PATIENCE, |_| go_on(interrupt))
    }

    /// Plays the table while the cameras record, and writes the track.
    pub(super) fn swim(&mut self, cycles: u32, period: Duration, track: &Path) -> Outcome {
        self.robot
            .port_mut()
            .inner_mut()
            .device_mut()
            .world_mut()
            .start_recording(track)?;
        let interrupt = self.interrupt.clone();
        let robot = &mut self.robot;
        robot.arm(false)?;
        robot.play(cycles, period, false)?;
        robot.wait_until_finished(|_| go_on(&interrupt))?;
        robot
            .port_mut()
            .inner_mut()
            .device_mut()
            .world_mut()
            .finish_recording()?;
        // The robot ramps to neutral; only then does it take orders again.
        robot.listen(TO_REST, |telemetry| match telemetry {
            Some(telemetry) if telemetry.state == StateName::Stopped => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        })?;
        Ok(())
    }

    /// Lets the robot go and closes the link log.
    pub(super) fn close(self) -> Outcome {
        drop(self.robot);
        self.log.finish().map(|_| ())
    }
}

fn go_on(interrupt: &Interrupt) -> ControlFlow<()> {
    if interrupt.requested() {
        ControlFlow::Break(())
    } else {
        ControlFlow::Continue(())
    }
}
