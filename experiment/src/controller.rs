//! Controller: drives the robot to poses, or holds its heading, one cycle at a time.
//!
//! ```text
//!            chosen             began                at rest
//!  Resting ─────────► Waiting ─────────► Playing ───────────────► Resting
//!     │                                     │ wall near, track lost       ▲
//!     │ goal reached, or a reason to end    ▼                             │
//!     └──────────────► Ended ◄────────── Stopping ────────────────────────┘
//! ```
//!
//! The robot rests, straight, after every cycle, and nothing moves it until the next request. So a track that is lost, a link that
//! is lost and a controller that hangs all end in rest within one cycle. While a cycle plays, the robot is stopped at once if it
//! comes nearer to a wall than the margin, or if it is not seen and a wall is nearer than the cycle's own motion.
//!
//! Each cycle is evaluated ([`Request::Evaluate`]) while the robot rests; the next cycle waits for the result.
//!
//! At rest the mean of the poses is compared with the prediction, which corrects the estimates of gains and drift, and the
//! next cycle is the first of the quickest chain to the target that [`forecast::Planner`] finds with what was learned.

mod choice;
mod ending;

use forecast::{Member, Planner, Step};
use nalgebra::Vector2;
use swimmer_model::wrapped_angle;

use crate::learning::{Learning, TrackedCycle};
use crate::monitor::{CycleReport, Likeness, Monitor};
use crate::pose::mean;
use crate::{Course, Evaluated, Evaluation, Event, Interruption, Pose, TankWalls};

pub use ending::Ending;

/// Time after the robot reports rest from which poses count \[s\]: the last set-point has been reached.
const SETTLING_S: f64 = 0.1;
/// Poses older than this are not averaged \[s\].
const AVERAGED_S: f64 = 2.0;
/// Averaging stops when the standard error of the pose is this fraction of the tolerance, or after the longest time \[s\].
const SHARE_OF_TOLERANCE: f64 = 0.1;
const LONGEST_AVERAGE_S: f64 = 1.5;
/// Poses in a row that must lie outside the margin: one may be wrong.
const POSES_OUTSIDE: u32 = 3;

/// Pose to reach.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Target {
    /// Position of the middle link along the tank \[m\].
    pub x_m: f64,
    /// Position across the tank \[m\].
    pub y_m: f64,
    /// Heading \[rad\]; `None`: any.
    pub heading_rad: Option<f64>,
}

/// Task of the controller.
#[derive(Debug, Clone, PartialEq)]
pub enum Goal {
    /// Reach these poses one after the other.
    Reach(Vec<Target>),
    /// Swim this many forward cycles and hold a heading \[rad\].
    Hold {
        /// Heading \[rad\].
        heading_rad: f64,
        /// Cycles.
        cycles: u32,
    },
}

/// Tolerances and times.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Options {
    /// Distance to a target \[m\].
    pub within_m: f64,
    /// Angle to a target's heading \[rad\].
    pub within_rad: f64,
    /// Distance from the walls \[m\] that plans keep beyond the planner's margin, for errors of the model.
    pub spare_m: f64,
    /// A pose older than this does not count as seen \[s\].
    pub longest_age_s: f64,
    /// Longest time that a robot at rest waits for a lost track \[s\].
    pub longest_wait_s: f64,
    /// Seconds from the end of a cycle to the start of the next one, for the first guess.
    pub pause_s: f64,
    /// Cycles after which the target is given up.
    pub most_cycles: u32,
}

impl Default for Options {
    /// 3 mm and 1°; poses up to half a second old.
    fn default() -> Self {
        Self {
            within_m: 3e-3,
            within_rad: 1_f64.to_radians(),
            spare_m: 5e-3,
            longest_age_s: 0.5,
            longest_wait_s: 5.0,
            pause_s: 2.0,
            most_cycles: 400,
        }
    }
}

/// Request to the robot.
#[derive(Debug, Clone, PartialEq)]
pub enum Request {
    /// Play the cycles of this step, from rest to rest.
    Play(Step),
    /// Stop at once.
    Stop,
    /// Evaluate a cycle; the result is the event [`Event::Evaluated`].
    Evaluate(Box<Evaluation>),
}

/// Drives one robot.
#[derive(Debug)]
pub struct Controller {
    planner: Planner,
    goal: Goal,
    options: Options,
    monitor: Monitor,
    learning: Learning,
    phase: Phase,
    poses: Vec<Pose>,
    last_seen_s: Option<f64>,
    /// Mean pose at the last rest.
    rest: Option<Pose>,
    /// Cycle played since then, if it was not interrupted.
    played: Option<Member>,
    /// Joint angles at rest, within the dead band of straight \[rad\].
    rest_shape: Vector2<f64>,
    /// Steps that are planned after the cycle under way.
    chain: Vec<Step>,
    pause_s: f64,
    target: usize,
    cycles: u32,
    forward_cycles: u32,
    worst_heading_rad: f64,
    outside: u32,
    /// The last cycle confirmed a departure that nothing explains.
    unexplained: bool,
    operator_stop: bool,
    /// Cycle to evaluate.
    evaluation: Option<Box<Evaluation>>,
    reports: Vec<CycleReport>,
    ending: Option<Ending>,
}

#[derive(Debug)]
enum Phase {
    Resting { since_s: f64 },
    Waiting { play: Play, since_s: f64 },
    Playing { play: Play, began_s: f64 },
    Stopping,
    Ended,
}

#[derive(Debug, Clone)]
struct Play {
    member: Member,
    course: Course,
    /// A wall is nearer than the motion of this cycle.
    near_wall: bool,
}

impl Controller {
    /// A controller of a robot that rests since `now_s` with straight joints.
    pub fn new(planner: Planner, goal: Goal, options: Options, now_s: f64) -> Self {
        let (tank, margin_m) = planner.tank();
        let walls = tank.map(|tank| TankWalls { tank, margin_m });
        let monitor = Monitor::new(*planner.model(), walls);
        Self {
            planner,
            goal,
            options,
            monitor,
            learning: Learning::default(),
            phase: Phase::Resting { since_s: now_s },
            poses: Vec::new(),
            last_seen_s: None,
            rest: None,
            played: None,
            rest_shape: Vector2::zeros(),
            chain: Vec::new(),
            pause_s: options.pause_s,
            target: 0,
            cycles: 0,
            forward_cycles: 0,
            worst_heading_rad: 0.0,
            outside: 0,
            operator_stop: false,
            unexplained: false,
            evaluation: None,
            reports: Vec::new(),
            ending: None,
        }
    }

    /// Takes an event of robot and cameras.
    pub fn event(&mut self, event: &Event) {
        match event {
            Event::Pose(pose) => self.pose(pose),
            Event::Began(began_s) => self.play_began(*began_s),
            Event::AtRest(now_s) => self.at_rest(*now_s),
            Event::Evaluated(evaluated) => self.evaluated(evaluated),
            Event::Interrupted(Interruption::Operator) => self.operator_stop(),
            Event::Interrupted(Interruption::Robot(reason)) => self.robot_stopped(reason),
            Event::Interrupted(Interruption::Link(reason)) => {
                self.robot_stopped(&format!("the link was lost: {reason}"));
            }
        }
    }

    /// Takes a tracked pose.
    pub fn pose(&mut self, pose: &Pose) {
        if !pose.is_valid() {
            return;
        }
        self.last_seen_s = Some(
            self.last_seen_s
                .map_or(pose.time_s, |last| last.max(pose.time_s)),
        );
        match &self.phase {
            Phase::Resting { since_s } => {
                if pose.time_s >= since_s + SETTLING_S {
                    self.poses.push(*pose);
                }
            }
            Phase::Playing { play, began_s } => {
                self.monitor.pose(pose);
                let (tank, margin) = self.planner.tank();
                let time = pose.time_s - began_s;
                let model = self.planner.model();
                let nearest = tank.map_or(f64::INFINITY, |tank| {
                    play.course
                        .distance_to_wall(model, &tank, &pose.placed(), time)
                });
                self.outside = if nearest < margin {
                    self.outside + 1
                } else {
                    0
                };
            }
            Phase::Waiting { .. } | Phase::Stopping | Phase::Ended => {}
        }
    }

    /// The requested play began: its first set-point was at `began_s`.
    pub fn play_began(&mut self, began_s: f64) {
        if let Phase::Waiting { play, since_s } = &self.phase {
            self.pause_s = 0.5 * (self.pause_s + (began_s - since_s).max(0.0));
            self.monitor.begin(play.course.clone(), began_s);
            self.outside = 0;
            self.phase = Phase::Playing {
                play: play.clone(),
                began_s,
            };
        }
    }

    /// The robot came to rest with straight joints, after its cycle or after a stop.
    pub fn at_rest(&mut self, now_s: f64) {
        match std::mem::replace(&mut self.phase, Phase::Ended) {
            Phase::Playing { play, .. } => {
                self.cycles += 1;
                if play.member.kind == forecast::Kind::Forward {
                    self.forward_cycles += 1;
                }
                self.evaluation = self.monitor.finish().map(Box::new);
                self.poses.clear();
                self.played = Some(play.member);
                self.rest_shape = play.course.last_shape();
                self.phase = Phase::Resting { since_s: now_s };
            }
            Phase::Stopping => {
                self.monitor.interrupt();
                self.played = None;
                self.chain.clear();
                self.poses.clear();
                self.phase = Phase::Resting { since_s: now_s };
            }
            phase => self.phase = phase,
        }
        if self.ending.is_some() {
            self.phase = Phase::Ended;
        }
    }

    /// The evaluation of the last cycle is done. Results for other cycles are ignored.
    pub fn evaluated(&mut self, evaluated: &Evaluated) {
        let Some(report) = self.monitor.confirm(evaluated.clone()) else {
            return;
        };
        let departure = report.departure.clone();
        self.reports.push(report);
        self.end_at_departure(departure.map(|departure| departure.likeness));
        if self.ending.is_some() && matches!(self.phase, Phase::Resting { .. }) {
            self.phase = Phase::Ended;
        }
    }

    /// Ends the run if the robot cannot do what is requested. Gains and drift are learned instead. A departure that nothing explains
    /// may be the tracking's: it ends the run if the next cycle shows it too.
    fn end_at_departure(&mut self, likeness: Option<Likeness>) {
        let unexplained = matches!(likeness, Some(Likeness::WrongGait(None)));
        let repeated = std::mem::replace(&mut self.unexplained, unexplained);
        match likeness {
            None => {}
            Some(Likeness::WrongGait(None)) if !repeated => {}
            Some(likeness) if likeness.is_correctable() => {}
            Some(likeness) => self.end(Ending::Departed(likeness)),
        }
    }

    /// The operator stops. It wins over everything else.
    pub fn operator_stop(&mut self) {
        self.operator_stop = true;
        self.ending = Some(Ending::StoppedByOperator);
    }

    /// The robot refused, stopped by itself or was lost.
    pub fn robot_stopped(&mut self, reason: &str) {
        self.end(Ending::RobotStopped(reason.to_owned()));
        self.phase = Phase::Ended;
    }

    fn end(&mut self, ending: Ending) {
        self.ending.get_or_insert(ending);
    }

    /// The next request at a time, if there is one. Call it after every event, and at least every 20 ms.
    pub fn poll(&mut self, now_s: f64) -> Option<Request> {
        if self.operator_stop {
            self.operator_stop = false;
            let moving = matches!(self.phase, Phase::Waiting { .. } | Phase::Playing { .. });
            self.phase = if moving {
                Phase::Stopping
            } else {
                Phase::Ended
            };
            return Some(Request::Stop);
        }
        match &self.phase {
            Phase::Playing { play, .. } => {
                let lost = self.age_s(now_s) > self.options.longest_age_s;
                if self.outside >= POSES_OUTSIDE {
                    self.end(Ending::OutsideMargin);
                } else if !(lost && play.near_wall) {
                    return None;
                }
                self.phase = Phase::Stopping;
                Some(Request::Stop)
            }
            Phase::Resting { since_s } => {
                let since_s = *since_s;
                match self.evaluation.take() {
                    Some(evaluation) => Some(Request::Evaluate(evaluation)),
                    None if !self.monitor.is_confirmed() => None,
                    None => self.decide(since_s, now_s),
                }
            }
            Phase::Waiting { .. } | Phase::Stopping | Phase::Ended => None,
        }
    }

    fn age_s(&self, now_s: f64) -> f64 {
        self.last_seen_s.map_or(f64::INFINITY, |last| now_s - last)
    }

    /// Pose of a robot at rest, moved on to `now_s` by the drift. `None` until it is known well enough.
    fn rest_pose(&self, since_s: f64, now_s: f64) -> Option<Pose> {
        if self.age_s(now_s) > self.options.longest_age_s {
            return None;
        }
        let recent: Vec<Pose> = self
            .poses
            .iter()
            .filter(|pose| now_s - pose.time_s < AVERAGED_S)
            .copied()
            .collect();
        let mean = mean(&recent)?;
        let good = mean.sigma_position_m < SHARE_OF_TOLERANCE * self.options.within_m
            && mean.sigma_heading_rad < SHARE_OF_TOLERANCE * self.options.within_rad;
        (good || now_s - since_s > LONGEST_AVERAGE_S).then_some(mean)
    }

    fn decide(&mut self, since_s: f64, now_s: f64) -> Option<Request> {
        let Some(rest) = self.rest_pose(since_s, now_s) else {
            let waited = now_s - self.last_seen_s.map_or(since_s, |last| last.max(since_s));
            if waited > self.options.longest_wait_s {
                self.end(Ending::TrackingLost { seconds: waited });
                self.phase = Phase::Ended;
            }
            return None;
        };
        self.learn(&rest);
        self.rest = Some(rest);
        let drifted = self.learning.drift() * (now_s - rest.time_s);
        let here =
            swimmer_model::Pose::new(rest.x_m + drifted.x, rest.y_m + drifted.y, rest.heading_rad);
        if !self.planner.fits(&here, 0.0) {
            self.end(Ending::OutsideMargin);
            self.phase = Phase::Ended;
            return None;
        }
        match self.choose(&here) {
            Ok(member) => self.play(&here, member, since_s),
            Err(ending) => {
                self.end(ending);
                self.phase = Phase::Ended;
                None
            }
        }
    }

    /// Learns from the cycle between the rest before and this one.
    fn learn(&mut self, rest: &Pose) {
        let (Some(before), Some(member)) = (self.rest, self.played.take()) else {
            return;
        };
        let cycle = TrackedCycle {
            kind: member.kind as usize,
            before: before.placed(),
            after: rest.placed(),
            seconds: rest.time_s - before.time_s,
            sigmas: [
                before.sigma_position_m.hypot(rest.sigma_position_m),
                before.sigma_heading_rad.hypot(rest.sigma_heading_rad),
            ],
        };
        let planner = &self.planner;
        self.learning
            .learn(&cycle, |gain| planner.net_at_gain(&member, gain));
        self.planner.set_gains(self.learning.gains());
    }

    fn play(
        &mut self,
        here: &swimmer_model::Pose<f64>,
        member: Member,
        since_s: f64,
    ) -> Option<Request> {
        let step = self.planner.step(member, 1);
        let table = match self.planner.checked_table(&step) {
            Ok(table) => table,
            Err(error) => {
                self.end(Ending::Refused(error.to_string()));
                self.phase = Phase::Ended;
                return None;
            }
        };
        let (model, servos) = (self.planner.model(), self.planner.servos());
        let course = Course::of_play(model, &table, servos, self.rest_shape);
        let motion = self.planner.net(&member).position().norm();
        let near_wall = !self
            .planner
            .stays_clear(here, &member, self.options.spare_m + motion);
        self.phase = Phase::Waiting {
            play: Play {
                member,
                course,
                near_wall,
            },
            since_s,
        };
        Some(Request::Play(step))
    }

    /// Reason for the end; `None` while the run goes on. The robot may still be coming to rest: see [`Self::is_over`].
    pub fn ending(&self) -> Option<&Ending> {
        self.ending.as_ref()
    }

    /// Returns `true` if the run has ended and the robot is at rest, or was lost.
    pub fn is_over(&self) -> bool {
        self.ending.is_some() && matches!(self.phase, Phase::Ended)
    }

    /// Distance to the present target \[m\] and angle to its heading \[rad\] at the last rest; `None` before the first rest and
    /// without a target.
    pub fn off(&self) -> Option<[f64; 2]> {
        let rest = self.rest?;
        let target = self.present_target()?;
        let heading = target.heading_rad.unwrap_or(rest.heading_rad);
        Some([
            (rest.x_m - target.x_m).hypot(rest.y_m - target.y_m),
            wrapped_angle(rest.heading_rad - heading).abs(),
        ])
    }

    fn present_target(&self) -> Option<Target> {
        match &self.goal {
            Goal::Reach(targets) => {
                let last = targets.len().checked_sub(1)?;
                targets.get(self.target.min(last)).copied()
            }
            Goal::Hold { .. } => None,
        }
    }

    /// Cycles played.
    pub fn cycles(&self) -> u32 {
        self.cycles
    }

    /// Mean pose at the last rest.
    pub fn last_rest(&self) -> Option<&Pose> {
        self.rest.as_ref()
    }

    /// Reports of the cycles so far.
    pub fn reports(&self) -> &[CycleReport] {
        &self.reports
    }

    /// Learned gains of the gaits forward, left and turn, and the learned drift \[m/s\].
    pub fn learned(&self) -> ([f64; 3], Vector2<f64>) {
        (self.learning.gains(), self.learning.drift())
    }
}
