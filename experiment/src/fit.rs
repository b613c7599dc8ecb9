//! Least squares of a tracked cycle by its predicted course: start pose, gain of the joint angles, drift of the tank, and what the
//! match of the clocks left over; on request also the drag, ln χ and ln r_s.

use nalgebra::{RowSVector, SMatrix, SVector, Vector2};
use swimmer_model::{Model, wrapped_angle};

use crate::pose::FRAMES_PER_SAMPLE;
use crate::{Course, Pose};

/// Model errors that no parameter takes up, as a share of the oscillation.
pub(crate) const MODEL_ERROR: f64 = 0.02;
/// Step of the gain for differences.
const GAIN_STEP: f64 = 0.02;
/// Priors that keep a few poses from fitting anything: of the gain, of the drift \[m/s\], and of the clock match \[s\].
const PRIORS: [f64; 3] = [0.3, 3e-3, 0.01];
/// Step of the time for differences \[s\].
const TIME_STEP: f64 = 0.01;
/// Step of ln χ and ln r_s for differences, and their prior deviation: a robot that a campaign has not calibrated.
const DRAG_STEP: f64 = 0.02;
const DRAG_PRIOR: f64 = 0.06;
/// Parameters: start (x, y, heading), gain, drift (x, y), delay, ln χ, ln r_s.
const COUNT: usize = 9;
const ITERATIONS: usize = 5;
/// Share of a cycle's poses that may be outliers.
const OUTLIERS: f64 = 0.2;
/// Share of a cycle at its start and at its end that the net motion is measured over.
const END: f64 = 0.15;

/// Course with its derivative by the gain of both joints, and if requested by the drag.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Basis {
    pub(crate) course: Course,
    gain: Around,
    drag: Option<[Around; 2]>,
}

/// Courses with one parameter below and above its value.
#[derive(Debug, Clone, PartialEq)]
struct Around {
    below: Course,
    above: Course,
    /// Difference of the parameter.
    width: f64,
}

impl Around {
    /// Derivative of the course by the parameter at a time.
    fn slope(&self, time_s: f64) -> (Vector2<f64>, f64) {
        let (below, above) = (self.below.at(time_s), self.above.at(time_s));
        let scale = 1.0 / self.width;
        (
            (above.position() - below.position()) * scale,
            (above.theta - below.theta) * scale,
        )
    }
}

impl Basis {
    pub(crate) fn new(model: &Model<f64>, course: Course) -> Self {
        let by = |gain: f64| course.with_shapes(model, |shape| shape * gain);
        let gain = Around {
            below: by(1.0 - GAIN_STEP),
            above: by(1.0 + GAIN_STEP),
            width: 2.0 * GAIN_STEP,
        };
        Self {
            course,
            gain,
            drag: None,
        }
    }

    /// The same with the derivatives by ln χ and ln r_s. Returns `None` if the drag cannot differ.
    pub(crate) fn with_drag(&self, model: &Model<f64>) -> Option<Self> {
        let by = |chi: f64, radius: f64| {
            let mut swimmer = *model.swimmer();
            swimmer.chi *= chi.exp();
            swimmer.sphere_radius *= radius.exp();
            let model = Model::new(&swimmer).ok()?;
            Some(self.course.with_shapes(&model, |shape| shape))
        };
        let around = |chi: f64, radius: f64| {
            Some(Around {
                below: by(-chi, -radius)?,
                above: by(chi, radius)?,
                width: 2.0 * DRAG_STEP,
            })
        };
        Some(Self {
            drag: Some([around(DRAG_STEP, 0.0)?, around(0.0, DRAG_STEP)?]),
            ..self.clone()
        })
    }

    /// Derivative of the course by time.
    fn velocity(&self, time_s: f64) -> (Vector2<f64>, f64) {
        let [before, after] = [-TIME_STEP, TIME_STEP].map(|by| self.course.at(time_s + by));
        let scale = 0.5 / TIME_STEP;
        (
            (after.position() - before.position()) * scale,
            (after.theta - before.theta) * scale,
        )
    }

    /// Derivatives by the drag; zero if they were not requested.
    fn drag_slopes(&self, time_s: f64) -> [(Vector2<f64>, f64); 2] {
        self.drag
            .as_ref()
            .map_or([(Vector2::zeros(), 0.0); 2], |around| {
                [0, 1].map(|which: usize| around[which].slope(time_s))
            })
    }
}

/// Deviations of the model itself: position \[m\] and heading \[rad\].
pub(crate) fn model_errors(course: &Course) -> [f64; 2] {
    course.oscillation().map(|rms| MODEL_ERROR * rms)
}

/// A fitted cycle.
#[derive(Debug, Clone)]
pub(crate) struct Fit {
    /// Pose of the middle link at the start.
    pub(crate) start: swimmer_model::Pose<f64>,
    /// Measured joint angles over the predicted ones.
    pub(crate) gain: f64,
    pub(crate) sigma_gain: f64,
    /// Drift of the swimmer in the tank's frame \[m/s\].
    pub(crate) drift: Vector2<f64>,
    pub(crate) sigma_drift: f64,
    /// Start of the cycle after its reported start \[s\].
    delay_s: f64,
    /// ln χ and ln r_s over the model's; zero if the basis has no derivatives by them.
    drag: [f64; 2],
    /// Root mean square of the residuals over their expected deviation.
    pub(crate) misfit: f64,
    /// Measured poses at start and end, with their deviations \[m, rad\]; `None` if an end was not seen.
    pub(crate) ends: Option<([swimmer_model::Pose<f64>; 2], [f64; 2])>,
}

/// `None` if there are too few poses.
pub(crate) fn fit(
    basis: &Basis,
    poses: &[Pose],
    began_s: f64,
    model_errors: [f64; 2],
) -> Option<Fit> {
    let first = poses.first()?;
    if poses.len() < 12 {
        return None;
    }
    let at_first = basis.course.at(first.time_s - began_s);
    let mut fit = Fit {
        start: first.placed() * at_first.inverse(),
        gain: 1.0,
        sigma_gain: PRIORS[0],
        drift: Vector2::zeros(),
        sigma_drift: PRIORS[1],
        delay_s: 0.0,
        drag: [0.0; 2],
        misfit: 0.0,
        ends: None,
    };
    let mut covariance = SMatrix::<f64, COUNT, COUNT>::identity();
    for _ in 0..ITERATIONS {
        let mut normal = SMatrix::<f64, COUNT, COUNT>::zeros();
        let mut right = SVector::<f64, COUNT>::zeros();
        normal[(3, 3)] = PRIORS[0].powi(-2);
        normal[(4, 4)] = PRIORS[1].powi(-2);
        normal[(5, 5)] = PRIORS[1].powi(-2);
        normal[(6, 6)] = PRIORS[2].powi(-2);
        for (index, drag) in [(7, fit.drag[0]), (8, fit.drag[1])] {
            normal[(index, index)] = DRAG_PRIOR.powi(-2);
            right[index] = -drag * normal[(index, index)];
        }
        right[3] = (1.0 - fit.gain) * normal[(3, 3)];
        right[4] = -fit.drift.x * normal[(4, 4)];
        right[5] = -fit.drift.y * normal[(5, 5)];
        right[6] = -fit.delay_s * normal[(6, 6)];
        for pose in poses {
            let (rows, turn_row, off, turn_off) = fit.residual(basis, pose, began_s);
            let [weight, turn_weight] = weights(pose, model_errors);
            normal += rows.transpose() * rows * weight;
            normal += turn_row.transpose() * turn_row * turn_weight;
            right += rows.transpose() * off * weight;
            right += turn_row.transpose() * turn_off * turn_weight;
        }
        let factors = normal.cholesky()?;
        let step = factors.solve(&right);
        covariance = factors.inverse();
        fit.start.x += step[0];
        fit.start.y += step[1];
        fit.start.theta += step[2];
        fit.gain += step[3];
        fit.drift += Vector2::new(step[4], step[5]);
        fit.delay_s += step[6];
        fit.drag[0] += step[7];
        fit.drag[1] += step[8];
    }
    let inflated = |index: usize| (FRAMES_PER_SAMPLE * covariance[(index, index)]).sqrt();
    fit.sigma_gain = inflated(3);
    fit.sigma_drift = inflated(4).max(inflated(5));
    fit.misfit = fit.root_mean_square(basis, poses, began_s, model_errors);
    fit.ends = fit.measured_ends(basis, poses, began_s);
    Some(fit)
}

/// Returns the fit without the poses that lie farthest from it, which a camera system gives in bursts when markers are hidden; `None`
/// if there are too few poses.
pub(crate) fn fit_without_outliers(
    basis: &Basis,
    poses: &[Pose],
    began_s: f64,
    model_errors: [f64; 2],
) -> Option<Fit> {
    let mut fitted = fit(basis, poses, began_s, model_errors)?;
    // Twice: the first fit is drawn to the outliers.
    for _ in 0..2 {
        let mut kept = poses.to_vec();
        let far = |pose: &Pose| fitted.deviation(basis, pose, began_s, model_errors);
        kept.sort_by(|one, other| far(one).total_cmp(&far(other)));
        #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // a share of a count
        kept.truncate(((1.0 - OUTLIERS) * poses.len() as f64) as usize);
        kept.sort_by(|one, other| one.time_s.total_cmp(&other.time_s));
        fitted = fit(basis, &kept, began_s, model_errors)?;
    }
    Some(fitted)
}

fn weights(pose: &Pose, [position, heading]: [f64; 2]) -> [f64; 2] {
    [
        1.0 / (pose.sigma_position_m.powi(2) + position.powi(2)),
        1.0 / (pose.sigma_heading_rad.powi(2) + heading.powi(2)),
    ]
}

impl Fit {
    /// Pose that the fit predicts at a time from the start.
    fn at(&self, basis: &Basis, time_s: f64) -> swimmer_model::Pose<f64> {
        let (local, turn) = self.local(basis, time_s - self.delay_s);
        let position = self.start.transform(&local) + self.drift * time_s;
        swimmer_model::Pose::new(position.x, position.y, self.start.theta + turn)
    }

    /// Position and heading of the fitted course in its own frame.
    fn local(&self, basis: &Basis, time_s: f64) -> (Vector2<f64>, f64) {
        let course = basis.course.at(time_s);
        let (mut position, mut turn) = (course.position(), course.theta);
        let by_gain = basis.gain.slope(time_s);
        let by_drag = basis.drag_slopes(time_s);
        let more = [self.gain - 1.0, self.drag[0], self.drag[1]];
        for ((slope, turn_slope), more) in [by_gain, by_drag[0], by_drag[1]].into_iter().zip(more) {
            position += slope * more;
            turn += turn_slope * more;
        }
        (position, turn)
    }

    /// Fitted net motion over the predicted one: 1 for a robot that moves as predicted.
    pub(crate) fn share_of_motion(&self, basis: &Basis, model_errors: [f64; 2]) -> f64 {
        let net = basis.course.net();
        let (position, turn) = self.local(basis, basis.course.duration_s());
        let [by_position, by_turn] =
            model_errors.map(|error| error.max(f64::MIN_POSITIVE).powi(-2));
        let product = |position: &Vector2<f64>, turn: f64| {
            net.position().dot(position) * by_position + net.theta * turn * by_turn
        };
        product(&position, turn) / product(&net.position(), net.theta)
    }

    /// Derivatives of position and heading, and the residuals of both.
    fn residual(
        &self,
        basis: &Basis,
        pose: &Pose,
        began_s: f64,
    ) -> (
        SMatrix<f64, 2, COUNT>,
        RowSVector<f64, COUNT>,
        Vector2<f64>,
        f64,
    ) {
        let time = pose.time_s - began_s;
        let here = self.at(basis, time);
        let (slope, turn_slope) = basis.gain.slope(time - self.delay_s);
        let by_drag = basis.drag_slopes(time - self.delay_s);
        let (velocity, turn_rate) = basis.velocity(time - self.delay_s);
        let (sin, cos) = self.start.theta.sin_cos();
        let turned = |v: Vector2<f64>| Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y);
        let (slope, velocity) = (turned(slope), turned(velocity));
        let [by_chi, by_radius] = by_drag.map(|(slope, _)| turned(slope));
        let arm = here.position() - self.drift * time - self.start.position();
        let rows = SMatrix::from([
            [1.0, 0.0],
            [0.0, 1.0],
            [-arm.y, arm.x],
            [slope.x, slope.y],
            [time, 0.0],
            [0.0, time],
            [-velocity.x, -velocity.y],
            by_chi.into(),
            by_radius.into(),
        ]);
        let [turn_by_chi, turn_by_radius] = by_drag.map(|(_, turn)| turn);
        let turn_row = RowSVector::from([
            0.0,
            0.0,
            1.0,
            turn_slope,
            0.0,
            0.0,
            -turn_rate,
            turn_by_chi,
            turn_by_radius,
        ]);
        let off = Vector2::new(pose.x_m, pose.y_m) - here.position();
        let turn_off = wrapped_angle(pose.heading_rad - here.theta);
        (rows, turn_row, off, turn_off)
    }

    /// Squared residuals of a pose over their expected variances.
    fn deviation(&self, basis: &Basis, pose: &Pose, began_s: f64, model_errors: [f64; 2]) -> f64 {
        let (_, _, off, turn_off) = self.residual(basis, pose, began_s);
        let [weight, turn_weight] = weights(pose, model_errors);
        off.norm_squared() * weight + turn_off * turn_off * turn_weight
    }

    fn root_mean_square(
        &self,
        basis: &Basis,
        poses: &[Pose],
        began_s: f64,
        model_errors: [f64; 2],
    ) -> f64 {
        let squares = poses
            .iter()
            .map(|pose| self.deviation(basis, pose, began_s, model_errors));
        (squares.sum::<f64>() / (3.0 * poses.len() as f64)).sqrt()
    }

    /// Fitted poses at both ends, each moved by the mean residual near it.
    fn measured_ends(
        &self,
        basis: &Basis,
        poses: &[Pose],
        began_s: f64,
    ) -> Option<([swimmer_model::Pose<f64>; 2], [f64; 2])> {
        let duration = basis.course.duration_s();
        let (mut variance, mut turn_variance) = (0.0, 0.0);
        let mut end = |time_s: f64, from: f64, to: f64| {
            let near = |pose: &&Pose| (from..=to).contains(&(pose.time_s - began_s));
            let (mut off, mut turn_off, mut count) = (Vector2::zeros(), 0.0, 0.0);
            let (mut squares, mut turn_squares) = (0.0, 0.0);
            for pose in poses.iter().filter(near) {
                let (_, _, by, turn_by) = self.residual(basis, pose, began_s);
                off += by;
                turn_off += turn_by;
                squares += pose.sigma_position_m.powi(2);
                turn_squares += pose.sigma_heading_rad.powi(2);
                count += 1.0;
            }
            if count < 3.0 {
                return None;
            }
            variance += FRAMES_PER_SAMPLE * squares / (count * count);
            turn_variance += FRAMES_PER_SAMPLE * turn_squares / (count * count);
            let here = self.at(basis, time_s);
            let moved = here.position() + off / count;
            let heading = here.theta + turn_off / count;
            Some(swimmer_model::Pose::new(moved.x, moved.y, heading))
        };
        let start = end(0.0, 0.0, END * duration)?;
        let last = end(duration, (1.0 - END) * duration, duration)?;
        // The net motion is measured in the frame of the first heading.
        let lever = (last.position() - start.position()).norm_squared();
        let sigma = (variance + lever * turn_variance).sqrt();
        Some(([start, last], [sigma, turn_variance.sqrt()]))
    }
}
