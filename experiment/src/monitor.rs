//! Monitor of a play: each tracked cycle against the prediction for the gait that plays.
//!
//! The evaluation of a cycle may take seconds, longer than a robot waits for a keep-alive. So it is separate from the monitor
//! ([`Evaluation`]): the thread that holds the link passes it to another thread, and takes its result when it is there.

mod evaluation;

use std::collections::VecDeque;
use std::fmt;
use std::sync::Arc;

use nalgebra::Vector2;
use swimmer_model::Model;

use self::evaluation::Cycle;
use crate::fit::Basis;
use crate::{Course, Pose, TankWalls};

pub use evaluation::{Evaluated, Evaluation};

/// Drifts of two cycles are alike within this share.
const ALIKE: f64 = 0.6;
/// Measured net motion of a cycle in the frame of its first heading, with half widths of 95 % intervals.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredMotion {
    /// X \[m\].
    pub x_m: f64,
    /// Y \[m\].
    pub y_m: f64,
    /// Net turn \[rad\].
    pub turn_rad: f64,
    /// Half width of the intervals of X and Y \[m\].
    pub interval_m: f64,
    /// Half width of the interval of the turn \[rad\].
    pub interval_rad: f64,
    /// Pose at the start, in the tank.
    pub from: swimmer_model::Pose<f64>,
    /// Pose at the end.
    pub to: swimmer_model::Pose<f64>,
}

impl MeasuredMotion {
    /// Motion from the start of one cycle to the end of a later one, or of the same.
    pub fn spanning(first: &Self, last: &Self) -> Self {
        let net = first.from.inverse() * last.to;
        let lever = |motion: &Self| (motion.to.position() - motion.from.position()).norm_squared();
        let noise =
            |motion: &Self| motion.interval_m.powi(2) - lever(motion) * motion.interval_rad.powi(2);
        let mean = |of: &dyn Fn(&Self) -> f64| f64::midpoint(of(first), of(last));
        let turn_noise = mean(&|motion| motion.interval_rad.powi(2));
        let spanned = (last.to.position() - first.from.position()).norm_squared();
        Self {
            x_m: net.x,
            y_m: net.y,
            turn_rad: net.theta,
            interval_m: (mean(&noise).max(0.0) + spanned * turn_noise).sqrt(),
            interval_rad: turn_noise.sqrt(),
            from: first.from,
            to: last.to,
        }
    }
}

/// Likely cause of a departure.
#[derive(Debug, Clone, PartialEq)]
pub enum Likeness {
    /// The joints turn this much of what is commanded.
    Gain(f64),
    /// The swimmer drifts, x and y \[m/s\].
    Drift([f64; 2]),
    /// A joint does not move: 1 or 2.
    BlockedJoint(u8),
    /// Another gait plays; its name if it is known.
    WrongGait(Option<String>),
    /// A wall holds the swimmer.
    Wall,
    /// The swimmer makes this share of the predicted motion, as one whose drag differs.
    Uncalibrated(f64),
}

impl fmt::Display for Likeness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gain(gain) => write!(
                f,
                "the joints turn {:.1} % of the commanded angles, or the drag differs as much: calibrate it",
                gain * 100.0
            ),
            Self::Drift([x, y]) => {
                write!(
                    f,
                    "the swimmer drifts by ({:.2}, {:.2}) mm/s",
                    x * 1e3,
                    y * 1e3
                )
            }
            Self::BlockedJoint(joint) => write!(f, "joint {joint} does not move"),
            Self::WrongGait(Some(name)) => write!(f, "the robot plays another gait: {name}"),
            Self::WrongGait(None) => f.write_str("the robot does not follow this gait"),
            Self::Wall => f.write_str("a wall holds the swimmer"),
            Self::Uncalibrated(share) => write!(
                f,
                "the swimmer makes {:.1} % of the predicted motion, as one with another drag: calibrate it",
                share * 100.0
            ),
        }
    }
}

impl Likeness {
    /// Returns `true` for what a calibration or a controller takes into account: the joints follow the commands.
    pub fn is_correctable(&self) -> bool {
        matches!(self, Self::Gain(_) | Self::Drift(_) | Self::Uncalibrated(_))
    }

    /// Returns `true` if both are of one kind.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::BlockedJoint(one), Self::BlockedJoint(two)) => one == two,
            // A steady drift: what turns about from cycle to cycle is an error of the fit.
            (Self::Drift(one), Self::Drift(two)) => {
                let [one, two] = [one, two].map(|drift| Vector2::from(*drift));
                (one - two).norm() < ALIKE * one.norm().max(two.norm())
            }
            // A robot without calibration may pass for one of another gain.
            (Self::Gain(_), Self::Uncalibrated(_)) | (Self::Uncalibrated(_), Self::Gain(_)) => true,
            _ => std::mem::discriminant(self) == std::mem::discriminant(other),
        }
    }
}

/// Departure from the prediction in two cycles in a row.
#[derive(Debug, Clone, PartialEq)]
pub struct Departure {
    /// The first cycle that departed, from 0.
    pub since: u32,
    /// Likely cause.
    pub likeness: Likeness,
}

/// One monitored cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct CycleReport {
    /// Number of the cycle, from 0.
    pub cycle: u32,
    /// Predicted net motion in the frame of the middle link at the start.
    pub predicted: swimmer_model::Pose<f64>,
    /// Measured net motion; `None` if an end of the cycle was not seen.
    pub measured: Option<MeasuredMotion>,
    /// Measured joint angles over the commanded ones, with the standard deviation; `None` with too few poses.
    pub gain: Option<[f64; 2]>,
    /// Drift x and y with the standard deviation of each \[m/s\]; `None` with too few poses.
    pub drift: Option<[f64; 3]>,
    /// Poses of the cycle.
    pub poses: usize,
    /// Most likely fault by this cycle alone; `None` if it is as predicted.
    pub looks_like: Option<Likeness>,
    /// Departure that this cycle confirms.
    pub departure: Option<Departure>,
}

/// Watches cycle after cycle.
#[derive(Debug)]
pub struct Monitor {
    model: Model<f64>,
    walls: Option<TankWalls>,
    others: Arc<Vec<(String, Course)>>,
    cycle: Option<Cycle>,
    number: u32,
    /// Starts of the cycles that have ended and are not confirmed \[s\].
    unconfirmed: VecDeque<f64>,
    /// Suspected fault of the previous cycle, and the cycle in which it began.
    suspicion: Option<Departure>,
}

impl Monitor {
    /// A monitor for a swimmer, with the walls of its tank and the margin at which it is stopped if they are known.
    pub fn new(model: Model<f64>, walls: Option<TankWalls>) -> Self {
        Self {
            model,
            walls,
            others: Arc::default(),
            cycle: None,
            number: 0,
            unconfirmed: VecDeque::new(),
            suspicion: None,
        }
    }

    /// Names a gait that the robot may play by mistake.
    pub fn know(&mut self, name: &str, course: Course) {
        Arc::make_mut(&mut self.others).push((name.to_owned(), course));
    }

    /// A cycle begins. One that has not ended is dropped.
    pub fn begin(&mut self, course: Course, began_s: f64) {
        self.cycle = Some(Cycle {
            basis: Basis::new(&self.model, course),
            began_s,
            poses: Vec::new(),
        });
    }

    /// Takes a pose; those outside the cycle are ignored.
    pub fn pose(&mut self, pose: &Pose) {
        if let Some(cycle) = &mut self.cycle {
            let time = pose.time_s - cycle.began_s;
            if pose.is_valid() && (0.0..=cycle.basis.course.duration_s()).contains(&time) {
                cycle.poses.push(*pose);
            }
        }
    }

    /// Drops the cycle: it was interrupted.
    pub fn interrupt(&mut self) {
        self.cycle = None;
    }

    /// The cycle has ended. Returns its evaluation, whose result [`Self::confirm`] takes; `None` if no cycle was under way.
    pub fn finish(&mut self) -> Option<Evaluation> {
        let cycle = self.cycle.take()?;
        self.unconfirmed.push_back(cycle.began_s);
        let number = self.number;
        self.number += 1;
        Some(Evaluation {
            model: self.model,
            walls: self.walls,
            others: Arc::clone(&self.others),
            cycle,
            number,
        })
    }

    /// Takes the result of an evaluation, in the order in which the cycles ended. A departure is one that two cycles in a row show;
    /// cycles that say nothing do not count. Returns `None` if the cycle is not one of this monitor.
    pub fn confirm(&mut self, evaluated: Evaluated) -> Option<CycleReport> {
        self.unconfirmed
            .pop_front_if(|began_s| began_s.total_cmp(&evaluated.began_s).is_eq())?;
        let mut report = evaluated.report;
        if evaluated.is_informative {
            report.departure = self.departure(&report);
        }
        Some(report)
    }

    /// Returns `true` if the reports of all cycles that have ended are known.
    pub fn is_confirmed(&self) -> bool {
        self.unconfirmed.is_empty()
    }

    /// The cycle has ended, and is evaluated at once. Returns `None` if no cycle was under way.
    pub fn end(&mut self) -> Option<CycleReport> {
        let evaluation = self.finish()?;
        self.confirm(evaluation.run())
    }

    /// Departure that this cycle and the one before show.
    fn departure(&mut self, report: &CycleReport) -> Option<Departure> {
        let before = self.suspicion.take();
        let likeness = report.looks_like.clone()?;
        let same = before.filter(|before| before.likeness.is_like(&likeness));
        let departure = Departure {
            since: same.as_ref().map_or(report.cycle, |before| before.since),
            likeness,
        };
        self.suspicion = Some(departure.clone());
        same.is_some().then_some(departure)
    }
}
