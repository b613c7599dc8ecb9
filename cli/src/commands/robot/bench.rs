//! Robot and cameras of an experiment, as one struct: a fresh virtual robot in virtual time, or a robot behind a port with a source
//! of frames.

use std::io;
use std::path::{Path, PathBuf};
use std::sync::{Arc, Mutex};
use std::time::Duration;

use experiment::unattended::{Event, Interruption};
use experiment::{Arrivals, Pose};
use gait_player::GaitTable;
use host_link::{LinkError, Port};
use link_protocol::{StateName, StopCause, Telemetry};
use pose_source::{Frame, Received, Recorder, Settings, SourceName, Stream, twin_frame};
use swimmer_files::SwimmerFile;

use super::access::{Access, RobotConnection};
use super::motion::MAY_JUMP;
use super::outputs::cause;
use super::port::{AnyPort, Pace};
use super::preflight::Player;
use super::rest::nothing_under_way;
use super::upload::send_table;
use crate::failure::{Failure, Outcome};
use crate::interrupt::{Interrupt, locked};
use crate::output::aside;
use crate::virtual_robot::VirtualLine;

/// Standard deviation of a coordinate of a point \[m\]: good cameras.
const POINT_SIGMA_M: f64 = 3e-4;
/// Distance of the points on which a rigid body's heading rests, if it is not known \[m\].
const BODY_SPAN_M: f64 = 0.07;
/// A robot that does not start a play within this time is given up \[s\].
const LONGEST_START_S: f64 = 10.0;

/// Frames of a virtual robot's cameras that nobody has taken yet.
pub(super) type Frames = Arc<Mutex<Vec<Frame>>>;

/// A line to a virtual robot that keeps the frames of its cameras.
struct Watched {
    port: VirtualLine,
    frames: Frames,
}

impl Watched {
    fn take_frames(&mut self) {
        let world = self.port.device_mut().world_mut();
        let taken = world.take_frames();
        locked(&self.frames).extend(taken.map(|(stamp, seen)| twin_frame(&seen, stamp)));
    }
}

impl Port for Watched {
    fn read(&mut self, buf: &mut [u8], timeout: Duration) -> io::Result<usize> {
        let count = self.port.read(buf, timeout);
        self.take_frames();
        count
    }

    fn write(&mut self, bytes: &[u8]) -> io::Result<()> {
        self.port.write(bytes)
    }

    fn now(&self) -> Duration {
        self.port.now()
    }
}

/// A port to a virtual robot whose cameras are on.
pub(super) fn watched(mut port: VirtualLine, frames: &Frames) -> AnyPort {
    port.device_mut().world_mut().watch();
    Box::new(Watched {
        port,
        frames: Arc::clone(frames),
    })
}

enum Cameras {
    Virtual(Frames),
    Live { stream: Stream, arrivals: Arrivals },
}

/// Play that was requested.
struct Play {
    period_s: f64,
    requested_s: f64,
    has_begun: bool,
}

/// Robot and cameras. All times are on the clock of the port.
pub(crate) struct Bench {
    line: RobotConnection,
    cameras: Cameras,
    interrupt: Interrupt,
    play: Option<Play>,
    is_stopping: bool,
    has_interrupted: bool,
    track: Option<(PathBuf, Recorder)>,
}

impl Bench {
    /// Connects. `seed` is that of a fresh virtual robot, in whose tank `file` is the truth.
    ///
    /// # Errors
    /// As the connection, and the source of frames.
    pub(crate) fn open(
        access: &Access,
        track: &SourceName,
        file: &SwimmerFile,
        seed: u64,
        interrupt: Interrupt,
    ) -> Outcome<Self> {
        let command = "swimmer experiment run";
        let (mut line, cameras) = if *track == SourceName::Twin {
            let frames = Frames::default();
            let line = access.connect_watched(command, file, seed, &frames)?;
            (line, Cameras::Virtual(frames))
        } else {
            if access.names_a_virtual_robot() {
                return Err(Failure::BadInput(format!(
                    "{track} does not see the virtual robot; with --port twin use --track twin"
                )));
            }
            let stream = Stream::open(track, &Settings::default())?;
            let cameras = Cameras::Live {
                stream,
                arrivals: Arrivals::default(),
            };
            (access.connect(command, Pace::RealTime)?, cameras)
        };
        line.stops_on(&interrupt);
        nothing_under_way(&line.robot.status()?)?;
        aside(MAY_JUMP);
        Ok(Self {
            line,
            cameras,
            interrupt,
            play: None,
            is_stopping: false,
            has_interrupted: false,
            track: None,
        })
    }

    /// Servos of the robot, described by a swimmer file.
    ///
    /// # Errors
    /// The link's.
    pub(crate) fn servos(&mut self, file: &SwimmerFile) -> Outcome<forecast::Servos> {
        let configuration = self.line.robot.configuration()?;
        let hello = self.line.robot.info();
        Ok(Player::of_robot(hello, &configuration, Some(file)).servos)
    }

    /// Present time \[s\].
    pub(crate) fn now_s(&self) -> f64 {
        self.line.robot.port().now().as_secs_f64()
    }

    /// Waits for 20 ms, and returns what happened.
    ///
    /// # Errors
    /// If a track cannot be written.
    pub(crate) fn advance(&mut self) -> Outcome<Vec<Event>> {
        let news = self.line.beat();
        let mut events = self.poses()?;
        if self.interrupt.requested() && !self.has_interrupted {
            self.has_interrupted = true;
            events.push(Event::Interrupted(Interruption::Operator));
        }
        match news {
            Ok(Some(telemetry)) => events.extend(self.telemetry(&telemetry)),
            Ok(None) => {}
            Err(error) => events.push(interruption(&error)),
        }
        let now = self.now_s();
        if let Some(play) = &self.play
            && !play.has_begun
            && now - play.requested_s > LONGEST_START_S
        {
            self.play = None;
            let reason = format!("it did not start a play within {LONGEST_START_S} s");
            events.push(Event::Interrupted(Interruption::Robot(reason)));
        }
        Ok(events)
    }

    fn poses(&mut self) -> Outcome<Vec<Event>> {
        let now = self.now_s();
        let mut timed: Vec<(f64, Frame)> = Vec::new();
        let mut ended = None;
        match &mut self.cameras {
            Cameras::Virtual(frames) => {
                let frames = std::mem::take(&mut *locked(frames));
                timed.extend(frames.into_iter().map(|frame| (frame.stamp_s, frame)));
            }
            Cameras::Live { stream, arrivals } => loop {
                match stream.next(Duration::ZERO) {
                    Received::Frame(frame) => {
                        let exposed = frame.stamp_s + frame.latency_s.unwrap_or(0.0);
                        arrivals.push(exposed, now);
                        let offset = arrivals.bounds(0.0, 0.0).map_or(0.0, |bounds| bounds[1]);
                        timed.push((frame.stamp_s + offset, frame));
                    }
                    Received::Nothing => break,
                    Received::Ended(outcome) => {
                        ended = Some(outcome);
                        break;
                    }
                }
            },
        }
        let mut events = Vec::with_capacity(timed.len());
        for (time_s, frame) in timed {
            if let Some((_, recorder)) = &mut self.track {
                recorder
                    .write(&frame)
                    .map_err(|error| Failure::tried(&error))?;
            }
            events.extend(pose(&frame, time_s).map(Event::Pose));
        }
        if let Some(Err(error)) = ended {
            aside(&format!("warning: {error}"));
        }
        Ok(events)
    }

    fn telemetry(&mut self, telemetry: &Telemetry) -> Option<Event> {
        let is_off = matches!(telemetry.state, StateName::Stopped | StateName::EStopped);
        if self.is_stopping && is_off {
            self.is_stopping = false;
            self.play = None;
            return Some(match telemetry.cause {
                StopCause::Requested | StopCause::Finished => Event::AtRest(self.now_s()),
                other => stopped_by_itself(other),
            });
        }
        let now = self.now_s();
        let robot_s = telemetry.robot_us as f64 * 1e-6;
        let clock = self.line.robot.clock();
        let play = self.play.as_mut()?;
        match telemetry.state {
            StateName::Playing if !play.has_begun => {
                play.has_begun = true;
                let here_s = clock.map_or(now, |clock| clock.host_time(robot_s));
                let cycles = f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 65_536.0;
                Some(Event::Began(here_s - cycles * play.period_s))
            }
            _ if is_off && play.has_begun => {
                self.play = None;
                Some(match telemetry.cause {
                    StopCause::Finished => Event::AtRest(now),
                    other => stopped_by_itself(other),
                })
            }
            _ if is_off
                && !matches!(
                    telemetry.cause,
                    StopCause::Finished | StopCause::Requested | StopCause::Boot
                ) =>
            {
                self.play = None;
                Some(stopped_by_itself(telemetry.cause))
            }
            _ => None,
        }
    }

    /// Sends a table unless the robot holds it, and plays it. Returns an event if the robot refuses or is lost.
    pub(crate) fn play(
        &mut self,
        name: &str,
        table: &GaitTable,
        cycles: u32,
        period_us: u32,
    ) -> Option<Event> {
        match self.begin(name, table, cycles, period_us) {
            Ok(()) => None,
            Err(Failure::Tried(_)) if self.interrupt.requested() => None,
            Err(failure) => {
                self.play = None;
                let _ = self.line.robot.stop();
                Some(Event::Interrupted(Interruption::Robot(failure.to_string())))
            }
        }
    }

    fn begin(&mut self, name: &str, table: &GaitTable, cycles: u32, period_us: u32) -> Outcome {
        let mut checked = self.line.robot.held()?;
        if checked.table_crc32 != table.crc32() {
            send_table(&mut self.line, name, table, &self.interrupt)?;
            checked.table_crc32 = table.crc32();
        }
        let robot = &mut self.line.robot;
        robot.arm(false)?;
        let period = Duration::from_micros(period_us.into());
        robot.play_checked(cycles, period, false, checked)?;
        self.play = Some(Play {
            period_s: period.as_secs_f64(),
            requested_s: self.now_s(),
            has_begun: false,
        });
        Ok(())
    }

    /// Stops the robot. Returns an event if the link fails.
    pub(crate) fn stop(&mut self) -> Option<Event> {
        self.is_stopping = true;
        self.line
            .robot
            .stop()
            .err()
            .map(|error| interruption(&error))
    }

    /// Records the frames from now on into this CSV file, in place of one of the same name.
    ///
    /// # Errors
    /// If it cannot be made.
    pub(crate) fn begin_track(&mut self, path: &Path) -> Outcome {
        let recorder = Recorder::create(path).map_err(|error| Failure::tried(&error))?;
        self.track = recorder.map(|recorder| (path.to_path_buf(), recorder));
        Ok(())
    }

    /// Ends the track, and waits until it is on the disk.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn end_track(&mut self) -> Outcome {
        let Some((path, recorder)) = self.track.take() else {
            return Ok(());
        };
        recorder.finish().map_err(|error| Failure::tried(&error))?;
        let synced = std::fs::File::open(&path).and_then(|file| file.sync_all());
        synced.map_err(|error| {
            Failure::Tried(format!(
                "cannot write {}: {error}; is the disk full?",
                path.display()
            ))
        })
    }

    /// Lets the robot go, and closes the log.
    ///
    /// # Errors
    /// If the log cannot be written.
    pub(crate) fn close(self) -> Outcome {
        self.line.close()
    }
}

fn stopped_by_itself(why: StopCause) -> Event {
    Event::Interrupted(Interruption::Robot(cause(why).to_owned()))
}

fn interruption(error: &LinkError) -> Event {
    let text = error.to_string();
    Event::Interrupted(match error {
        LinkError::Refused { .. } | LinkError::StoppedEarly { .. } => Interruption::Robot(text),
        _ => Interruption::Link(text),
    })
}

/// Pose of the middle link by the only rigid body of a frame, or by the points `Front` and `Back`.
fn pose(frame: &Frame, time_s: f64) -> Option<Pose> {
    let [front, back] = pose_source::TWIN_REFLECTORS.map(|name| frame.marker(name));
    let (x_m, y_m, heading_rad, span) = match (front, back, frame.bodies.as_slice()) {
        (Some(front), Some(back), _) => {
            let (dx, dy) = (front.x_m - back.x_m, front.y_m - back.y_m);
            (
                f64::midpoint(front.x_m, back.x_m),
                f64::midpoint(front.y_m, back.y_m),
                dy.atan2(dx),
                dx.hypot(dy),
            )
        }
        (_, _, [body]) => (
            body.position[0],
            body.position[1],
            body.heading_rad(),
            BODY_SPAN_M,
        ),
        _ => return None,
    };
    let root = std::f64::consts::SQRT_2;
    (span > 0.0).then(|| Pose {
        time_s,
        x_m,
        y_m,
        heading_rad,
        sigma_position_m: POINT_SIGMA_M / root,
        sigma_heading_rad: POINT_SIGMA_M * root / span,
    })
}
