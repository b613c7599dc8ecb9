//! Monitor of a robot that another program drives: the bytes on the port show which table plays and when, the cameras where the robot
//! is.
//!
//! It runs on a thread of its own, so that no prediction delays the bytes. It has no session with the robot and sends nothing.

mod follower;
mod guard;
mod overheard;
#[cfg(test)]
mod tests;

use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc::{Receiver, RecvTimeoutError, SyncSender, channel, sync_channel};
use std::thread;
use std::time::Duration;

use experiment::Evaluation;
use forecast::Tank;
use pose_source::SourceName;
use swimmer_files::SwimmerFile;

use self::follower::Follower;
use super::evaluator::Evaluator;
use super::tank_cameras::TankCameras;
use super::tracked_report::MonitorLine;
use super::tracking::{Tracking, Visible};
use crate::arguments::load_swimmer;
use crate::failure::{Failure, Outcome};

/// Interval at which frames of the cameras are read.
const BEAT: Duration = Duration::from_millis(20);
/// Pieces of traffic that wait. If the monitor falls further behind, pieces are lost, as on a line.
const WAITING: usize = 1024;
/// Least time between two reported poses \[s\].
const POSE_EVERY_S: f64 = 0.05;

/// Cameras that see a robot which another program drives.
#[derive(Debug, clap::Args)]
#[command(next_help_heading = "Tracking")]
pub(crate) struct LinkMonitorOptions {
    /// Show what cameras see, and compare each cycle with the prediction: natnet[:HOST[,LOCAL]] (Motive), tcp:HOST:PORT (JSON lines), -
    /// (JSON lines on standard input), or `twin` for the cameras of --port twin or emulator. A robot that plays and is not seen for
    /// 5 s is stopped
    #[arg(long, value_name = "SOURCE", requires = "port")]
    track: Option<SourceName>,
    /// A preset that `swimmer swimmers` lists, or a swimmer file; the predictions are for it, and with `--track twin` it is the truth
    /// of the tank
    #[arg(
        long,
        value_name = "SWIMMER",
        default_value = "robot",
        requires = "track"
    )]
    swimmer: String,
    /// Stop the robot 10 mm from a wall of this tank, whose centre is the origin of the cameras: length x width, m
    #[arg(long, value_name = "LENGTHxWIDTH", requires = "track")]
    tank: Option<Tank>,
    #[command(flatten)]
    visible: Visible,
}

/// Cameras and swimmer before the port is open.
pub(crate) struct CamerasOverLink {
    options: LinkMonitorOptions,
    source: SourceName,
    pub(super) file: SwimmerFile,
    pub(super) tank: TankCameras,
}

impl LinkMonitorOptions {
    /// Loads the swimmer. Returns `None` without a source. `is_fresh`: the robot is a virtual one of this process.
    ///
    /// # Errors
    /// [`Failure::BadInput`] for a source that cannot show this robot, or a swimmer that cannot be read.
    pub(crate) fn cameras(self, is_fresh: bool) -> Outcome<Option<CamerasOverLink>> {
        let Some(source) = self.track.clone() else {
            return Ok(None);
        };
        self.visible.of(&source).check(is_fresh)?;
        Ok(Some(CamerasOverLink {
            file: load_swimmer(&self.swimmer)?,
            options: self,
            source,
            tank: TankCameras::default(),
        }))
    }
}

impl CamerasOverLink {
    /// Returns `true` if the cameras are those over a fresh virtual robot.
    pub(super) fn are_virtual(&self) -> bool {
        self.source == SourceName::Twin
    }

    /// Opens the source. `clock_us` is the port's clock.
    ///
    /// # Errors
    /// A connection that is refused.
    fn thread(self, clock_us: Arc<AtomicU64>) -> Outcome<MonitorThread> {
        let links = self.file.swimmer.links;
        let cameras = self.options.visible.of(&self.source);
        Ok(MonitorThread {
            tracking: cameras.open(self.tank.clone(), &links)?,
            follower: Follower::new(&self.file, self.options.tank, self.are_virtual())?,
            evaluator: Evaluator::start(Evaluation::run)?,
            clock_us,
            pose: None,
            posed_s: f64::NEG_INFINITY,
        })
    }

    /// Opens the source, and starts the thread.
    ///
    /// # Errors
    /// A connection that is refused.
    pub(crate) fn start(self) -> Outcome<LinkMonitor> {
        let (to_monitor, traffic) = sync_channel(WAITING);
        let (to_hub, reports) = channel();
        let clock_us = Arc::new(AtomicU64::new(0));
        let mut thread = self.thread(Arc::clone(&clock_us))?;
        thread::Builder::new()
            .name("monitor of the link".to_owned())
            .spawn(move || {
                loop {
                    let first = match traffic.recv_timeout(BEAT) {
                        Ok(piece) => Some(piece),
                        Err(RecvTimeoutError::Timeout) => None,
                        Err(RecvTimeoutError::Disconnected) => return,
                    };
                    let pieces = first.into_iter().chain(traffic.try_iter());
                    let turn = thread.turn(pieces);
                    let ends = turn.is_err();
                    // Nobody watches the robot any more.
                    let news = turn.unwrap_or_else(|failure| {
                        let text = format!("The tracking has ended: {failure}");
                        let line = MonitorLine { text, warns: true };
                        vec![MonitorReport::Stop, MonitorReport::Lines(vec![line])]
                    });
                    if news.into_iter().any(|report| to_hub.send(report).is_err()) || ends {
                        return;
                    }
                }
            })
            .map_err(|error| {
                Failure::Tried(format!("cannot start a thread for the cameras: {error}"))
            })?;
        Ok(LinkMonitor {
            traffic: to_monitor,
            reports,
            clock_us,
        })
    }
}

/// Bytes on the link.
enum Traffic {
    /// From the robot, with their time of arrival on the port's clock.
    FromRobot(Duration, Box<[u8]>),
    /// To the robot, with the time at which they were sent.
    ToRobot(Duration, Box<[u8]>),
    /// The port went away.
    PortGone,
}

/// Report of the monitor.
#[derive(Debug, Clone, PartialEq)]
pub(crate) enum MonitorReport {
    /// Pose of the middle link in the tank: x, y \[m\] and heading \[rad\]; `None` while the robot is not seen.
    Pose(Option<[f64; 3]>),
    /// All lines about the play.
    Lines(Vec<MonitorLine>),
    /// The robot must stop.
    Stop,
}

/// Monitor that runs on its thread until it is dropped.
pub(crate) struct LinkMonitor {
    traffic: SyncSender<Traffic>,
    reports: Receiver<MonitorReport>,
    clock_us: Arc<AtomicU64>,
}

impl LinkMonitor {
    /// Sets the present time on the port's clock.
    pub(crate) fn at(&self, now: Duration) {
        let now_us = u64::try_from(now.as_micros()).unwrap_or(u64::MAX);
        self.clock_us.store(now_us, Ordering::Relaxed);
    }

    /// Takes bytes of the robot that arrived now.
    pub(crate) fn take_reply(&self, bytes: &[u8]) {
        self.pass(Traffic::FromRobot(self.now(), bytes.into()));
    }

    /// Takes frames that were sent to the robot.
    pub(crate) fn take_request(&self, frames: &[u8]) {
        self.pass(Traffic::ToRobot(self.now(), frames.into()));
    }

    /// The port went away.
    pub(crate) fn port_gone(&self) {
        self.pass(Traffic::PortGone);
    }

    /// Reports since the last call.
    pub(crate) fn reports(&self) -> impl Iterator<Item = MonitorReport> + '_ {
        self.reports.try_iter()
    }

    fn now(&self) -> Duration {
        Duration::from_micros(self.clock_us.load(Ordering::Relaxed))
    }

    fn pass(&self, traffic: Traffic) {
        // A monitor that is too slow or has ended must not hold up the link.
        let _ = self.traffic.try_send(traffic);
    }
}

/// State of the thread.
struct MonitorThread {
    tracking: Tracking,
    follower: Follower,
    evaluator: Evaluator,
    clock_us: Arc<AtomicU64>,
    /// Latest reported pose.
    pose: Option<[f64; 3]>,
    /// Time of that report \[s\].
    posed_s: f64,
}

impl MonitorThread {
    /// Takes traffic and frames of the cameras. Returns what is new.
    fn turn(&mut self, traffic: impl Iterator<Item = Traffic>) -> Outcome<Vec<MonitorReport>> {
        for piece in traffic {
            match piece {
                Traffic::FromRobot(now, bytes) => {
                    self.follower.take_reply(now, &bytes, &mut self.tracking);
                }
                Traffic::ToRobot(now, frames) => self.follower.take_request(now, &frames),
                Traffic::PortGone => self.follower.port_gone(&mut self.tracking),
            }
        }
        let now_s = Duration::from_micros(self.clock_us.load(Ordering::Relaxed)).as_secs_f64();
        let poses = self.tracking.poses(now_s)?;
        for evaluated in self.evaluator.take() {
            self.follower.evaluated(evaluated);
        }
        let mut reports = Vec::new();
        if self.follower.poses(&poses, now_s, &mut self.tracking) {
            reports.push(MonitorReport::Stop);
        }
        while let Some(evaluation) = self.follower.take_evaluation() {
            self.evaluator.submit(Box::new(evaluation))?;
        }
        self.follower.end(self.tracking.delay_s());
        let pose = self.follower.pose(now_s);
        if pose != self.pose && (pose.is_none() || now_s - self.posed_s >= POSE_EVERY_S) {
            (self.pose, self.posed_s) = (pose, now_s);
            reports.push(MonitorReport::Pose(pose));
        }
        let lines = self.follower.take_lines();
        reports.extend(lines.map(MonitorReport::Lines));
        Ok(reports)
    }
}
