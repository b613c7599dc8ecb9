//! The largest likelihood of Gaussian errors with a variance for each run and quantity, of which one part comes from the
//! cycles and one, common to all runs, is estimated with the parameters: parameters and variances in turn.

use nalgebra::DMatrix;

use super::components::Components;
use super::run_values::RunValues;
use crate::least_squares::{Minimum, Model, cost, minimise};

/// Rounds of parameters and variances, and the relative change at which they stand still.
const ROUNDS: usize = 40;
const STILL: f64 = 1e-7;
/// Minima that are nearer than this are one.
const APART: f64 = 1e-4;

/// Maximum of the likelihood.
#[derive(Debug, Clone)]
pub(crate) struct Estimate {
    pub(crate) at: Vec<f64>,
    pub(crate) components: Components,
    pub(crate) weights: Vec<f64>,
    /// Model less measured.
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: DMatrix<f64>,
    /// Sum of squares in units of the variances.
    pub(crate) cost: f64,
    pub(crate) log_likelihood: f64,
}

impl Estimate {
    /// From a starting point; `None` where the data do not determine the parameters.
    pub(crate) fn of(model: &impl Model, data: &RunValues, start: &[f64]) -> Option<Self> {
        Self::of_weighted(model, data, start, data.weights(|_| 1.0))
    }

    /// The same, with the weights of the first step.
    pub(crate) fn of_weighted(
        model: &impl Model,
        data: &RunValues,
        start: &[f64],
        weights: Vec<f64>,
    ) -> Option<Self> {
        let end = minimise(model, &data.values, &weights, start, &model.bounds())?;
        Self::from_minimum(model, data, weights, end)
    }

    /// The best from several starting points.
    pub(crate) fn best_of(
        model: &impl Model,
        data: &RunValues,
        starts: &[Vec<f64>],
    ) -> Option<Self> {
        let even = data.weights(|_| 1.0);
        let bounds = model.bounds();
        let mut ends: Vec<Minimum> = Vec::new();
        for start in starts {
            let Some(end) = minimise(model, &data.values, &even, start, &bounds) else {
                continue;
            };
            if ends.iter().all(|other| apart(&end.at, &other.at) > APART) {
                ends.push(end);
            }
        }
        ends.into_iter()
            .filter_map(|end| Self::from_minimum(model, data, even.clone(), end))
            .max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))
    }

    fn from_minimum(
        model: &impl Model,
        data: &RunValues,
        even: Vec<f64>,
        end: Minimum,
    ) -> Option<Self> {
        let bounds = model.bounds();
        let components = |minimum: &Minimum, weights: &[f64]| {
            Components::of(
                &minimum.jacobian,
                weights,
                &minimum.residuals,
                data.within.clone(),
            )
        };
        let mut found = components(&end, &even)?;
        let (mut minimum, mut weights) = (end, even);
        for _ in 0..ROUNDS {
            let before = (minimum.at, found.between);
            weights = data.weights(|row| found.variance(row));
            minimum = minimise(model, &data.values, &weights, &before.0, &bounds)?;
            found = components(&minimum, &weights)?;
            let still = |(a, b): (&f64, &f64)| (a - b).abs() <= STILL * (a.abs() + b.abs());
            if minimum.at.iter().zip(&before.0).all(still)
                && found.between.iter().zip(&before.1).all(still)
            {
                break;
            }
        }
        let rows = minimum.residuals.iter().enumerate();
        let terms = rows
            .filter(|(row, _)| data.used[*row])
            .map(|(row, residual)| {
                let variance = found.variance(row);
                variance.ln() + residual * residual / variance
            });
        Some(Self {
            log_likelihood: -terms.sum::<f64>() / 2.0,
            at: minimum.at,
            components: found,
            weights,
            residuals: minimum.residuals,
            jacobian: minimum.jacobian,
            cost: minimum.cost,
        })
    }

    /// Log-likelihood of a point less that of the optimum; never above 0.
    pub(crate) fn log_ratio(&self, model: &impl Model, data: &RunValues, at: &[f64]) -> f64 {
        let Some(values) = model.values(at) else {
            return f64::NEG_INFINITY;
        };
        let residuals = values.iter().zip(&data.values).map(|(a, b)| a - b);
        let residuals: Vec<f64> = residuals.collect();
        ((self.cost - cost(&residuals, &self.weights)) / 2.0).min(0.0)
    }
}

fn apart(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| (a - b).abs()).sum()
}
