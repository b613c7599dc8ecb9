//! What a finished fit hands on: its data in units of their scales, and a rectangle of (r_s/L, ln χ) to look at.

use swimmer_files::{AnyGait, Campaign};

use super::deletion::{self, Unexpected};
use super::estimate::{Estimate, Measured};
use super::surface::{Rectangle, Surface};
use super::{Drawn, Pair, RunError, WithoutRun, bootstrap};
use crate::campaign::{CampaignData, CampaignFit, RunResult};
use crate::cycles::{Cycles, Statistics};
use crate::fit::measured::RunValues;
use crate::fit::{self, Intervals, Observation};

/// Half widths of the first rectangle, in half widths of the fit's intervals.
const REACH: f64 = 4.0;
/// Smallest and largest half widths of a rectangle, in r_s/L and ln χ.
const SMALLEST: [f64; 2] = [2e-3, 1e-2];
const LARGEST: [f64; 2] = [0.25, 1.2];
/// Rectangles that are tried until one holds the estimate.
pub(super) const RECTANGLES: usize = 5;

/// What is known before the model is asked.
pub(super) struct Sought {
    /// L \[m\].
    pub(super) length: f64,
    /// Largest measured X, ΔY, Δθ.
    pub(super) scales: [f64; 3],
    measured: Measured,
    /// The paper's optimum in (r_s/L, ln χ), and half of its intervals' widths.
    pub(super) paper: [f64; 2],
    half: [f64; 2],
}

impl Sought {
    pub(super) fn of(found: &CampaignFit, length: f64) -> Self {
        let RunValues {
            scales,
            values,
            within,
        } = RunValues::of(&found.runs);
        let fit = &found.fit;
        let Intervals {
            sphere_radius, chi, ..
        } = fit.intervals;
        Self {
            length,
            scales,
            measured: Measured {
                used: vec![true; values.len()],
                values,
                within,
            },
            paper: [fit.sphere_radius / length, fit.chi.ln()],
            half: [
                (sphere_radius[1] - fit.sphere_radius) / length,
                (chi[1] / fit.chi).ln(),
            ],
        }
    }

    /// The likelihood sought from as many starts as the paper's fit, with the variances of an estimate.
    pub(super) fn sought_widely(
        &self,
        campaign: &Campaign,
        data: &CampaignData,
        found: &CampaignFit,
        estimate: &Estimate,
    ) -> Option<[f64; 2]> {
        let observed = |run: &RunResult| Observation::new(run.path.clone(), &run.cycles);
        let runs: Vec<Observation> = found.runs.iter().map(observed).collect();
        let gaits: Vec<AnyGait> = data.runs.iter().map(|run| run.gait.clone()).collect();
        let factors: Vec<[f64; 3]> = estimate
            .weights
            .chunks(3)
            .map(|run| [0, 1, 2].map(|q| run[q].sqrt() / self.scales[q]))
            .collect();
        fit::with_factors(&campaign.swimmer.swimmer, &runs, &gaits, &factors).ok()
    }

    /// Widens or moves the rectangle until it holds the estimate and what surrounds it.
    pub(super) fn settle(
        &self,
        start: [f64; 2],
        ask: impl Fn(Rectangle) -> Option<Surface>,
    ) -> Option<(Surface, Measured, Estimate, Vec<Unexpected>)> {
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
                deletion::without_outliers(&surface, &self.measured, start)?;
            let inside = surface.rectangle.holds(estimate.at);
            if (inside && surface.rectangle.holds(self.paper)) || attempt == RECTANGLES {
                return Some((surface, data, estimate, unexpected));
            }
            centre = [0, 1].map(|i| f64::midpoint(self.paper[i], estimate.at[i]));
            half = [0, 1].map(|i| {
                let apart = (self.paper[i] - estimate.at[i]).abs();
                (2.0 * half[i] + apart).min(LARGEST[i])
            });
        }
        None
    }

    /// Cycles as the bootstrap draws them.
    pub(super) fn drawn(&self, cycles: &Cycles) -> Drawn {
        let values = [
            cycles
                .cycles
                .iter()
                .filter_map(|c| c.step.map(|step| step.x))
                .collect(),
            cycles.cycles.iter().map(|c| c.delta_y).collect(),
            cycles
                .cycles
                .iter()
                .map(|c| c.delta_theta)
                .collect::<Vec<f64>>(),
        ];
        let statistics = [cycles.x, cycles.delta_y, cycles.delta_theta];
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
                .map(|v| (v - mean) * wide / self.scales[q])
                .collect()
        };
        Drawn {
            means: [0, 1, 2].map(|q| statistics[q].mean / self.scales[q]),
            deviations: [0, 1, 2].map(deviations),
        }
    }

    pub(super) fn run_errors(&self, estimate: &Estimate) -> Vec<[RunError; 3]> {
        let of = |row: usize| {
            let scale = self.scales[row % 3];
            let standard_error = estimate.components.variance(row).sqrt();
            let residual = estimate.residuals[row];
            RunError {
                measured: self.measured.values[row] * scale,
                predicted: (self.measured.values[row] + residual) * scale,
                within: self.measured.within[row].value.sqrt() * scale,
                standard_error: standard_error * scale,
                standardised: residual / standard_error,
            }
        };
        (0..self.measured.values.len() / 3)
            .map(|run| [0, 1, 2].map(|q| of(3 * run + q)))
            .collect()
    }

    pub(super) fn without_runs(
        &self,
        surface: &Surface,
        data: &Measured,
        at: [f64; 2],
        pair: impl Fn([f64; 2]) -> Pair,
    ) -> Vec<WithoutRun> {
        let likelihood = deletion::leave_one_out(surface, data, at);
        let runs = likelihood.len();
        let paper = |left_out: usize| {
            let mut weights = vec![1.0; runs];
            weights[left_out] = 0.0;
            bootstrap::papers_fit(surface, &self.measured.values, &weights, self.paper)
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
