//! Robot for a caller in the same process: typed requests in, typed reports out, under the rules of the commands.

use std::path::PathBuf;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};

use experiment::Pose;
use host_link::robot::await_play::at_rest;
use link_protocol::Telemetry;
use pose_source::SourceName;
use serde::Serialize;
use swimmer_files::{AnyGait, Axes, GaitFile, SwimmerFile, check_playable_period};

use super::access::{Access, RobotConnection};
use super::motion::{PlayRequest, begin, until_end};
use super::outputs::{self, RobotState, is_under_way, telemetry_angles};
use super::port::Pace;
use super::preflight::configured;
use super::rest::{nothing_under_way, stopped_on_failure, wait_for_rest};
use super::tank_cameras::TankCameras;
use super::tracking::{Tracked, Tracking, Visible, port_s};
use super::upload::{Prepared, upload};
use crate::captured::{Noted, NotedFailure, noted};
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::recording::LiveAxes;

/// Holder of the port, as other processes see it.
const HOLDER: &str = "a program that uses the library";
/// Longest wait for telemetry or poses \[s\].
const PATIENCE_S: f64 = 1.0;
/// Time between two calls after which the robot is greeted again \[s\]: its session may have ended.
const IDLE_S: f64 = 1.0;

/// Cameras and port of a robot.
#[derive(Debug, Clone, Default)]
pub struct RobotOptions {
    /// Port, as `--port` names it; of several the one where a robot answers; empty for the one serial port where a robot answers.
    pub ports: Vec<String>,
    /// Speed of the serial line; `None` for the usual one.
    pub baud: Option<u32>,
    /// File of the robot's key.
    pub key: Option<PathBuf>,
    /// New link log.
    pub log: Option<PathBuf>,
    /// Source of the cameras' frames, as `--track` names it. `None`: those of a fresh virtual robot, and none for any other.
    pub track: Option<String>,
    /// Name of the reflector at the front end of the middle link.
    pub front: Option<String>,
    /// Name of the reflector at its back end.
    pub back: Option<String>,
    /// Name of a rigid body instead.
    pub body: Option<String>,
    /// Heading at the start, for reflectors without names \[rad\].
    pub facing_rad: Option<f64>,
    /// Metres per unit of the source of frames.
    pub scale: Option<f64>,
    /// The source's axes that are the tank's x and y.
    pub axes: Option<Axes>,
    /// Swimmer that the robot is, if no preset describes it; the truth in the tank of a fresh virtual robot.
    pub swimmer: Option<SwimmerFile>,
    /// Seed of a fresh virtual robot.
    pub seed: u64,
}

impl RobotOptions {
    fn access(&self) -> Access {
        Access::new(
            self.ports.clone(),
            self.baud,
            self.key.clone(),
            self.log.clone(),
        )
    }

    fn cameras(&self, access: &Access) -> Outcome<Option<Tracked>> {
        let source = match &self.track {
            Some(text) => text.parse::<SourceName>().map_err(Failure::BadInput)?,
            None if access.is_fresh() => SourceName::Twin,
            None => return Ok(None),
        };
        let visible = Visible::new(
            self.front.clone(),
            self.back.clone(),
            self.body.clone(),
            self.facing_rad,
            LiveAxes::new(self.scale, self.axes),
        );
        Ok(Some(Tracked::new(source, visible)))
    }

    /// Access and cameras of a command that needs both.
    ///
    /// # Errors
    /// [`Failure::BadInput`] without a source of frames.
    pub(crate) fn tracked(&self) -> Outcome<(Access, Tracked)> {
        let access = self.access();
        let cameras = self.cameras(&access)?;
        cameras.map(|cameras| (access, cameras)).ok_or_else(|| {
            Failure::BadInput(
                "name the source of the cameras' frames: natnet[:HOST], tcp:HOST:PORT or -"
                    .to_owned(),
            )
        })
    }
}

/// Report of the robot, with its time of arrival.
#[derive(Debug, Clone, Serialize)]
pub struct TelemetryReport {
    /// Time on the port's clock \[s\].
    pub time_s: f64,
    /// Time on the robot's clock \[s\].
    pub robot_time_s: f64,
    /// State.
    pub state: &'static str,
    /// Cycles done, with the fraction of the present one.
    pub cycles: f64,
    /// Set-points φ₁ and φ₂ \[rad\].
    pub phi: [f64; 2],
    /// Pose that the robot computes for itself, from the start of the play: x, y \[m\] and heading \[rad\].
    pub pose: [f64; 3],
    /// Battery \[V\]; `None` if it is not measured.
    pub battery_v: Option<f64>,
}

impl TelemetryReport {
    fn new(telemetry: &Telemetry, time_s: f64) -> Self {
        let pose = &telemetry.pose;
        Self {
            time_s,
            robot_time_s: std::time::Duration::from_micros(telemetry.robot_us).as_secs_f64(),
            state: outputs::state(telemetry.state),
            cycles: f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 65_536.0,
            phi: telemetry_angles(telemetry),
            pose: [pose.x, pose.y, pose.theta].map(f64::from),
            battery_v: telemetry.battery_mv.map(|mv| f64::from(mv) / 1e3),
        }
    }
}

/// View of a robot whose handle another thread uses.
#[derive(Debug, Clone)]
pub struct Stopper {
    interrupt: Interrupt,
    is_moving: Arc<AtomicBool>,
}

impl Stopper {
    /// Requests the end of the call: it stops the robot and fails, as every later one until [`RobotHandle::stop`].
    pub fn request(&self) {
        self.interrupt.request();
    }

    /// `true` if a play has begun and no report has shown its end.
    pub fn is_moving(&self) -> bool {
        self.is_moving.load(Ordering::SeqCst)
    }
}

/// Robot behind a port, and the cameras that see it.
///
/// The lease of the robot is renewed while a call runs, and not between calls: a real robot that moves stops half a second after the
/// last call. The clock of a fresh virtual robot stands still between calls.
pub struct RobotHandle {
    line: RobotConnection,
    tracking: Option<Tracking>,
    interrupt: Interrupt,
    swimmer: Option<SwimmerFile>,
    /// A play has begun, and no report has shown its end.
    is_moving: Arc<AtomicBool>,
    /// End of the last call on the port's clock \[s\].
    last_s: f64,
}

/// Function that a waiting call polls; `true` stops the robot.
pub type IsInterrupted = Box<dyn Fn() -> bool + Send + Sync>;

/// Result of a call, with its messages.
pub type Reply<T> = Result<Noted<T>, NotedFailure>;

impl RobotHandle {
    /// Connects. While a call waits it polls `is_interrupted`, and `true` stops the robot.
    ///
    /// # Errors
    /// Bad options, a port that cannot be opened, or no reply.
    pub fn connect(options: &RobotOptions, is_interrupted: IsInterrupted) -> Reply<Self> {
        let interrupt = Interrupt::polled(is_interrupted);
        noted(|| Self::connected(options, interrupt))
    }

    fn connected(options: &RobotOptions, interrupt: Interrupt) -> Outcome<Self> {
        let access = options.access();
        let cameras = options.cameras(&access)?;
        if let Some(cameras) = &cameras {
            cameras.cameras().check(access.is_fresh())?;
        }
        let tank = TankCameras::default();
        let mut line = if access.is_fresh() {
            let usual = || SwimmerFile::preset("robot");
            let file = options.swimmer.clone().or_else(usual).ok_or_else(|| {
                Failure::Tried("the preset `robot` is missing: name a swimmer".to_owned())
            })?;
            access.connect_filmed(HOLDER, &file, options.seed, &tank)?
        } else {
            access.connect(HOLDER, Pace::RealTime)?
        };
        line.stops_on(&interrupt);
        let status = line.robot.status()?;
        let tracking = match &cameras {
            None => None,
            Some(cameras) => {
                let links = match &options.swimmer {
                    Some(file) => file.swimmer.links,
                    None => configured(&line.robot.configuration()?).1.links,
                };
                Some(cameras.cameras().open(tank, &links)?)
            }
        };
        Ok(Self {
            last_s: port_s(&line),
            line,
            tracking,
            interrupt,
            swimmer: options.swimmer.clone(),
            is_moving: Arc::new(AtomicBool::new(is_under_way(status.state))),
        })
    }

    /// View for other threads.
    pub fn stopper(&self) -> Stopper {
        Stopper {
            interrupt: self.interrupt.clone(),
            is_moving: Arc::clone(&self.is_moving),
        }
    }

    /// Name of the port.
    pub fn port(&self) -> &str {
        self.line.name()
    }

    fn set_moving(&self, is_moving: bool) {
        self.is_moving.store(is_moving, Ordering::SeqCst);
    }

    /// Time on the port's clock \[s\].
    pub fn now_s(&self) -> f64 {
        port_s(&self.line)
    }

    /// State of the robot.
    ///
    /// # Errors
    /// The link's.
    pub fn status(&mut self) -> Reply<impl Serialize + use<>> {
        self.call(|robot| {
            let state = RobotState::of(&mut robot.line.robot)?;
            Ok(state)
        })
    }

    /// Checks, forecasts and uploads the gait of a file with its curve; it becomes the active one. `name` is for messages,
    /// `period_s` for the forecast.
    ///
    /// # Errors
    /// A gait of another swimmer, one that must not be played, and the link's.
    pub fn upload(
        &mut self,
        name: &str,
        curve: AnyGait,
        file: &GaitFile,
        period_s: f64,
    ) -> Reply<impl Serialize + use<>> {
        self.call(|robot| {
            check_playable_period(period_s).map_err(|error| Failure::bad_input(&error))?;
            nothing_under_way(&robot.line.robot.status()?)?;
            let swimmer = robot.swimmer.as_ref();
            upload(
                &mut robot.line,
                Prepared::of_file(name.to_owned(), curve, file)?,
                swimmer,
                period_s,
                &robot.interrupt,
            )
        })
    }

    /// Arms the robot and begins a play of its gait. `None`: without end.
    ///
    /// # Errors
    /// A play under way, a refusal, and the link's; the robot is stopped.
    pub fn play(&mut self, cycles: Option<u32>, period_s: f64) -> Reply<()> {
        self.call(|robot| {
            check_playable_period(period_s).map_err(|error| Failure::bad_input(&error))?;
            if cycles == Some(0) {
                return Err(Failure::BadInput("play at least one cycle".to_owned()));
            }
            let status = robot.line.robot.status()?;
            nothing_under_way(&status)?;
            let play = PlayRequest {
                cycles,
                period_s,
                detached: false,
            };
            begin(&mut robot.line.robot, &play, status.held())?;
            robot.set_moving(true);
            Ok(())
        })
    }

    /// Waits until the last cycle has ended and the pulses are off.
    ///
    /// # Errors
    /// An interrupt, after which the robot is stopped; another cause of the end; and the link's.
    pub fn wait(&mut self) -> Reply<impl Serialize + use<>> {
        self.call(|robot| {
            let played = until_end(&mut robot.line, &robot.interrupt, |_| {});
            // A play that failed was stopped.
            robot.set_moving(false);
            played
        })
    }

    /// Ramps to neutral and switches the pulses off; returns the state then.
    ///
    /// # Errors
    /// The link's.
    pub fn stop(&mut self) -> Reply<impl Serialize + use<>> {
        self.interrupt.clear();
        self.call(|robot| {
            robot.halt()?;
            Ok(RobotState::of(&mut robot.line.robot)?)
        })
    }

    /// Waits for the next report of the robot. `None` if no report arrives within a second; the link may be lost.
    ///
    /// # Errors
    /// An interrupt, after which the robot is stopped; and the link's.
    pub fn next_telemetry(&mut self) -> Reply<Option<TelemetryReport>> {
        self.call(|robot| {
            let end_s = robot.now_s() + PATIENCE_S;
            while robot.now_s() < end_s {
                if let Some(telemetry) = robot.beat()? {
                    return Ok(Some(TelemetryReport::new(&telemetry, robot.now_s())));
                }
            }
            Ok(None)
        })
    }

    /// Waits for poses by the cameras. Empty if the robot is not seen for a second.
    ///
    /// # Errors
    /// A robot without cameras, or one that they do not show at first; an interrupt, after which the robot is stopped; and the
    /// link's.
    pub fn next_poses(&mut self) -> Reply<Vec<Pose>> {
        self.call(|robot| {
            let Some(tracking) = &mut robot.tracking else {
                return Err(Failure::BadInput(
                    "no cameras see this robot: connect with a source of frames, such as track=\"natnet:HOST\""
                        .to_owned(),
                ));
            };
            tracking.wait_for_robot(&mut robot.line, &robot.interrupt)?;
            let end_s = robot.now_s() + PATIENCE_S;
            while robot.now_s() < end_s {
                robot.beat()?;
                let now_s = robot.now_s();
                let tracking = robot.tracking.as_mut();
                let poses = tracking.map_or(Ok(Vec::new()), |tracking| tracking.poses(now_s))?;
                if !poses.is_empty() {
                    return Ok(poses);
                }
            }
            Ok(Vec::new())
        })
    }

    /// Stops the robot if it moves, and closes port and log.
    ///
    /// # Errors
    /// The link's, and those of writing the log.
    pub fn close(mut self) -> Reply<()> {
        noted(|| {
            self.interrupt.clear();
            let stopped = if self.stopper().is_moving() {
                self.halt()
            } else {
                Ok(())
            };
            self.line.close().and(stopped)
        })
    }

    fn halt(&mut self) -> Outcome {
        self.set_moving(false);
        self.line.robot.stop()?;
        wait_for_rest(&mut self.line.robot)?;
        Ok(())
    }

    /// Listens for a moment; returns new telemetry.
    fn beat(&mut self) -> Outcome<Option<Telemetry>> {
        if self.interrupt.requested() {
            self.halt()?;
            return Err(Failure::Tried(
                "interrupted: the robot is stopped".to_owned(),
            ));
        }
        let news = self.line.beat();
        let news = stopped_on_failure(&mut self.line.robot, news)?;
        if let Some(telemetry) = &news {
            self.set_moving(!at_rest(telemetry.state, telemetry.cause));
        }
        Ok(news)
    }

    fn call<T>(&mut self, work: impl FnOnce(&mut Self) -> Outcome<T>) -> Reply<T> {
        noted(|| {
            if self.now_s() - self.last_s > IDLE_S {
                self.line.robot.reconnect()?;
            }
            let outcome = work(self);
            self.last_s = self.now_s();
            outcome
        })
    }
}
