//! Likelihood of a finished fit: its data in units of their scales, and a rectangle of (r_s/L, ln χ) to evaluate.

use swimmer_model::Pose;

use super::leave_one_out::{self, Unexpected};
use super::surface::{Rectangle, Surface};
use super::{Pair, RunError, WithoutRun, bootstrap};
use crate::cycles::{Cycle, Cycles, Statistics};
use crate::error::FitError;
use crate::fit::likelihood::Estimate;
use crate::fit::run_model::RunModel;
use crate::fit::run_values::RunValues;
use crate::fit::{self, CampaignFit, Intervals};
use crate::quantities::{QUANTITIES, TELLING, measured};

/// Half widths of the first rectangle, in half widths of the fit's intervals.
const REACH: f64 = 4.0;
/// Smallest and largest half widths of a rectangle, in r_s/L and ln χ.
const SMALLEST: [f64; 2] = [2e-3, 1e-2];
const LARGEST: [f64; 2] = [0.25, 1.2];
/// Rectangles that are tried until one holds the estimate.
pub(super) const RECTANGLES: usize = 5;

/// Data and range of the likelihood.
pub(super) struct LikelihoodProblem {
    pub(super) data: RunValues,
    /// The paper's optimum in (r_s/L, ln χ), and half of its intervals' widths.
    pub(super) paper: [f64; 2],
    half: [f64; 2],
}

impl LikelihoodProblem {
    pub(super) fn of(found: &CampaignFit) -> Result<Self, FitError> {
        let Intervals {
            sphere_radius, chi, ..
        } = found.fit.intervals;
        Ok(Self {
            data: found.values()?,
            paper: found.optimum(),
            half: [
                (sphere_radius[1] - found.fit.sphere_radius) / found.length(),
                (chi[1] / found.fit.chi).ln(),
            ],
        })
    }

    /// The optimum of the likelihood from as many starts as the paper's fit, with the variances of an estimate.
    pub(super) fn multi_start_optimum(
        &self,
        model: &RunModel,
        estimate: &Estimate,
    ) -> Option<[f64; 2]> {
        let end = fit::search(model, &self.data, &estimate.weights).ok()?;
        Some([end.at[0], end.at[1]])
    }

    /// Widens or moves the rectangle until it holds the estimate and what surrounds it.
    pub(super) fn settle(
        &self,
        start: [f64; 2],
        ask: impl Fn(Rectangle) -> Option<Surface>,
    ) -> Option<(Surface, RunValues, Estimate, Vec<Unexpected>)> {
        let mut half = [0, 1].map(|i| (REACH * self.half[i]).clamp(SMALLEST[i], LARGEST[i]));
        let mut centre = [0, 1].map(|i| f64::midpoint(self.paper[i], start[i]));
        for (half, i) in half.iter_mut().zip(0..2) {
            *half = (*half + (self.paper[i] - start[i]).abs()).min(LARGEST[i]);
        }
        for attempt in 1..=RECTANGLES {
            let Some(surface) = ask(Rectangle::about(centre, half)) else {
                half = half.map(|h| h / 2.0);
                continue;
            };
            let (data, estimate, unexpected) =
                leave_one_out::without_outliers(&surface, &self.data, start)?;
            let found = [estimate.at[0], estimate.at[1]];
            let inside = surface.rectangle.holds(found);
            if (inside && surface.rectangle.holds(self.paper)) || attempt == RECTANGLES {
                return Some((surface, data, estimate, unexpected));
            }
            centre = [0, 1].map(|i| f64::midpoint(self.paper[i], found[i]));
            half = [0, 1].map(|i| {
                let apart = (self.paper[i] - found[i]).abs();
                (2.0 * half[i] + apart).min(LARGEST[i])
            });
        }
        None
    }

    /// Cycles of a run as the bootstrap draws them; of repeats the first stands for all, with their mean.
    pub(super) fn drawn(&self, run: usize, cycles: &Cycles) -> bootstrap::RunDeviations {
        let row = |q: usize| QUANTITIES * run + q;
        let of_cycles = |of: fn(&Cycle) -> f64| cycles.cycles.iter().map(of).collect();
        let of_steps = |of: fn(&Pose<f64>) -> f64| {
            let steps = cycles.cycles.iter().filter_map(|c| c.step.as_ref());
            steps.map(of).collect::<Vec<f64>>()
        };
        let values: [Vec<f64>; QUANTITIES] = [
            of_steps(|step| step.x),
            of_cycles(|cycle| cycle.delta_y),
            of_cycles(|cycle| cycle.delta_theta),
            of_steps(|step| step.y),
            of_steps(|step| step.theta),
        ];
        let statistics = measured(cycles);
        let deviations = |q: usize| {
            let Statistics {
                mean,
                sd,
                se,
                count,
                ..
            } = statistics[q];
            // A drawn mean varies by sd²(n − 1)/n² by itself.
            let n = count.max(1) as f64;
            let by_itself = sd * (n - 1.0).max(0.0).sqrt() / n;
            let wide = if by_itself > 0.0 { se / by_itself } else { 1.0 };
            values[q]
                .iter()
                .map(|v| (v - mean) * wide / self.data.scales[q])
                .collect()
        };
        bootstrap::RunDeviations {
            means: std::array::from_fn(|q| self.data.values[row(q)]),
            there: std::array::from_fn(|q| self.data.used[row(q)]),
            deviations: std::array::from_fn(deviations),
        }
    }

    pub(super) fn run_errors(&self, estimate: &Estimate) -> Vec<[RunError; TELLING]> {
        let of = |row: usize| {
            if !self.data.is_there(row) {
                return RunError::NONE;
            }
            let scale = self.data.scales[row % QUANTITIES];
            let standard_error = estimate.components.variance(row).sqrt();
            let predicted = self.data.values[row] + estimate.residuals[row];
            let residual = predicted - self.data.own[row];
            RunError {
                measured: self.data.own[row] * scale,
                predicted: predicted * scale,
                within: self.data.own_within[row].value.sqrt() * scale,
                standard_error: standard_error * scale,
                standardised: residual / standard_error,
            }
        };
        (0..self.data.values.len() / QUANTITIES)
            .map(|run| std::array::from_fn(|q| of(QUANTITIES * run + q)))
            .collect()
    }

    pub(super) fn without_runs(
        &self,
        surface: &Surface,
        data: &RunValues,
        at: [f64; 2],
        pair: impl Fn([f64; 2]) -> Pair,
    ) -> Vec<WithoutRun> {
        let likelihood = leave_one_out::leave_one_out(surface, data, at);
        let runs = likelihood.len();
        let there = &self.data.used;
        let paper = |left_out: usize| {
            let mut weights = vec![1.0; runs];
            weights[left_out] = 0.0;
            bootstrap::papers_fit(surface, (&self.data.values, there), &weights, self.paper)
        };
        likelihood
            .into_iter()
            .enumerate()
            .map(|(run, likelihood)| WithoutRun {
                run,
                paper: pair(paper(run)),
                likelihood: likelihood.map(&pair),
            })
            .collect()
    }
}
