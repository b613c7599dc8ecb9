//! Monitor of a play: each tracked cycle against the prediction for the gait that plays.

use std::fmt;

use forecast::Tank;
use nalgebra::Vector2;
use swimmer_model::Model;

use crate::fit::{Basis, Fit, fit, fit_without_outliers, model_errors};
use crate::{Course, Pose};

/// A misfit above this is no noise: the course is another one.
const LARGEST_MISFIT: f64 = 3.0;
/// A misfit of the cycle without outliers above this is no noise.
const LARGEST_MISFIT_OF_MOST: f64 = 2.0;
/// Another course explains a misfit if it leaves less than this share.
const EXPLAINED: f64 = 0.5;
/// Gains and drifts \[m/s\] that count as departures if they are also significant.
const LARGEST_GAIN_ERROR: f64 = 0.025;
const LARGEST_DRIFT: f64 = 0.12e-3;
/// Deviations from the prediction that are significant if two cycles in a row show them.
const SIGNIFICANT: f64 = 2.4;
/// Error of a fitted gain by the model, and error of the net displacement by the model as its share.
const GAIN_BY_MODEL: f64 = 0.005;
const NET_BY_MODEL: f64 = 0.01;
/// A wall so near \[m\] explains a misfit.
const AT_WALL: f64 = 0.006;
/// Number of angles at which a joint may be blocked, between the smallest and the largest of the course.
const BLOCKED_ANGLES: u32 = 7;
/// Drifts of two cycles are alike within this share.
const ALIKE: f64 = 0.6;
/// Normal deviate of a 95 % interval.
const NORMAL_95: f64 = 1.96;
/// A cycle that oscillates less than this over the noise says nothing about departures.
const FEWEST_DEVIATIONS: f64 = 4.0;

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
}

impl fmt::Display for Likeness {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Gain(gain) => write!(
                f,
                "the joints turn {:.1} % of the commanded angles",
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
        }
    }
}

impl Likeness {
    /// Returns `true` if both are of one kind.
    fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::BlockedJoint(one), Self::BlockedJoint(two)) => one == two,
            // A steady drift: what turns about from cycle to cycle is an error of the fit.
            (Self::Drift(one), Self::Drift(two)) => {
                let [one, two] = [one, two].map(|drift| Vector2::from(*drift));
                (one - two).norm() < ALIKE * one.norm().max(two.norm())
            }
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
    tank: Option<Tank>,
    others: Vec<(String, Course)>,
    cycle: Option<Cycle>,
    number: u32,
    /// Suspected fault of the previous cycle, and the cycle in which it began.
    suspicion: Option<Departure>,
}

#[derive(Debug)]
struct Cycle {
    basis: Basis,
    began_s: f64,
    poses: Vec<Pose>,
}

impl Monitor {
    /// A monitor for a swimmer, with the walls of its tank if they are known.
    pub fn new(model: Model<f64>, tank: Option<Tank>) -> Self {
        Self {
            model,
            tank,
            others: Vec::new(),
            cycle: None,
            number: 0,
            suspicion: None,
        }
    }

    /// Names a gait that the robot may play by mistake.
    pub fn know(&mut self, name: &str, course: Course) {
        self.others.push((name.to_owned(), course));
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

    /// The cycle has ended. Returns `None` if none was under way.
    pub fn end(&mut self) -> Option<CycleReport> {
        let mut cycle = self.cycle.take()?;
        cycle.poses.sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        let errors = model_errors(&cycle.basis.course);
        let mut fitted = fit(&cycle.basis, &cycle.poses, cycle.began_s, errors);
        if fitted
            .as_ref()
            .is_some_and(|fit| fit.misfit > LARGEST_MISFIT)
        {
            // A burst of outliers is no departure: most poses are as predicted.
            let most = fit_without_outliers(&cycle.basis, &cycle.poses, cycle.began_s, errors);
            fitted = most
                .filter(|fit| fit.misfit <= LARGEST_MISFIT_OF_MOST)
                .or(fitted);
        }
        let number = self.number;
        self.number += 1;
        let says_something = cycle.says_something();
        let looks_like = fitted
            .as_ref()
            .filter(|_| says_something)
            .and_then(|fit| self.likeness(&cycle, fit));
        let departure = self.confirmed(looks_like.clone(), fitted.is_some() && says_something);
        Some(CycleReport {
            cycle: number,
            predicted: cycle.basis.course.net(),
            measured: fitted.as_ref().and_then(measured),
            gain: fitted.as_ref().map(|fit| [fit.gain, fit.sigma_gain]),
            drift: fitted
                .as_ref()
                .map(|fit| [fit.drift.x, fit.drift.y, fit.sigma_drift]),
            poses: cycle.poses.len(),
            looks_like,
            departure,
        })
    }

    /// A departure is one that two cycles in a row show. Cycles that say nothing do not count.
    fn confirmed(&mut self, looks_like: Option<Likeness>, counts: bool) -> Option<Departure> {
        if !counts {
            return None;
        }
        let number = self.number.saturating_sub(1);
        let before = self.suspicion.take();
        let likeness = looks_like?;
        let same = before.filter(|before| before.likeness.is_like(&likeness));
        let departure = Departure {
            since: same.as_ref().map_or(number, |before| before.since),
            likeness,
        };
        self.suspicion = Some(departure.clone());
        same.is_some().then_some(departure)
    }

    fn likeness(&self, cycle: &Cycle, nominal: &Fit) -> Option<Likeness> {
        if nominal.misfit > LARGEST_MISFIT {
            return Some(self.other_course(cycle, nominal));
        }
        let course = &cycle.basis.course;
        let sigma = nominal.sigma_gain.hypot(GAIN_BY_MODEL);
        let off = (nominal.gain - 1.0).abs();
        if off > LARGEST_GAIN_ERROR && off > SIGNIFICANT * sigma {
            return Some(Likeness::Gain(nominal.gain));
        }
        let by_model = NET_BY_MODEL * course.net().position().norm() / course.duration_s();
        let sigma = nominal.sigma_drift.hypot(by_model);
        let drift = nominal.drift.norm();
        (drift > LARGEST_DRIFT && drift > SIGNIFICANT * sigma)
            .then(|| Likeness::Drift(nominal.drift.into()))
    }

    /// The course that explains the poses better than the predicted one.
    fn other_course(&self, cycle: &Cycle, nominal: &Fit) -> Likeness {
        let course = &cycle.basis.course;
        let errors = model_errors(course);
        let misfit = |other: Course| {
            let basis = Basis::new(&self.model, other);
            fit(&basis, &cycle.poses, cycle.began_s, errors).map_or(f64::INFINITY, |fit| fit.misfit)
        };
        let blocked = [0, 1].into_iter().flat_map(|joint| {
            let angles = blocked_angles(course, joint);
            angles.map(move |angle| (joint, angle))
        });
        let blocked = blocked.map(|(joint, angle)| {
            let hold = |mut shape: Vector2<f64>| {
                shape[joint] = angle;
                shape
            };
            let held = misfit(course.with_shapes(&self.model, hold));
            let number = if joint == 0 { 1 } else { 2 };
            (held, Likeness::BlockedJoint(number))
        });
        let others = self.others.iter().map(|(name, other)| {
            let other = other.within(course.duration_s());
            (misfit(other), Likeness::WrongGait(Some(name.clone())))
        });
        let best = blocked.chain(others).min_by(|a, b| a.0.total_cmp(&b.0));
        if let Some((misfit, likeness)) = best
            && misfit < EXPLAINED * nominal.misfit
        {
            return likeness;
        }
        if cycle.is_at_wall(&self.model, self.tank.as_ref()) {
            return Likeness::Wall;
        }
        Likeness::WrongGait(None)
    }
}

fn measured(fit: &Fit) -> Option<MeasuredMotion> {
    let ([start, end], [sigma, turn_sigma]) = fit.ends?;
    let net = start.inverse() * end;
    Some(MeasuredMotion {
        x_m: net.x,
        y_m: net.y,
        turn_rad: net.theta,
        interval_m: NORMAL_95 * sigma,
        interval_rad: NORMAL_95 * turn_sigma,
        from: start,
        to: end,
    })
}

/// Angles of one joint between the smallest and the largest of a course \[rad\].
fn blocked_angles(course: &Course, joint: usize) -> impl Iterator<Item = f64> + use<> {
    let angle = |i: u32| course.shape_at(course.duration_s() * f64::from(i) / 100.0)[joint];
    let (low, high) = (0..=100)
        .map(angle)
        .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), angle| {
            (low.min(angle), high.max(angle))
        });
    (0..BLOCKED_ANGLES)
        .map(move |i| low + (high - low) * f64::from(i) / f64::from(BLOCKED_ANGLES - 1))
}

impl Cycle {
    /// Returns `true` if the oscillation is well above the noise.
    fn says_something(&self) -> bool {
        let [position, heading] = self.basis.course.oscillation();
        self.poses.first().is_some_and(|pose| {
            position > FEWEST_DEVIATIONS * pose.sigma_position_m
                && heading > FEWEST_DEVIATIONS * pose.sigma_heading_rad
        })
    }

    fn is_at_wall(&self, model: &Model<f64>, tank: Option<&Tank>) -> bool {
        let Some(tank) = tank else { return false };
        self.poses.iter().any(|pose| {
            let time = pose.time_s - self.began_s;
            let course = &self.basis.course;
            course.distance_to_wall(model, tank, &pose.placed(), time) < AT_WALL
        })
    }
}
