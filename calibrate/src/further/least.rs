//! Least squares within bounds, and the likelihood on top of it: parameters and variances in turn.

use nalgebra::{DMatrix, DVector};

use super::setting::Setting;
use crate::fit::components::Components;
use crate::fit::measured::RunValues;

/// Steps of one minimisation.
const STEPS: usize = 40;
/// Rounds of parameters and variances.
const ROUNDS: usize = 8;

/// A minimum.
#[derive(Debug, Clone)]
pub(crate) struct Minimum {
    pub(crate) at: Vec<f64>,
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: DMatrix<f64>,
}

/// Levenberg–Marquardt; a parameter at its bound that would leave it stands still.
pub(crate) fn minimise(
    setting: &Setting<'_>,
    data: &RunValues,
    weights: &[f64],
    start: &[f64],
) -> Option<Minimum> {
    let bounds = setting.bounds();
    let clamp = |z: Vec<f64>| -> Vec<f64> {
        let values = z.into_iter().zip(&bounds);
        values
            .map(|(z, (low, high))| z.clamp(*low, *high))
            .collect()
    };
    let look = |z: &[f64]| -> Option<(f64, Vec<f64>)> {
        let values = setting.predict(z)?;
        let residuals: Vec<f64> = values
            .iter()
            .zip(&data.values)
            .map(|(a, b)| a - b)
            .collect();
        let cost = residuals.iter().zip(weights).map(|(r, w)| w * r * r).sum();
        Some((cost, residuals))
    };
    let mut at = clamp(start.to_vec());
    let (mut cost, mut residuals) = look(&at)?;
    let mut jacobian = setting.jacobian(&at)?;
    let mut damping = 1e-4;
    for _ in 0..STEPS {
        let mut weighted = jacobian.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(weights) {
            row *= *weight;
        }
        let mut bend = weighted.tr_mul(&jacobian);
        let mut slope = weighted.tr_mul(&DVector::from_column_slice(&residuals));
        for (i, (low, high)) in bounds.iter().enumerate() {
            let outwards = (at[i] <= *low && slope[i] > 0.0) || (at[i] >= *high && slope[i] < 0.0);
            if outwards {
                slope[i] = 0.0;
                bend.row_mut(i).fill(0.0);
                bend.column_mut(i).fill(0.0);
                bend[(i, i)] = 1.0;
            } else {
                bend[(i, i)] *= 1.0 + damping;
            }
        }
        let step = bend.lu().solve(&slope)?;
        let next = clamp(at.iter().zip(step.iter()).map(|(a, s)| a - s).collect());
        let moved: f64 = next.iter().zip(&at).map(|(a, b)| (a - b).abs()).sum();
        match look(&next) {
            Some(seen) if seen.0 <= cost => {
                at = next;
                (cost, residuals) = seen;
                jacobian = setting.jacobian(&at)?;
                damping = (damping / 10.0).max(1e-10);
            }
            _ => damping *= 10.0,
        }
        if moved < 1e-9 || damping > 1e8 {
            break;
        }
    }
    Some(Minimum {
        at,
        residuals,
        jacobian,
    })
}

/// Where the likelihood is largest.
#[derive(Debug, Clone)]
pub(crate) struct Likeliest {
    pub(crate) minimum: Minimum,
    pub(crate) components: Components,
    pub(crate) weights: Vec<f64>,
    pub(crate) log_likelihood: f64,
}

/// Minima that are nearer than this are one.
const APART: f64 = 1e-4;

/// From several starts to minima of least squares, from each of them to a largest likelihood, of which the largest counts.
pub(crate) fn likeliest(
    setting: &Setting<'_>,
    data: &RunValues,
    starts: &[Vec<f64>],
) -> Option<Likeliest> {
    let even = vec![1.0; data.values.len()];
    let mut ends: Vec<Minimum> = Vec::new();
    for end in starts
        .iter()
        .filter_map(|start| minimise(setting, data, &even, start))
    {
        let near = |other: &Minimum| {
            let apart = end.at.iter().zip(&other.at).map(|(a, b)| (a - b).abs());
            apart.sum::<f64>() < APART
        };
        if !ends.iter().any(near) {
            ends.push(end);
        }
    }
    ends.into_iter()
        .filter_map(|end| likeliest_from(setting, data, even.clone(), end))
        .max_by(|a, b| a.log_likelihood.total_cmp(&b.log_likelihood))
}

/// Weights from the residuals, parameters from the weights, in turn.
fn likeliest_from(
    setting: &Setting<'_>,
    data: &RunValues,
    even: Vec<f64>,
    end: Minimum,
) -> Option<Likeliest> {
    let components = |minimum: &Minimum, weights: &[f64]| {
        Components::of(
            &minimum.jacobian,
            weights,
            &minimum.residuals,
            data.within.clone(),
        )
    };
    let mut found = components(&end, &even)?;
    let mut minimum = end;
    let mut weights = even;
    for _ in 0..ROUNDS {
        let before = minimum.at.clone();
        weights = (0..data.values.len())
            .map(|row| 1.0 / found.variance(row))
            .collect();
        minimum = minimise(setting, data, &weights, &before)?;
        found = components(&minimum, &weights)?;
        let moved: f64 = minimum
            .at
            .iter()
            .zip(&before)
            .map(|(a, b)| (a - b).abs())
            .sum();
        if moved < 1e-8 {
            break;
        }
    }
    let rows = minimum.residuals.iter().enumerate();
    let terms = rows.map(|(row, residual)| {
        let variance = found.variance(row);
        variance.ln() + residual * residual / variance
    });
    Some(Likeliest {
        log_likelihood: -terms.sum::<f64>() / 2.0,
        minimum,
        components: found,
        weights,
    })
}
