//! Play of one gait under the monitor, cycle after cycle.

use std::collections::VecDeque;

use forecast::{Servos, Tank};
use gait_player::{GaitTable, TICK_US};
use nalgebra::Vector2;
use swimmer_model::Model;

use crate::course::distance_to_wall;
use crate::monitor::{Departure, MeasuredMotion};
use crate::{Course, CycleReport, Evaluated, Evaluation, Monitor, Pose};

/// Poses in a row that must lie outside the margin: one may be wrong.
const POSES_OUTSIDE: u32 = 3;
/// A cycle is evaluated when the poses are past its end by this much \[s\]: some arrive out of order.
const LATE_POSES_S: f64 = 0.05;

/// Cycles of a play that are predicted one by one; later ones count as the second.
const MOST_COURSES: u32 = 64;

/// Gait as the robot plays it.
#[derive(Debug, Clone)]
pub struct GaitOnRobot {
    /// Predicted course of one cycle in steady state.
    pub course: Course,
    /// Duration of a cycle \[s\].
    pub period_s: f64,
    /// Predicted courses of the first cycles, until they repeat.
    courses: Vec<Course>,
}

impl GaitOnRobot {
    /// A gait whose cycles are all alike.
    pub fn steady(course: Course, period_s: f64) -> Self {
        Self {
            course,
            period_s,
            courses: Vec::new(),
        }
    }

    /// A table that is played for some cycles. At a period that is no whole number of the robot's ticks each cycle begins at another
    /// share of a tick, with other joint angles: at the servos' full rate this changes the net motion of a cycle by up to a percent.
    pub fn new(
        model: &Model<f64>,
        table: &GaitTable,
        period_us: u32,
        servos: &Servos,
        cycles: u32,
    ) -> Self {
        // Cycle n begins at the same share of a tick as cycle n + `different`.
        let different = TICK_US / common_divisor(period_us, TICK_US);
        let first = cycles.min(different + 1).min(MOST_COURSES);
        Self {
            courses: Course::of_first_cycles(model, table, period_us, servos, first),
            course: Course::of_cycle(model, table, period_us, servos),
            period_s: f64::from(period_us) * 1e-6,
        }
    }

    /// Predicted course of a cycle, from 0.
    pub fn course_of(&self, cycle: u32) -> &Course {
        let repeating = u32::try_from(self.courses.len().saturating_sub(1)).unwrap_or(0);
        let like = match cycle {
            0 => 0,
            _ if repeating == 0 => return &self.course,
            _ => 1 + (cycle - 1) % repeating,
        };
        self.courses.get(like as usize).unwrap_or(&self.course)
    }

    /// Mean net motion of some cycles, each in the frame of the middle link at its start.
    pub fn mean_motion(&self, cycles: std::ops::Range<u32>) -> swimmer_model::Pose<f64> {
        let count = f64::from(cycles.end.saturating_sub(cycles.start).max(1));
        let nets = cycles.map(|cycle| self.course_of(cycle).net());
        let [x, y, turn] = nets.fold([0.0; 3], |[x, y, turn], net| {
            [x + net.x, y + net.y, turn + net.theta]
        });
        swimmer_model::Pose::new(x / count, y / count, turn / count)
    }
}

/// Greatest common divisor; `two` is not 0.
fn common_divisor(one: u32, two: u32) -> u32 {
    let (mut one, mut two) = (one, two);
    while one != 0 {
        (one, two) = (two % one, one);
    }
    two
}

/// Tank and the distance that is kept from its walls \[m\].
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct TankWalls {
    /// The tank.
    pub tank: Tank,
    /// Distance \[m\].
    pub margin_m: f64,
}

impl TankWalls {
    /// Returns `true` if a part of a swimmer with these joint angles is nearer to a wall than the margin.
    pub fn are_near(&self, model: &Model<f64>, pose: &Pose, shape: &Vector2<f64>) -> bool {
        distance_to_wall(model, &self.tank, &pose.placed(), shape) < self.margin_m
    }
}

/// Poses near the walls, counted in a row.
#[derive(Debug, Clone, Default)]
pub struct NearWalls(u32);

impl NearWalls {
    /// Takes a pose.
    pub fn pose(&mut self, is_near: bool) {
        self.0 = if is_near { self.0 + 1 } else { 0 };
    }

    /// Returns `true` after so many poses in a row that they are not an error of the cameras.
    pub fn are_confirmed(&self) -> bool {
        self.0 >= POSES_OUTSIDE
    }
}

/// Play under way.
#[derive(Debug)]
pub struct TrackedPlay {
    model: Model<f64>,
    walls: Option<TankWalls>,
    monitor: Monitor,
    gait: GaitOnRobot,
    began_s: f64,
    cycles: u32,
    outside: NearWalls,
    last_seen_s: Option<f64>,
    /// Cycles that have ended.
    ended: u32,
    evaluations: VecDeque<Evaluation>,
    reports: Vec<CycleReport>,
}

impl TrackedPlay {
    /// Begins to track a play, whose first cycle began at `began_s`. `others` are gaits that the robot may play by mistake.
    pub fn new<'a>(
        model: &Model<f64>,
        walls: Option<TankWalls>,
        gait: GaitOnRobot,
        others: impl Iterator<Item = (&'a str, &'a Course)>,
        began_s: f64,
        cycles: u32,
    ) -> Self {
        let mut monitor = Monitor::new(*model, walls);
        for (name, other) in others {
            monitor.know(name, other.clone());
        }
        monitor.begin(gait.course_of(0).clone(), began_s);
        Self {
            model: *model,
            walls,
            monitor,
            gait,
            began_s,
            cycles,
            outside: NearWalls::default(),
            last_seen_s: None,
            ended: 0,
            evaluations: VecDeque::new(),
            reports: Vec::new(),
        }
    }

    /// Takes a pose.
    pub fn pose(&mut self, pose: &Pose) {
        while self.ended < self.cycles
            && pose.time_s > self.cycle_began_s() + self.gait.period_s + LATE_POSES_S
        {
            self.next_cycle();
        }
        self.monitor.pose(pose);
        let last_s = self.last_seen_s.unwrap_or(f64::NEG_INFINITY);
        self.last_seen_s = Some(pose.time_s.max(last_s));
        let time = (pose.time_s - self.began_s).rem_euclid(self.gait.period_s);
        let shape = self.gait.course.shape_at(time);
        let is_outside = pose.time_s > self.began_s
            && self
                .walls
                .is_some_and(|walls| walls.are_near(&self.model, pose, &shape));
        self.outside.pose(is_outside);
    }

    /// The robot came to rest: the cycles that are left have ended.
    pub fn at_rest(&mut self) {
        while self.ended < self.cycles {
            let before = self.ended;
            self.next_cycle();
            if self.ended == before {
                break;
            }
        }
    }

    /// The next cycle to evaluate, if there is one. Its result is passed to [`Self::evaluated`].
    pub fn take_evaluation(&mut self) -> Option<Evaluation> {
        self.evaluations.pop_front()
    }

    /// Takes the result of an evaluation, in the order of the cycles. Results for other plays are ignored.
    pub fn evaluated(&mut self, evaluated: Evaluated) {
        self.reports.extend(self.monitor.confirm(evaluated));
    }

    /// Returns `true` if no evaluation is outstanding.
    pub fn is_evaluated(&self) -> bool {
        self.monitor.is_confirmed()
    }

    /// Returns `true` if the robot is nearer to a wall than the margin.
    pub fn is_outside(&self) -> bool {
        self.outside.are_confirmed()
    }

    /// Returns `true` if all cycles are evaluated.
    pub fn is_whole(&self) -> bool {
        self.ended >= self.cycles && self.is_evaluated()
    }

    /// Time of the latest pose \[s\].
    pub fn last_seen_s(&self) -> Option<f64> {
        self.last_seen_s
    }

    /// Start of the first cycle \[s\].
    pub fn began_s(&self) -> f64 {
        self.began_s
    }

    /// Reports of the cycles that are evaluated.
    pub fn reports(&self) -> &[CycleReport] {
        &self.reports
    }

    /// Departure that the latest report confirms.
    pub fn departure(&self) -> Option<&Departure> {
        self.reports.last()?.departure.as_ref()
    }

    /// Predicted motion over the cycles that are evaluated.
    pub fn predicted(&self) -> swimmer_model::Pose<f64> {
        let identity = swimmer_model::Pose::identity();
        let nets = self.reports.iter().map(|report| report.predicted);
        nets.fold(identity, |before, net| before * net)
    }

    /// Measured motion over the cycles that are evaluated. Returns `None` if the start of the first or the end of the last was not
    /// seen.
    pub fn measured(&self) -> Option<MeasuredMotion> {
        let first = self.reports.first()?.measured?;
        let last = self.reports.last()?.measured?;
        Some(MeasuredMotion::spanning(&first, &last))
    }

    fn cycle_began_s(&self) -> f64 {
        self.began_s + f64::from(self.ended) * self.gait.period_s
    }

    /// Ends the cycle under way, and begins the next one.
    fn next_cycle(&mut self) {
        if let Some(evaluation) = self.monitor.finish() {
            self.evaluations.push_back(evaluation);
            self.ended += 1;
        }
        if self.ended < self.cycles {
            let began = self.cycle_began_s();
            let course = self.gait.course_of(self.ended).clone();
            self.monitor.begin(course, began);
        }
    }
}
