//! State machine of the monitor: frames and poses in, lines about the play out.

use std::iter;
use std::time::Duration;

use experiment::{Course, Evaluated, Evaluation, GaitOnRobot, Pose, TankWalls, TrackedPlay};
use forecast::{Servos, Tank};
use link_protocol::{Play, StateName, StopCause, Telemetry};
use swimmer_files::SwimmerFile;
use swimmer_model::Model;
use twin::is_configured_as;

use super::super::bench::into_play_s;
use super::super::outputs::cause;
use super::super::rest::is_off;
use super::super::tracked_play::MARGIN_M;
use super::super::tracked_report::{MonitorLine, TrackedMotion, cycle_lines};
use super::super::tracking::{PATIENCE_S, Tracking};
use super::guard::Guard;
use super::overheard::Overheard;
use crate::arguments::model;
use crate::failure::Outcome;

/// Lines that are kept of an endless play.
const MOST_LINES: usize = 40;
/// A pose that is older counts as not seen \[s\].
const STALE_S: f64 = 0.5;
/// Play that was requested and has not begun.
struct Requested {
    play: Play,
    /// The robot's clock at the request \[µs\].
    since_us: u64,
}

/// Follows a robot that another program drives.
pub(super) struct Follower {
    file: SwimmerFile,
    model: Model<f64>,
    walls: Option<TankWalls>,
    /// The tank's swimmer may be another one on purpose.
    is_virtual: bool,
    guard: Guard,
    overheard: Overheard,
    telemetry: Option<Telemetry>,
    requested: Option<Requested>,
    play: Option<TrackedPlay>,
    /// The play has ended; its last cycles may not be evaluated yet.
    is_over: bool,
    /// Cycles whose lines exist.
    shown: usize,
    lines: Vec<MonitorLine>,
    lines_changed: bool,
    latest: Option<Pose>,
    /// Time from which the robot must be seen \[s\]; infinite once it was reported as unseen.
    first_turn_s: Option<f64>,
}

impl Follower {
    /// A follower for a swimmer in a tank.
    ///
    /// # Errors
    /// [`crate::failure::Failure::BadInput`] for a swimmer that cannot swim.
    pub(super) fn new(file: &SwimmerFile, tank: Option<Tank>, is_virtual: bool) -> Outcome<Self> {
        let model = model(file)?;
        let walls = tank.map(|tank| TankWalls {
            tank,
            margin_m: MARGIN_M,
        });
        Ok(Self {
            guard: Guard::new(&model, walls),
            model,
            file: file.clone(),
            walls,
            is_virtual,
            overheard: Overheard::default(),
            telemetry: None,
            requested: None,
            play: None,
            is_over: false,
            shown: 0,
            lines: Vec::new(),
            lines_changed: false,
            latest: None,
            first_turn_s: None,
        })
    }

    /// Takes frames that were sent to the robot now.
    pub(super) fn take_request(&mut self, now: Duration, frames: &[u8]) {
        if let Some(play) = self.overheard.take_request(now, frames) {
            let since_us = self.telemetry.map_or(0, |telemetry| telemetry.robot_us);
            self.requested = Some(Requested { play, since_us });
        }
    }

    /// Takes bytes of the robot that arrived now.
    pub(super) fn take_reply(&mut self, now: Duration, bytes: &[u8], tracking: &mut Tracking) {
        let now_s = now.as_secs_f64();
        for telemetry in self.overheard.take_reply(now, bytes) {
            let before = self.telemetry.replace(telemetry);
            if before.is_some_and(|before| telemetry.robot_us < before.robot_us) {
                // It has restarted.
                self.overheard.clear_clock();
                self.requested = None;
                self.interrupt("the robot has restarted", tracking);
            }
            self.guard.telemetry(now_s, &telemetry);
            if telemetry.state == StateName::Playing {
                self.begin(now_s, &telemetry, tracking);
            }
            if self.is_under_way() && telemetry.state == StateName::Paused {
                self.interrupt("the play was paused", tracking);
            } else if self.is_under_way() && is_off(telemetry.state) {
                if telemetry.cause == StopCause::Finished {
                    self.is_over = true;
                    if let Some(play) = &mut self.play {
                        play.at_rest();
                    }
                } else {
                    self.interrupt(cause(telemetry.cause), tracking);
                }
            }
        }
    }

    /// The port went away, and with it the play.
    pub(super) fn port_gone(&mut self, tracking: &mut Tracking) {
        self.overheard.clear_clock();
        self.telemetry = None;
        self.requested = None;
        self.guard.port_gone();
        self.interrupt("the port is gone", tracking);
    }

    fn is_under_way(&self) -> bool {
        self.play.is_some() && !self.is_over
    }

    /// Ends the comparison before the play's last cycle.
    fn interrupt(&mut self, why: &str, tracking: &mut Tracking) {
        if self.is_under_way() {
            tracking.play_interrupted();
            self.is_over = true;
            self.say(format!("The comparison has ended: {why}."), false);
        }
    }

    /// Begins to follow the play that was requested.
    fn begin(&mut self, now_s: f64, telemetry: &Telemetry, tracking: &mut Tracking) {
        let is_new = |requested: &mut Requested| telemetry.robot_us > requested.since_us;
        let Some(Requested { play, .. }) = self.requested.take_if(is_new) else {
            return;
        };
        self.lines.clear();
        (self.play, self.is_over, self.shown) = (None, false, 0);
        self.lines_changed = true;
        let Some(table) = self.overheard.table(play.checked.table_crc32) else {
            self.say(
                "The cycles are not compared: this gait was not uploaded by a page of this server. Upload it here, and play it again."
                    .to_owned(),
                true,
            );
            return;
        };
        let (Some(hello), Some(configuration)) =
            (&self.overheard.hello, &self.overheard.configuration)
        else {
            self.say(
                "The cycles are not compared: the robot's greeting was missed. Connect again."
                    .to_owned(),
                true,
            );
            return;
        };
        if !self.is_virtual && !is_configured_as(configuration, &self.file.swimmer) {
            self.say(
                format!(
                    "The cycles are not compared: the robot is configured as another swimmer than `{}`. Name its file with `swimmer lab \
                     --swimmer FILE`.",
                    self.file.name
                ),
                true,
            );
            return;
        }
        let servo = self.file.servo.unwrap_or_default();
        let servos = Servos::on_robot(servo, hello, configuration);
        let course = Course::of_cycle(&self.model, table, play.period_us, &servos);
        let robot_s = telemetry.robot_us as f64 / 1e6;
        let fit = self.overheard.clock();
        let reported_s = fit.map_or(now_s, |fit| fit.host_time(robot_s)).min(now_s);
        let began_s = reported_s - into_play_s(telemetry, play.period_us);
        tracking.play_began(course, began_s);
        let cycles = if play.cycles == 0 {
            u32::MAX
        } else {
            play.cycles
        };
        let gait = GaitOnRobot::new(&self.model, table, play.period_us, &servos, cycles);
        self.play = Some(TrackedPlay::new(
            &self.model,
            self.walls,
            gait,
            iter::empty(),
            began_s,
            cycles,
        ));
    }

    /// Takes poses of the cameras. Returns `true` if the robot must stop.
    pub(super) fn poses(&mut self, poses: &[Pose], now_s: f64, tracking: &mut Tracking) -> bool {
        let first_turn_s = *self.first_turn_s.get_or_insert(now_s);
        self.latest = poses.last().copied().or(self.latest);
        if !tracking.knows_front() && now_s - first_turn_s > PATIENCE_S {
            self.first_turn_s = Some(f64::INFINITY);
            let text = tracking.not_shown();
            self.say(text, true);
        }
        if let Some(play) = &mut self.play {
            for pose in poses {
                play.pose(pose);
            }
        }
        let Some(why) = self.guard.poses(poses, now_s) else {
            return false;
        };
        if self.is_under_way() {
            tracking.play_interrupted();
        }
        self.is_over = true;
        self.say(format!("The robot was stopped: {why}."), true);
        true
    }

    /// Pose of the middle link; `None` if it is not seen.
    pub(super) fn pose(&self, now_s: f64) -> Option<[f64; 3]> {
        self.latest
            .filter(|pose| now_s - pose.time_s < STALE_S)
            .map(|pose| [pose.x_m, pose.y_m, pose.heading_rad])
    }

    /// The next cycle to evaluate.
    pub(super) fn take_evaluation(&mut self) -> Option<Evaluation> {
        self.play.as_mut()?.take_evaluation()
    }

    /// Takes the report of a cycle.
    pub(super) fn evaluated(&mut self, evaluated: Evaluated) {
        let Some(play) = &mut self.play else { return };
        play.evaluated(evaluated);
        let lines = cycle_lines(play.reports(), self.shown);
        self.shown = play.reports().len();
        self.lines_changed |= !lines.is_empty();
        self.lines.extend(lines);
    }

    /// Sums the play up once it is over and all its cycles are evaluated.
    pub(super) fn end(&mut self, camera_delay_s: Option<f64>) {
        let is_evaluated = |play: &mut TrackedPlay| play.is_evaluated();
        if !self.is_over {
            return;
        }
        if let Some(play) = self.play.take_if(is_evaluated)
            && !play.reports().is_empty()
        {
            let sum = TrackedMotion::of(&play, camera_delay_s).to_string();
            for line in sum.lines() {
                self.say(line.to_owned(), false);
            }
        }
    }

    /// All lines, if there are new ones since the last call.
    pub(super) fn take_lines(&mut self) -> Option<Vec<MonitorLine>> {
        if !std::mem::take(&mut self.lines_changed) {
            return None;
        }
        let surplus = self.lines.len().saturating_sub(MOST_LINES);
        self.lines.drain(..surplus);
        Some(self.lines.clone())
    }

    /// Forgets the tables that passed over the link.
    #[cfg(test)]
    pub(super) fn forget_tables(&mut self) {
        self.overheard = Overheard::default();
    }

    fn say(&mut self, text: String, warns: bool) {
        self.lines.push(MonitorLine { text, warns });
        self.lines_changed = true;
    }
}
