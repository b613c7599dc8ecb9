//! The modes of the joint likelihood of runs and of what is known beforehand.
//!
//! Priors have heavy tails: a prior that contradicts the runs loses weight with its distance. So the posterior has several modes.
//! In one mode the runs scatter and all priors hold. In others a prior does not hold, and the runs agree. Each prior is dropped in
//! turn, along the model's tangent; the likeliest results are then refined with the model itself.

use super::Plain;
use super::known::Known;
use crate::fit::likelihood::Estimate;
use crate::fit::outliers;
use crate::fit::parameter::Parameter;
use crate::fit::prior::{Prior, WithPriors};
use crate::fit::run_model::RunModel;
use crate::fit::run_values::RunValues;
use crate::fit::tangent::Tangent;
use crate::least_squares::{Model as _, weighted};

/// Number of values per value that may be left out as an outlier.
const VALUES_FOR_ONE: usize = 8;
/// A prior that contradicts the runs by more standard deviations than this loses weight with the distance, in `DOUBTS` rounds.
const BELIEVED: f64 = 1.5;
const DOUBTS: usize = 4;
/// Widths that differ by less are the same, as a share.
const SAME: f64 = 1e-3;
/// By how much what is known is widened to be forgotten, how many ends of that are followed by the model itself, and how near to
/// each other they are one.
const FORGOTTEN: f64 = 30.0;
const FOLLOWED: usize = 2;
const APART: f64 = 3e-3;

/// A model of the runs, and what is known of its parameters.
pub(super) struct JointProblem {
    model: RunModel,
    priors: Vec<Prior>,
    /// Values of the runs, then the priors.
    data: RunValues,
    /// Index of the first prior among them.
    pub(super) first: usize,
    start: Vec<f64>,
    /// Weights of the first step, from the side on which the runs scatter.
    scattered: Vec<f64>,
}

/// A mode of the joint likelihood.
pub(super) struct Mode {
    pub(super) estimate: Estimate,
    pub(super) tangent: Tangent,
    /// With what is known as far as it is believed.
    pub(super) data: RunValues,
}

impl JointProblem {
    /// With one thing more that may be so.
    pub(super) fn new(plain: &Plain, known: &[Known], more: Option<Prior>) -> Self {
        let priors: Vec<Prior> = known.iter().map(|known| known.prior).chain(more).collect();
        let parameters: Vec<Parameter> = priors.iter().map(|prior| prior.parameter).collect();
        let values: Vec<f64> = priors.iter().map(|prior| prior.value).collect();
        let (model, mut start) = plain.with(&parameters, &values);
        if let (Some(last), Some(more)) = (start.last_mut(), more) {
            // From where it is: a dead band of none has another slope.
            *last += more.width / 2.0;
        }
        let (_, data) = WithPriors::new(&model, &plain.data, &priors);
        let first = plain.data.values.len();
        let scattered = data.weights(|row| {
            if row < first {
                plain.all.components.variance(row)
            } else {
                data.within[row].value
            }
        });
        Self {
            model,
            priors,
            data,
            first,
            start,
            scattered,
        }
    }

    /// The parameters of its model.
    pub(super) fn parameters(&self) -> &[Parameter] {
        &self.model.parameters
    }

    fn model(&self) -> WithPriors<'_> {
        WithPriors::new(&self.model, &self.data, &self.priors).0
    }

    /// The model's tangent where the search begins.
    pub(super) fn tangent(&self) -> Option<Tangent> {
        Tangent::of(&self.model(), &self.start)
    }

    /// The same with the derivatives of a problem that knows one thing less.
    pub(super) fn tangent_beyond(&self, base: &Tangent) -> Option<Tangent> {
        let model = self.model();
        let last = self.start.len() - 1;
        let mut column = self.model.column(&self.start, last, None)?;
        let rows = self.data.values.len();
        column = column.resize_vertically(rows, 0.0);
        column[rows - 1] = 1.0;
        Some(base.beyond(&model, &self.start, model.values(&self.start)?, &column))
    }

    /// The likeliest mode whose evidence along a tangent is above `least`.
    pub(super) fn mode(&self, least: f64, tangent: &Tangent) -> Option<Mode> {
        let even = self.data.weights(|_| 1.0);
        let sides = [&self.scattered, &even].map(|weights| {
            let end = Estimate::of_weighted(tangent, &self.data, &self.start, weights.clone())?;
            self.doubted(tangent, self.data.clone(), end)
        });
        let forgotten = (0..self.priors.len()).map(|index| {
            let mut data = self.data.clone();
            data.within[self.first + index].value *= FORGOTTEN * FORGOTTEN;
            let end = Estimate::of(tangent, &data, &self.start)?;
            self.doubted(tangent, data, end)
        });
        let ends = sides.into_iter().chain(forgotten).flatten();
        let mut ends: Vec<(Estimate, RunValues)> = ends
            .filter(|(estimate, _)| evidence(estimate) > least)
            .collect();
        ends.sort_by(|a, b| evidence(&b.0).total_cmp(&evidence(&a.0)));
        let apart = |a: &Estimate, b: &Estimate| {
            let moved = a.at.iter().zip(&b.at).map(|(a, b)| (a - b).abs());
            moved.sum::<f64>() > APART
        };
        let mut followed: Vec<(Estimate, RunValues)> = Vec::new();
        for end in ends {
            if followed.len() < FOLLOWED && followed.iter().all(|f| apart(&f.0, &end.0)) {
                followed.push(end);
            }
        }
        let modes = followed
            .into_iter()
            .filter_map(|(end, data)| self.from(data, &end.at, &end.weights));
        modes.max_by(|a, b| evidence(&a.estimate).total_cmp(&evidence(&b.estimate)))
    }

    /// Along a tangent, what contradicts the runs believed less, in a few rounds.
    fn doubted(
        &self,
        tangent: &Tangent,
        mut data: RunValues,
        mut found: Estimate,
    ) -> Option<(Estimate, RunValues)> {
        for _ in 0..DOUBTS {
            self.doubt(&mut data, &found.at);
            let weights = data.weights(|row| found.components.variance(row));
            found = Estimate::of_weighted(tangent, &data, &found.at, weights)?;
        }
        Some((found, data))
    }

    /// The mode that a step with these weights leads to; what contradicts the runs is then believed less, in a few rounds.
    fn from(&self, mut data: RunValues, start: &[f64], weights: &[f64]) -> Option<Mode> {
        let model = self.model();
        let (mut estimate, mut tangent) = Tangent::estimate(&model, &data, start, weights)?;
        for _ in 0..DOUBTS {
            if !self.doubt(&mut data, &estimate.at) {
                break;
            }
            let weights = data.weights(|row| estimate.components.variance(row));
            (estimate, tangent) = Tangent::estimate(&model, &data, &estimate.at, &weights)?;
        }
        Some(Mode {
            estimate,
            tangent,
            data,
        })
    }

    /// Widens what is known by as much as the runs contradict it, so that it does not draw the answer with it; whether that
    /// changes anything.
    fn doubt(&self, data: &mut RunValues, at: &[f64]) -> bool {
        let mut changed = false;
        for (index, prior) in self.priors.iter().enumerate() {
            let off = (at[2 + index] - prior.value).abs() / prior.width;
            let wider = (off / BELIEVED).max(1.0);
            let believed = &mut data.within[self.first + index].value;
            let variance = (wider * prior.width).powi(2);
            changed |= (variance / *believed - 1.0).abs() > SAME;
            *believed = variance;
        }
        changed
    }

    /// The mode without the values that are unlike all else, and which these are.
    pub(super) fn without_outliers(&self, mode: Mode) -> Option<(Mode, Vec<usize>)> {
        let Mode {
            mut estimate,
            tangent,
            mut data,
        } = mode;
        let mut left_out = Vec::new();
        while left_out.len() < self.data.count() / VALUES_FOR_ONE {
            let Estimate {
                jacobian,
                weights,
                residuals,
                ..
            } = &estimate;
            let Some(worst) = outliers::worst(jacobian, weights, residuals, &data.within) else {
                break;
            };
            let without = data.without(|row| row == worst.row);
            let weights = without.weights(|row| estimate.components.variance(row));
            let Some(next) = Estimate::of_weighted(&tangent, &without, &estimate.at, weights)
            else {
                break;
            };
            left_out.push(worst.row);
            (estimate, data) = (next, without);
        }
        let mode = if left_out.is_empty() {
            Mode {
                estimate,
                tangent,
                data,
            }
        } else {
            self.from(data, &estimate.at, &estimate.weights)?
        };
        Some((mode, left_out))
    }
}

/// Weight of a mode with its neighbourhood (Laplace approximation): a narrow mode needs a higher peak than a wide one.
pub(super) fn evidence(found: &Estimate) -> f64 {
    let Estimate {
        jacobian, weights, ..
    } = found;
    let information = weighted(jacobian, weights).tr_mul(jacobian);
    let Some(factors) = information.cholesky() else {
        return f64::NEG_INFINITY;
    };
    let roots = factors.l_dirty().diagonal();
    found.log_likelihood - roots.iter().map(|root| root.ln()).sum::<f64>()
}
