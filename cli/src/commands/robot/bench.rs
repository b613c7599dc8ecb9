//! Robot and cameras as one source of events: a fresh virtual robot in virtual time, or a robot behind a port with a source of frames.
//! Every command that tracks the robot while it swims runs on this loop.

use std::path::Path;
use std::time::Duration;

use experiment::{Course, Evaluated, Evaluation, Event, Interruption};
use forecast::{PlaylistTable, Servos};
use host_link::LinkError;
use link_protocol::{Checked, Configuration, StateName, Status, StopCause, Telemetry};
use pose_source::SourceName;
use swimmer_files::SwimmerFile;
use swimmer_model::Model;
use twin::is_configured_as;

use super::access::{Access, RobotConnection};
use super::evaluator::Evaluator;
use super::motion::MAY_JUMP;
use super::outputs::cause;
use super::passive;
use super::port::Pace;
use super::rest::{is_off, nothing_under_way, wait_for_rest};
use super::tank_cameras::TankCameras;
use super::tracking::{CamerasOf, Tracking, port_s};
use super::upload::send_table;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::output::aside;

/// A robot that does not start a play within this time is given up \[s\].
const LONGEST_START_S: f64 = 10.0;

/// Motion of the robot, as requested.
enum Motion {
    Resting,
    Playing(Play),
    /// Stopping since this time on the robot's clock \[µs\].
    Stopping(u64),
}

/// Play under way.
#[derive(Clone, Copy)]
struct Play {
    /// The robot's clock after the request \[µs\]: telemetry from before is of another play.
    since_us: u64,
    period_us: u32,
    requested_s: f64,
    has_begun: bool,
}

/// Robot and cameras. All times are on the clock of the port.
pub(crate) struct Bench {
    line: RobotConnection,
    tracking: Tracking,
    evaluator: Evaluator,
    /// Time stands still while a cycle is evaluated, so that a run in virtual time is the same every time.
    is_virtual: bool,
    interrupt: Interrupt,
    model: Model<f64>,
    servos: Servos,
    motion: Motion,
    /// Course of a cycle of the play under way, until the play begins.
    course: Option<Course>,
    operator_reported: bool,
}

impl Bench {
    /// Connects, and waits until the cameras show the robot. `seed` is that of a fresh virtual robot, in whose tank the port's
    /// swimmer, otherwise `file`, is the truth. Other processes see `command` as the holder of the port.
    ///
    /// # Errors
    /// As the connection and the source of frames; [`Failure::Tried`] if a robot is configured as another swimmer, if a play is
    /// under way, or if the cameras do not show the robot.
    pub(crate) fn open(
        access: &Access,
        command: &str,
        cameras: CamerasOf<'_>,
        file: &SwimmerFile,
        seed: u64,
        interrupt: Interrupt,
    ) -> Outcome<Self> {
        cameras.check(access.is_fresh())?;
        let model = crate::arguments::model(file)?;
        let tank = TankCameras::default();
        let mut tracking = cameras.open(tank.clone(), &file.swimmer.links)?;
        let is_virtual = *cameras.source == SourceName::Twin;
        let mut line = if is_virtual {
            access.connect_filmed(command, file, seed, &tank)?
        } else {
            access.connect(command, Pace::RealTime)?
        };
        line.stops_on(&interrupt);
        let status = line.robot.status()?;
        nothing_under_way(&status)?;
        if let Some(reason) = passive::refusal("this command", None, status.flags.passive()) {
            return Err(Failure::Tried(reason));
        }
        let configuration = line.robot.configuration()?;
        // The swimmer of a virtual tank may be another on purpose.
        if !is_virtual && !is_configured_as(&configuration, &file.swimmer) {
            return Err(Failure::Tried(format!(
                "the robot is configured as another swimmer than `{}`: name its file, or send this one with `swimmer robot configure \
                 --swimmer FILE`",
                file.name
            )));
        }
        let servo = file.servo.unwrap_or_default();
        let servos = Servos::on_robot(servo, line.robot.info(), &configuration);
        tracking.wait_for_robot(&mut line, &interrupt)?;
        aside(MAY_JUMP);
        Ok(Self {
            line,
            tracking,
            evaluator: Evaluator::start(Evaluation::run)?,
            is_virtual,
            interrupt,
            model,
            servos,
            motion: Motion::Resting,
            course: None,
            operator_reported: false,
        })
    }

    /// Model of the swimmer.
    pub(super) fn model(&self) -> &Model<f64> {
        &self.model
    }

    /// Swimmer and limits that the robot is configured for.
    ///
    /// # Errors
    /// The link's.
    pub(super) fn configuration(&mut self) -> Outcome<Configuration> {
        Ok(self.line.robot.configuration()?)
    }

    /// State of the robot.
    ///
    /// # Errors
    /// The link's.
    pub(super) fn status(&mut self) -> Outcome<Status> {
        Ok(self.line.robot.status()?)
    }

    /// Servos of the robot, described by the swimmer file.
    pub(crate) fn servos(&self) -> &Servos {
        &self.servos
    }

    /// Present time \[s\].
    pub(crate) fn now_s(&self) -> f64 {
        port_s(&self.line)
    }

    /// Delay of the cameras that they do not state \[s\]; `None` until a play has shown it.
    pub(crate) fn camera_delay_s(&self) -> Option<f64> {
        self.tracking.delay_s()
    }

    /// Waits for 20 ms, and returns the events.
    ///
    /// # Errors
    /// If a track cannot be written.
    pub(crate) fn advance(&mut self) -> Outcome<Vec<Event>> {
        let mut events = if self.is_virtual {
            self.remaining_evaluations()?
        } else {
            in_boxes(self.evaluator.take())
        };
        let news = self.line.beat();
        let now_s = self.now_s();
        let poses = self.tracking.poses(now_s)?;
        events.extend(poses.into_iter().map(Event::Pose));
        if self.is_stopped_by_operator() && !self.operator_reported {
            self.operator_reported = true;
            events.push(Event::Interrupted(Interruption::Operator));
        }
        match news {
            Ok(Some(telemetry)) => self.follow(&telemetry, &mut events),
            Ok(None) => {}
            Err(error) => events.push(interruption(&error)),
        }
        if let Motion::Playing(play) = self.motion
            && !play.has_begun
            && now_s - play.requested_s > LONGEST_START_S
        {
            self.motion = Motion::Resting;
            let reason = format!("it did not start a play within {LONGEST_START_S} s");
            events.push(Event::Interrupted(Interruption::Robot(reason)));
        }
        Ok(events)
    }

    /// Evaluates a cycle while the link goes on; [`Self::advance`] returns the result.
    ///
    /// # Errors
    /// If the thread that evaluates has ended.
    pub(crate) fn evaluate(&mut self, evaluation: Box<Evaluation>) -> Outcome {
        self.evaluator.submit(evaluation)
    }

    /// Waits for the results of all evaluations. The link is not kept alive meanwhile.
    ///
    /// # Errors
    /// As [`Self::evaluate`].
    pub(super) fn remaining_evaluations(&mut self) -> Outcome<Vec<Event>> {
        Ok(in_boxes(self.evaluator.wait()?))
    }

    /// Returns `true` if the operator stops, here or by another process.
    fn is_stopped_by_operator(&self) -> bool {
        self.interrupt.requested() || self.line.was_stopped()
    }

    /// Follows the robot's reports.
    fn follow(&mut self, telemetry: &Telemetry, events: &mut Vec<Event>) {
        let now_s = self.now_s();
        match self.motion {
            Motion::Playing(mut play) if telemetry.robot_us > play.since_us => {
                let is_off = is_off(telemetry.state);
                let has_finished = is_off && telemetry.cause == StopCause::Finished;
                if !play.has_begun && (telemetry.state == StateName::Playing || has_finished) {
                    play.has_begun = true;
                    let began_s = self.began_s(telemetry, play.period_us);
                    if let Some(course) = self.course.take() {
                        self.tracking.play_began(course, began_s);
                    }
                    events.push(Event::Began(began_s));
                }
                self.motion = Motion::Playing(play);
                if is_off {
                    self.motion = Motion::Resting;
                    events.push(if has_finished {
                        Event::AtRest(now_s)
                    } else {
                        self.tracking.play_interrupted();
                        stopped_by_itself(telemetry.cause)
                    });
                }
            }
            Motion::Stopping(since_us)
                if telemetry.robot_us > since_us && is_off(telemetry.state) =>
            {
                self.motion = Motion::Resting;
                events.push(match telemetry.cause {
                    StopCause::Requested | StopCause::Finished => Event::AtRest(now_s),
                    other => stopped_by_itself(other),
                });
            }
            _ => {}
        }
    }

    /// Time of the first cycle's first set-point on the port's clock \[s\].
    fn began_s(&self, telemetry: &Telemetry, period_us: u32) -> f64 {
        let now_s = self.now_s();
        let into_s = into_play_s(telemetry, period_us);
        let fit = self.line.robot.clock();
        let reported_s = fit.map_or(now_s, |fit| fit.host_time(telemetry.robot_us as f64 / 1e6));
        reported_s.min(now_s) - into_s
    }

    /// Sends a table unless the robot holds it, and plays it. Returns an event if the robot refuses or is lost.
    pub(crate) fn play(&mut self, name: &str, table: &PlaylistTable) -> Option<Event> {
        match self.begin(name, table) {
            Ok(()) => None,
            // The next `advance` reports the operator.
            Err(_) if self.is_stopped_by_operator() => None,
            Err(failure) => {
                self.motion = Motion::Resting;
                let _ = self.line.robot.stop();
                Some(Event::Interrupted(Interruption::Robot(failure.to_string())))
            }
        }
    }

    fn begin(&mut self, name: &str, table: &PlaylistTable) -> Outcome {
        let held = self.line.robot.held()?;
        let table_crc32 = table.table.crc32();
        if held.table_crc32 != table_crc32 {
            send_table(&mut self.line, name, &table.table, &self.interrupt)?;
        }
        if self.is_stopped_by_operator() {
            return Ok(());
        }
        let robot = &mut self.line.robot;
        let checked = Checked {
            table_crc32,
            ..held
        };
        robot.arm(false)?;
        let period = Duration::from_micros(table.period_us.into());
        robot.play_checked(table.cycles, period, false, checked)?;
        let since_us = robot.status()?.robot_us;
        let course = Course::of_cycle(&self.model, &table.table, table.period_us, &self.servos);
        self.course = Some(course);
        self.motion = Motion::Playing(Play {
            since_us,
            period_us: table.period_us,
            requested_s: self.now_s(),
            has_begun: false,
        });
        Ok(())
    }

    /// Stops the robot. Returns an event if the link fails.
    pub(crate) fn stop(&mut self) -> Option<Event> {
        self.tracking.play_interrupted();
        let stopped = self
            .line
            .robot
            .stop()
            .and_then(|_| self.line.robot.status());
        match stopped {
            // The state of this moment counts as well: a robot at rest may send no other.
            Ok(status) => self.motion = Motion::Stopping(status.robot_us.saturating_sub(1)),
            Err(error) => return Some(interruption(&error)),
        }
        None
    }

    /// Records the frames from now on into this CSV file, in place of one of the same name.
    ///
    /// # Errors
    /// If it cannot be made.
    pub(crate) fn begin_track(&mut self, path: &Path) -> Outcome {
        self.tracking.begin_track(path)
    }

    /// Ends the track, and waits until it is on the disk.
    ///
    /// # Errors
    /// If it cannot be written.
    pub(crate) fn end_track(&mut self) -> Outcome {
        self.tracking.end_track()
    }

    /// Lets the robot go once it is at rest, and closes the log.
    ///
    /// # Errors
    /// If the log cannot be written.
    pub(crate) fn close(mut self) -> Outcome {
        if !matches!(self.motion, Motion::Resting) {
            // As far as the link still allows; the robot stops by itself otherwise.
            let stopped = self.line.robot.stop();
            let _ = stopped.and_then(|_| wait_for_rest(&mut self.line.robot));
        }
        self.line.close()
    }
}

/// Time since the first set-point of a play \[s\].
pub(super) fn into_play_s(telemetry: &Telemetry, period_us: u32) -> f64 {
    let cycles = f64::from(telemetry.cycle) + f64::from(telemetry.phase) / 65_536.0;
    cycles * f64::from(period_us) / 1e6
}

fn in_boxes(results: Vec<Evaluated>) -> Vec<Event> {
    let boxed = results.into_iter().map(Box::new);
    boxed.map(Event::Evaluated).collect()
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
