//! The likelihood of one set of data: Gaussian errors with a variance for each run and quantity, of which one part comes from
//! the cycles and one, common to all runs, is estimated with the parameters.

use nalgebra::{DMatrix, Matrix2, Vector2};

use super::surface::{Rectangle, Surface};
use crate::fit::components::Components;
use crate::fit::errors::Variance;

/// Rounds of parameters and variances.
const ROUNDS: usize = 40;
/// Steps of one minimisation.
const STEPS: usize = 60;

/// X, ΔY, Δθ of every run as measured, each in units of its scale, with the variances within runs.
#[derive(Debug, Clone)]
pub(super) struct Measured {
    pub(super) values: Vec<f64>,
    pub(super) within: Vec<Variance>,
    /// Which of them count.
    pub(super) used: Vec<bool>,
}

impl Measured {
    /// The same without a run, or without one quantity of it.
    pub(super) fn without(&self, mut left_out: impl FnMut(usize) -> bool) -> Self {
        let mut out = self.clone();
        for (row, used) in out.used.iter_mut().enumerate() {
            *used = *used && !left_out(row);
        }
        out
    }

    /// Weights of least squares for these variances.
    fn weights(&self, variance: impl Fn(usize) -> f64) -> Vec<f64> {
        let weigh = |(row, used): (usize, &bool)| if *used { 1.0 / variance(row) } else { 0.0 };
        self.used.iter().enumerate().map(weigh).collect()
    }
}

/// Where the likelihood is largest.
#[derive(Debug, Clone)]
pub(super) struct Estimate {
    /// (r_s/L, ln χ).
    pub(super) at: [f64; 2],
    pub(super) components: Components,
    pub(super) weights: Vec<f64>,
    /// Model less measured.
    pub(super) residuals: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    /// Sum of squares in units of the variances.
    pub(super) cost: f64,
}

impl Estimate {
    /// From a starting point; `None` where the data do not determine the parameters.
    pub(super) fn of(surface: &Surface, data: &Measured, start: [f64; 2]) -> Option<Self> {
        let even = data.weights(|_| 1.0);
        let mut at = minimise(surface, &data.values, &even, start);
        let (mut residuals, mut jacobian) = compare(surface, data, at);
        let mut components = Components::of(&jacobian, &even, &residuals, data.within.clone())?;
        let mut weights = even;
        for _ in 0..ROUNDS {
            let before = (at, components.between);
            weights = data.weights(|row| components.variance(row));
            at = minimise(surface, &data.values, &weights, at);
            (residuals, jacobian) = compare(surface, data, at);
            components = Components::of(&jacobian, &weights, &residuals, data.within.clone())?;
            let still = |(a, b): (&f64, &f64)| (a - b).abs() <= 1e-9 * (a.abs() + b.abs());
            if at.iter().zip(&before.0).all(still)
                && components.between.iter().zip(&before.1).all(still)
            {
                break;
            }
        }
        let cost = cost(&residuals, &weights);
        Some(Self {
            at,
            components,
            weights,
            residuals,
            jacobian,
            cost,
        })
    }

    /// How much less likely a point is than the optimum: difference of the logarithms, never above 0.
    pub(super) fn log_ratio(&self, surface: &Surface, data: &Measured, at: [f64; 2]) -> f64 {
        let (residuals, _) = compare(surface, data, at);
        ((self.cost - cost(&residuals, &self.weights)) / 2.0).min(0.0)
    }
}

/// Model less measured, and the model's derivatives.
fn compare(surface: &Surface, data: &Measured, at: [f64; 2]) -> (Vec<f64>, DMatrix<f64>) {
    let (values, jacobian) = surface.at(at);
    let residuals = values.iter().zip(&data.values).map(|(a, b)| a - b);
    (residuals.collect(), jacobian)
}

pub(super) fn cost(residuals: &[f64], weights: &[f64]) -> f64 {
    let squares = residuals.iter().zip(weights).map(|(r, w)| w * r * r);
    squares.sum()
}

/// Least squares on the surface, within its rectangle (Levenberg–Marquardt with the border r_s = 0 as an active bound).
pub(super) fn minimise(
    surface: &Surface,
    measured: &[f64],
    weights: &[f64],
    start: [f64; 2],
) -> [f64; 2] {
    least(surface, measured, weights, start, [true, true])
}

/// The same along a line where one parameter stands still.
pub(super) fn minimise_along(
    surface: &Surface,
    measured: &[f64],
    weights: &[f64],
    start: [f64; 2],
    fixed: usize,
) -> [f64; 2] {
    least(surface, measured, weights, start, [fixed != 0, fixed != 1])
}

fn least(
    surface: &Surface,
    measured: &[f64],
    weights: &[f64],
    start: [f64; 2],
    free: [bool; 2],
) -> [f64; 2] {
    let rectangle: Rectangle = surface.rectangle;
    let look = |at: [f64; 2]| {
        let (values, jacobian) = surface.at(at);
        let residuals: Vec<f64> = values.iter().zip(measured).map(|(a, b)| a - b).collect();
        (cost(&residuals, weights), residuals, jacobian)
    };
    let mut at = rectangle.clamp(start);
    let (mut least, mut residuals, mut jacobian) = look(at);
    let mut damping = 1e-6;
    for _ in 0..STEPS {
        let mut slope = Vector2::zeros();
        let mut bend = Matrix2::zeros();
        for (row, (residual, weight)) in residuals.iter().zip(weights).enumerate() {
            let gradient = Vector2::new(jacobian[(row, 0)], jacobian[(row, 1)]);
            slope += gradient * (weight * residual);
            bend += gradient * gradient.transpose() * *weight;
        }
        for i in 0..2 {
            let outwards = (at[i] <= rectangle.low[i] && slope[i] > 0.0)
                || (at[i] >= rectangle.high[i] && slope[i] < 0.0);
            if outwards || !free[i] {
                slope[i] = 0.0;
                (bend[(0, 1)], bend[(1, 0)]) = (0.0, 0.0);
                bend[(i, i)] = 1.0;
            } else {
                bend[(i, i)] *= 1.0 + damping;
            }
        }
        let Some(step) = bend.lu().solve(&slope) else {
            break;
        };
        let next = rectangle.clamp([at[0] - step.x, at[1] - step.y]);
        let moved = (next[0] - at[0]).abs() + (next[1] - at[1]).abs();
        let seen = look(next);
        if seen.0 <= least {
            at = next;
            (least, residuals, jacobian) = seen;
            damping = (damping / 10.0).max(1e-12);
        } else {
            damping = (damping * 10.0).min(1e12);
        }
        if moved < 1e-14 {
            break;
        }
    }
    at
}
