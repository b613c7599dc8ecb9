//! The robot's log and the cameras' track of one session: with the log, phases are right even if the track alone determines them
//! poorly, and cycles interrupted by a pause are left out.

use crate::traced;

use std::ops::ControlFlow;
use std::path::Path;
use std::time::Duration;

use calibrate::{
    CycleWarning, LeftOut, Phase, RunData, RunResult, Timing, TrackOptions, calibrate_run,
    load_run, usual_reflectors,
};
use gait_player::GaitTable;
use host_link::Robot;
use host_link::port::TracedPort;
use link_protocol::StateName;
use swimmer_files::{AnyGait, GaitSpec, Play, ServoFile, SwimmerFile, plays};
use swimmer_model::Gait as _;
use traced::traced;
use twin::{CameraConfig, Recording, TwinConfig, TwinPort};

const PERIOD_S: f64 = 10.0;

/// One session: what the log says of its play, and what the cameras saw.
struct Session {
    play: Play,
    recording: Recording,
    data: RunData,
    file: SwimmerFile,
    _folder: tempfile::TempDir,
}

fn session(amplitude: &str, noise: f64, pause_s: Option<f64>, seed: u64) -> Session {
    let folder = tempfile::tempdir().unwrap();
    let track = folder.path().join("run.csv");
    let gait: GaitSpec = format!("circle:{amplitude}").parse().unwrap();
    let shape: AnyGait = gait.load().unwrap();
    let file = SwimmerFile {
        servo: Some(ServoFile::default()),
        ..SwimmerFile::preset("robot").unwrap()
    };
    let mut config = TwinConfig::new(&file, seed);
    config.camera = CameraConfig {
        noise_sd: noise,
        ..CameraConfig::default()
    };
    let (port, frames) = traced(config);
    let mut robot = Robot::connect(port, 1).unwrap();
    let table = GaitTable::from_fn(512, |u| shape.at(u).phi.into()).unwrap();
    robot
        .upload(table.bytes(), Duration::from_mins(1), |_| {
            ControlFlow::Continue(())
        })
        .unwrap();
    let device = |robot: &mut Robot<TracedPort<TwinPort, _>>, path: Option<&Path>| {
        let device = robot.port_mut().inner_mut().device_mut();
        match path {
            Some(path) => device.start_recording(path).map(|()| None).unwrap(),
            None => device.finish_recording().unwrap(),
        }
    };
    device(&mut robot, Some(&track));
    robot.arm(false).unwrap();
    robot
        .play(8, Duration::from_secs_f64(PERIOD_S), false)
        .unwrap();
    if let Some(pause_s) = pause_s {
        let wait = |robot: &mut Robot<_>, seconds: f64| {
            robot
                .listen(Duration::from_secs_f64(seconds), |_| {
                    ControlFlow::<()>::Continue(())
                })
                .unwrap();
        };
        // In the middle of the fourth cycle.
        wait(&mut robot, 3.4 * PERIOD_S);
        robot.pause(false).unwrap();
        wait(&mut robot, pause_s);
        robot.resume().unwrap();
    }
    robot
        .wait_until_finished(|_| ControlFlow::Continue(()))
        .unwrap();
    robot
        .listen(Duration::from_secs(10), |telemetry| match telemetry {
            Some(telemetry) if telemetry.state == StateName::Stopped => ControlFlow::Break(()),
            _ => ControlFlow::Continue(()),
        })
        .unwrap();
    let recording = device(&mut robot, None).unwrap();
    drop(robot);
    let frames = frames.lock().unwrap();
    let mut plays = plays(&frames);
    assert_eq!(plays.len(), 1, "{plays:?}");
    Session {
        play: plays.remove(0),
        recording,
        data: load_run(&track, &gait, PERIOD_S, &TrackOptions::default()).unwrap(),
        file,
        _folder: folder,
    }
}

impl Session {
    /// By this timing, with the heading's phase left to a swimmer of another drag than the tank's.
    fn run(&self, timing: Timing) -> RunResult {
        let data = RunData {
            timing,
            ..self.data.clone()
        };
        let reflectors = usual_reflectors(&data.track, &self.file.swimmer);
        calibrate_run(&data, &reflectors, &self.file).unwrap()
    }

    /// The robot's clock and the twin's are one.
    fn with_offset(&self) -> Timing {
        Timing {
            play: Some(self.play.clone()),
            clock_offset_s: Some(self.recording.started.as_secs_f64()),
            cycle_start_s: None,
        }
    }

    fn with_log(&self) -> Timing {
        Timing {
            play: Some(self.play.clone()),
            ..Timing::default()
        }
    }

    /// The true starts by the cameras' time.
    fn truth(&self) -> Vec<f64> {
        let since = |start: &twin::CycleStart| {
            start.at.as_secs_f64() - self.recording.started.as_secs_f64()
        };
        self.recording.cycle_starts.iter().map(since).collect()
    }

    /// The largest distance of a cycle's start from the nearest true one \[s\].
    fn off(&self, run: &RunResult) -> f64 {
        let truth = self.truth();
        let nearest = |start: f64| {
            truth
                .iter()
                .map(|t| (t - start).abs())
                .fold(f64::INFINITY, f64::min)
        };
        run.cycles
            .cycles
            .iter()
            .map(|cycle| nearest(cycle.start_s))
            .fold(0.0, f64::max)
    }
}

#[test]
fn the_logs_cycles_are_the_robots() {
    let session = session("70deg", 3e-4, None, 1);
    assert!((session.play.period_s - PERIOD_S).abs() < 1e-12);
    assert_eq!(session.play.cycle_starts.len(), 8);
    assert!(session.play.unsteady.is_empty(), "{:?}", session.play);
    let by_log = session.run(session.with_offset());
    let by_heading = session.run(Timing::default());
    let (log, heading) = (session.off(&by_log), session.off(&by_heading));
    println!(
        "good cameras: starts by the log off by {:.1} ms, by the heading {:.1} ms",
        1e3 * log,
        1e3 * heading
    );
    // The log has a resolution of 20 ms; its means over a cycle are accurate to a millisecond.
    assert!(log < 2e-3 && heading < 20e-3, "{log} {heading}");
    assert_eq!(
        (by_log.cycles.phase, by_heading.cycles.phase),
        (Phase::Log, Phase::Heading)
    );
    assert!((by_log.cycles.x.mean - by_heading.cycles.x.mean).abs() < 2e-5);

    // The flash alone, and the log with clocks that nobody tied.
    let flash = Timing {
        cycle_start_s: Some(session.truth()[3]),
        ..Timing::default()
    };
    assert!(session.off(&session.run(flash)) < 5e-3);
    let loose = session.run(session.with_log());
    assert_eq!(loose.cycles.phase, Phase::LogAndHeading);
    assert!(session.off(&loose) < 20e-3);
    assert!(matches!(loose.cycles.left_out[..], [(_, LeftOut::StartUp)]));
}

#[test]
fn the_log_helps_where_the_heading_says_little() {
    // Five degrees of amplitude under bad cameras: noise of 1.5 mm is 1.7 degrees of heading, more than it swings.
    let (mut log, mut heading) = (Vec::new(), Vec::new());
    for seed in 0..4 {
        let session = session("5deg", 1.5e-3, None, 10 + seed);
        log.push(session.off(&session.run(session.with_offset())));
        heading.push(session.off(&session.run(Timing::default())));
    }
    let worst = |offs: &[f64]| offs.iter().copied().fold(0.0, f64::max);
    println!(
        "bad cameras: starts by the log off by {:.1} ms, by the heading {:.1} ms",
        1e3 * worst(&log),
        1e3 * worst(&heading)
    );
    assert!(
        worst(&log) < 10e-3 && worst(&heading) > 4.0 * worst(&log),
        "{log:?} {heading:?}"
    );
}

#[test]
fn a_pause_costs_one_cycle() {
    let session = session("70deg", 3e-4, Some(7.3), 2);
    assert_eq!(
        (session.play.cycle_starts.len(), session.play.unsteady.len()),
        (7, 1)
    );
    let run = session.run(session.with_offset());
    assert!(session.off(&run) < 2e-3);
    let unsteady = |(_, why): &&(f64, LeftOut)| *why == LeftOut::Unsteady;
    assert_eq!(run.cycles.left_out.iter().filter(unsteady).count(), 1);
    // Of eight cycles the first and the paused one are lost; a track alone loses those after the pause, or keeps wrong ones.
    assert_eq!(run.cycles.cycles.len(), 6, "{:?}", run.cycles.left_out);
    // The flash finds its cycle among the log's, on either side of the pause.
    for flash in [1, 6] {
        let timing = Timing {
            cycle_start_s: Some(session.truth()[flash]),
            ..session.with_log()
        };
        let run = session.run(timing);
        assert!(session.off(&run) < 5e-3 && run.cycles.cycles.len() == 6);
    }
}

#[test]
fn a_wrong_offset_is_noticed() {
    let session = session("70deg", 3e-4, None, 3);
    let mut timing = session.with_offset();
    timing.clock_offset_s = timing.clock_offset_s.map(|offset| offset + 2.0);
    let warnings = session.run(timing).cycles.warnings;
    assert!(
        matches!(warnings[..], [CycleWarning::PhaseDiffers { by_s, .. }] if (by_s - 2.0).abs() < 0.05),
        "{warnings:?}"
    );
}
