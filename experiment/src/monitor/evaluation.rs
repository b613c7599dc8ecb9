//! Evaluation of a cycle that has ended: fit by the predicted course, and the likely cause of a misfit.

use std::sync::Arc;

use nalgebra::Vector2;
use swimmer_model::Model;

use super::{CycleReport, Likeness, MeasuredMotion};
use crate::fit::{Basis, Fit, fit, fit_without_outliers, model_errors};
use crate::{Course, Pose, TankWalls};

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
/// A wall that is nearer than this many margins explains a misfit: its drag acts before the robot is stopped at the margin.
const MARGINS: f64 = 2.0;
/// Smallest margin that counts for that \[m\].
const LEAST_MARGIN_M: f64 = 0.003;
/// Another drag explains a misfit if it leaves no more than this.
const LARGEST_MISFIT_OF_DRAG: f64 = 2.0;
/// Number of angles at which a joint may be blocked, between the smallest and the largest of the course.
const BLOCKED_ANGLES: u32 = 7;
/// Normal deviate of a 95 % interval.
const NORMAL_95: f64 = 1.96;
/// A cycle that oscillates less than this over the noise says nothing about departures.
const FEWEST_DEVIATIONS: f64 = 4.0;

/// Cycle that has ended, with all that its evaluation needs.
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluation {
    pub(super) model: Model<f64>,
    pub(super) walls: Option<TankWalls>,
    /// Gaits that the robot may play by mistake.
    pub(super) others: Arc<Vec<(String, Course)>>,
    pub(super) cycle: Cycle,
    pub(super) number: u32,
}

/// Result of an [`Evaluation`], for [`Monitor::confirm`](super::Monitor::confirm).
#[derive(Debug, Clone, PartialEq)]
pub struct Evaluated {
    /// Start of the cycle \[s\].
    pub(super) began_s: f64,
    /// Report of this cycle alone.
    pub(super) report: CycleReport,
    /// The cycle shows a departure if there is one.
    pub(super) is_informative: bool,
}

/// Cycle with its poses.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Cycle {
    pub(super) basis: Basis,
    pub(super) began_s: f64,
    pub(super) poses: Vec<Pose>,
}

impl Evaluation {
    /// Fits the cycle and names the likely cause of a misfit. It may take seconds.
    pub fn run(mut self) -> Evaluated {
        self.cycle
            .poses
            .sort_by(|a, b| a.time_s.total_cmp(&b.time_s));
        let fitted = self.fitted();
        let is_informative = fitted.is_some() && self.cycle.says_something();
        let looks_like = fitted
            .as_ref()
            .filter(|_| is_informative)
            .and_then(|fit| self.likeness(fit));
        let cycle = &self.cycle;
        let report = CycleReport {
            cycle: self.number,
            predicted: cycle.basis.course.net(),
            measured: fitted.as_ref().and_then(measured),
            gain: fitted.as_ref().map(|fit| [fit.gain, fit.sigma_gain]),
            drift: fitted
                .as_ref()
                .map(|fit| [fit.drift.x, fit.drift.y, fit.sigma_drift]),
            poses: cycle.poses.len(),
            looks_like,
            departure: None,
        };
        Evaluated {
            began_s: cycle.began_s,
            report,
            is_informative,
        }
    }

    /// Fit of the cycle. A burst of outliers is no departure: they are left out if most poses are as predicted.
    fn fitted(&self) -> Option<Fit> {
        let cycle = &self.cycle;
        let errors = model_errors(&cycle.basis.course);
        let fitted = fit(&cycle.basis, &cycle.poses, cycle.began_s, errors)?;
        if fitted.misfit <= LARGEST_MISFIT {
            return Some(fitted);
        }
        let most = fit_without_outliers(&cycle.basis, &cycle.poses, cycle.began_s, errors);
        most.filter(|fit| fit.misfit <= LARGEST_MISFIT_OF_MOST)
            .or(Some(fitted))
    }

    fn likeness(&self, nominal: &Fit) -> Option<Likeness> {
        if nominal.misfit > LARGEST_MISFIT {
            return Some(self.other_course(nominal));
        }
        let course = &self.cycle.basis.course;
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
    fn other_course(&self, nominal: &Fit) -> Likeness {
        let cycle = &self.cycle;
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
        if cycle.is_at_wall(&self.model, self.walls.as_ref()) {
            return Likeness::Wall;
        }
        self.other_drag(errors)
            .map_or(Likeness::WrongGait(None), Likeness::Uncalibrated)
    }

    /// Share of the predicted motion that the robot makes, if another drag explains the poses.
    fn other_drag(&self, errors: [f64; 2]) -> Option<f64> {
        let cycle = &self.cycle;
        let basis = cycle.basis.with_drag(&self.model)?;
        let fitted = fit(&basis, &cycle.poses, cycle.began_s, errors)?;
        (fitted.misfit < LARGEST_MISFIT_OF_DRAG).then(|| fitted.share_of_motion(&basis, errors))
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

    fn is_at_wall(&self, model: &Model<f64>, walls: Option<&TankWalls>) -> bool {
        let Some(TankWalls { tank, margin_m }) = walls else {
            return false;
        };
        let near_m = MARGINS * margin_m.max(LEAST_MARGIN_M);
        self.poses.iter().any(|pose| {
            let time = pose.time_s - self.began_s;
            let course = &self.basis.course;
            course.distance_to_wall(model, tank, &pose.placed(), time) < near_m
        })
    }
}
