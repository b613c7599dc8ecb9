//! One play of a twin over the link, in virtual time.

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use gait_player::GaitTable;
use host_link::Robot;
use link_protocol::{StopCause, Telemetry};
use swimmer_files::SwimmerFile;
use swimmer_model::{Circle, Gait, Pose};
use twin::{CycleStart, Recording, Twin, TwinConfig, TwinPort, WireSpeed};

/// Results of a play.
pub(crate) struct Played {
    /// Cycle starts, including the end of the last cycle.
    pub(crate) cycle_starts: Vec<CycleStart>,
    /// Pose after the last cycle, at rest.
    pub(crate) end: Pose<f64>,
    pub(crate) telemetry: Vec<Telemetry>,
    pub(crate) recording: Option<Recording>,
    pub(crate) finished: bool,
}

/// The paper's robot.
pub(crate) fn robot() -> SwimmerFile {
    SwimmerFile::preset("robot").unwrap()
}

pub(crate) fn circle(amplitude: f64) -> Circle<f64> {
    Circle { amplitude }
}

/// Table of `knots` knots on a gait.
pub(crate) fn table(knots: usize, gait: &impl Gait<f64>) -> GaitTable {
    GaitTable::from_fn(knots, |u| {
        let phi = gait.at(u).phi;
        [phi.x, phi.y]
    })
    .unwrap()
}

/// Uploads, plays `cycles` cycles of `period_s`, and waits for the end.
pub(crate) fn play(config: TwinConfig, table: &GaitTable, cycles: u32, period_s: f64) -> Played {
    play_recorded(config, table, cycles, period_s, None)
}

/// Plays under the cameras.
pub(crate) fn play_recorded(
    config: TwinConfig,
    table: &GaitTable,
    cycles: u32,
    period_s: f64,
    track: Option<&Path>,
) -> Played {
    let mut twin = Twin::new(config).unwrap();
    if let Some(track) = track {
        twin.start_recording(track).unwrap();
    }
    let mut robot = Robot::connect(TwinPort::new(twin, WireSpeed::robot()), 1).unwrap();
    robot
        .upload(table.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    robot.arm(false).unwrap();
    // One extra cycle, whose start marks the end of the last requested one.
    robot
        .play(cycles + 1, Duration::from_secs_f64(period_s), false)
        .unwrap();
    let mut telemetry = Vec::new();
    let status = robot
        .wait_until_finished(|news| {
            telemetry.extend(news.copied());
            ControlFlow::Continue(())
        })
        .unwrap();
    robot
        .listen(Duration::from_secs(2), |news| {
            telemetry.extend(news.copied());
            ControlFlow::Continue(())
        })
        .unwrap();
    let mut twin = robot.into_port().into_device();
    let cycle_starts = twin.cycle_starts().to_vec();
    assert_eq!(cycle_starts.len(), cycles as usize + 1);
    Played {
        cycle_starts,
        end: twin.pose(),
        telemetry,
        recording: twin.finish_recording().unwrap(),
        finished: status.cause == StopCause::Finished && status.cycle == cycles + 1,
    }
}
