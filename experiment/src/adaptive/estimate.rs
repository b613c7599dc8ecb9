//! Weighted least squares of χ and r_s over the trials, with the noise of each quantity pooled over all of them.

use calibrate::student;
use nalgebra::{Matrix2, Vector2};
use serde::Serialize;

use super::response::{QUANTITIES, Response};
use super::{CampaignGoal, Candidate, StartParameters};

/// Iterations of Gauss–Newton, and the step of ln χ at which they end.
const ITERATIONS: usize = 50;
const STILL: f64 = 1e-9;
/// Trials with fewer do not determine the noise; the expected noise is used.
const FEWEST_FOR_NOISE: usize = 3;
/// Deviations of ln χ, and of r_s as a share, that keep the information of few trials from being singular.
const WEAK: [f64; 2] = [0.5, 0.5];

/// Measured trial: means over its cycles.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct MeasuredTrial {
    /// Index of the gait.
    pub candidate: usize,
    /// X \[m\], ΔY \[m\], Δθ \[rad\]; NaN for a trial whose track cannot be used, which counts as time only.
    pub values: [f64; QUANTITIES],
    /// Standard errors of the means by the scatter of the cycles; NaN if there are too few. The noise of a trial is no less.
    pub standard_errors: [f64; QUANTITIES],
}

impl MeasuredTrial {
    /// Returns `true` if the trial was measured.
    pub fn is_usable(&self) -> bool {
        self.values.iter().all(|value| value.is_finite())
    }
}

/// Fitted χ and r_s with their intervals.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct DragEstimate {
    /// χ.
    pub chi: f64,
    /// Half width of its interval.
    pub chi_half_width: f64,
    /// r_s \[m\].
    pub sphere_radius_m: f64,
    /// Half width of its interval \[m\].
    pub sphere_radius_half_width_m: f64,
    /// Degrees of freedom of the intervals: the fewer of both.
    pub freedom: f64,
    /// Standard deviation of a trial's X \[m\], ΔY \[m\] and Δθ \[rad\].
    pub noise: [f64; QUANTITIES],
    /// The fit is at the border of the range around the swimmer file: start again from a file that is nearer to the robot.
    pub is_at_border: bool,
}

/// Fisher information of trials on ln χ and r_s.
#[derive(Debug, Clone, Copy)]
pub(super) struct Information(Matrix2<f64>);

impl Information {
    /// Information that is negligible against that of a trial.
    pub(super) fn weak(at: [f64; 2]) -> Self {
        let radius = WEAK[1] * at[1].max(0.01);
        Self(Matrix2::from_diagonal(&Vector2::new(
            WEAK[0].powi(-2),
            radius.powi(-2),
        )))
    }

    /// Adds a trial of a gait.
    pub(super) fn add(&mut self, response: &Response, at: [f64; 2], noise: &[f64; QUANTITIES]) {
        let (_, slopes) = response.at(at);
        for (slope, noise) in slopes.into_iter().zip(noise) {
            let slope = Vector2::from(slope);
            self.0 += slope * slope.transpose() / noise.powi(2);
        }
    }

    /// The same with a further trial of a gait.
    pub(super) fn with(
        &self,
        response: &Response,
        at: [f64; 2],
        noise: &[f64; QUANTITIES],
    ) -> Self {
        let mut more = *self;
        more.add(response, at, noise);
        more
    }
}

/// Half widths of ln χ and of r_s \[m\]. Returns `None` if the information is singular.
pub(super) fn half_widths(information: &Information, freedom: f64, level: f64) -> Option<[f64; 2]> {
    let covariance = information.0.try_inverse()?;
    let factor = student::quantile(freedom, level)?;
    Some([0, 1].map(|which| factor * covariance[(which, which)].sqrt()))
}

/// Expected noise of a trial if a length has this standard deviation.
pub(super) fn expected_noise(accuracy_m: f64, middle_m: f64) -> [f64; QUANTITIES] {
    [accuracy_m, accuracy_m, accuracy_m / middle_m]
}

/// Fits χ and r_s to the trials, from `start`. Returns `None` with fewer than three trials, or if they do not determine both.
pub fn estimate(
    candidates: &[Candidate],
    trials: &[MeasuredTrial],
    start: StartParameters,
    goal: &CampaignGoal,
) -> Option<DragEstimate> {
    let played: Vec<(&Response, &MeasuredTrial)> = trials
        .iter()
        .filter(|trial| trial.is_usable())
        .map(|trial| Some((&candidates.get(trial.candidate)?.response, trial)))
        .collect::<Option<_>>()?;
    if played.len() < FEWEST_FOR_NOISE {
        return None;
    }
    let first = played.first()?.0;
    let mut noise = expected_noise(goal.accuracy_m, first.middle_m());
    let mut at = first.clamped(start.coordinates());
    let mut fit = step(&played, at, &noise)?;
    for _ in 0..ITERATIONS {
        let next = first.clamped([at[0] + fit.change.x, at[1] + fit.change.y]);
        let moved = (next[0] - at[0]).abs() + (next[1] - at[1]).abs() / at[1].max(1e-3);
        at = next;
        noise = step(&played, at, &noise)?.pooled_noise(&played);
        fit = step(&played, at, &noise)?;
        if moved < STILL {
            break;
        }
    }
    let variances = [0, 1].map(|which| fit.covariance[(which, which)]);
    let freedoms = [0, 1].map(|which| fit.freedom_of(which));
    let half = |which: usize| {
        Some(student::quantile(freedoms[which], goal.level)? * variances[which].sqrt())
    };
    let chi = at[0].exp();
    Some(DragEstimate {
        chi,
        chi_half_width: half(0)? * chi,
        sphere_radius_m: at[1],
        sphere_radius_half_width_m: half(1)?,
        freedom: freedoms[0].min(freedoms[1]),
        noise,
        is_at_border: first.is_at_border(at),
    })
}

/// Linearised fit at a point.
struct Step {
    /// Change of ln χ and r_s.
    change: Vector2<f64>,
    covariance: Matrix2<f64>,
    /// Information by quantity.
    information: [Matrix2<f64>; QUANTITIES],
    /// Sums of squared residuals after the step.
    squares: [f64; QUANTITIES],
    /// Degrees of freedom of the residuals of each quantity.
    freedom: [f64; QUANTITIES],
}

fn step(
    played: &[(&Response, &MeasuredTrial)],
    at: [f64; 2],
    noise: &[f64; QUANTITIES],
) -> Option<Step> {
    let mut information = [Matrix2::zeros(); QUANTITIES];
    let mut right = Vector2::zeros();
    for (response, trial) in played {
        let (values, slopes) = response.at(at);
        for quantity in 0..QUANTITIES {
            let slope = Vector2::from(slopes[quantity]) / noise[quantity];
            information[quantity] += slope * slope.transpose();
            right += slope * ((trial.values[quantity] - values[quantity]) / noise[quantity]);
        }
    }
    let covariance = information.iter().sum::<Matrix2<f64>>().try_inverse()?;
    let change = covariance * right;
    let mut squares = [0.0; QUANTITIES];
    for (response, trial) in played {
        let (values, slopes) = response.at(at);
        for quantity in 0..QUANTITIES {
            let slope = Vector2::from(slopes[quantity]);
            let residual = trial.values[quantity] - values[quantity] - slope.dot(&change);
            squares[quantity] += residual.powi(2);
        }
    }
    let count = played.len() as f64;
    let freedom = information.map(|of| count - (covariance * of).trace());
    Some(Step {
        change,
        covariance,
        information,
        squares,
        freedom,
    })
}

impl Step {
    /// Noise of each quantity by the residuals of all trials; no less than the scatter of the cycles within trials shows.
    fn pooled_noise(&self, played: &[(&Response, &MeasuredTrial)]) -> [f64; QUANTITIES] {
        std::array::from_fn(|quantity| {
            let within = played
                .iter()
                .map(|(_, trial)| trial.standard_errors[quantity].powi(2))
                .filter(|square| square.is_finite());
            let (sum, count) = within.fold((0.0, 0.0), |(sum, count), square| {
                (sum + square, count + 1.0)
            });
            let floor = if count > 0.0 { sum / count } else { 0.0 };
            let pooled = self.squares[quantity] / self.freedom[quantity].max(0.5);
            pooled.max(floor).sqrt().max(f64::MIN_POSITIVE)
        })
    }

    /// Degrees of freedom of a parameter's variance (Welch–Satterthwaite over the quantities).
    fn freedom_of(&self, parameter: usize) -> f64 {
        let row = self.covariance.row(parameter);
        let (mut sum, mut uncertainty) = (0.0, 0.0);
        for (of, freedom) in self.information.iter().zip(self.freedom) {
            let part = (row * of * row.transpose())[(0, 0)];
            sum += part;
            uncertainty += part.powi(2) / freedom.max(0.5);
        }
        (sum.powi(2) / uncertainty).max(1.0)
    }
}
