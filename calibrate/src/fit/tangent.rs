//! Linearised model: one simulation per parameter gives a tangent plane, on which the likelihood is cheap. The optimum of a model
//! of many parameters is computed by successive tangents, each at the last one's optimum.

use nalgebra::{DMatrix, DVector};

use super::likelihood::Estimate;
use super::run_values::RunValues;
use crate::least_squares::Model;

/// Tangents until the parameters stand still, and what that is.
const TANGENTS: usize = 8;
const STILL: f64 = 1e-4;

/// A model's values near a point.
pub(crate) struct Tangent {
    at: Vec<f64>,
    values: Vec<f64>,
    jacobian: DMatrix<f64>,
    bounds: Vec<(f64, f64)>,
}

impl Tangent {
    pub(crate) fn new(
        at: &[f64],
        values: Vec<f64>,
        jacobian: DMatrix<f64>,
        bounds: Vec<(f64, f64)>,
    ) -> Self {
        Self {
            at: at.to_vec(),
            values,
            jacobian,
            bounds,
        }
    }

    pub(crate) fn of(model: &impl Model, at: &[f64]) -> Option<Self> {
        Some(Self {
            at: at.to_vec(),
            values: model.values(at)?,
            jacobian: model.jacobian(at)?,
            bounds: model.bounds(),
        })
    }

    /// With one parameter more: its column, the values at a point near by, and a row of its own if it is known beforehand.
    pub(crate) fn beyond(
        &self,
        model: &impl Model,
        at: &[f64],
        values: Vec<f64>,
        column: &DVector<f64>,
    ) -> Self {
        let (rows, last) = (values.len(), at.len() - 1);
        let jacobian = DMatrix::from_fn(rows, at.len(), |i, j| match (i, j) {
            (i, j) if j == last => column.get(i).copied().unwrap_or(0.0),
            (i, j) => self.jacobian.get((i, j)).copied().unwrap_or(0.0),
        });
        Self::new(at, values, jacobian, model.bounds())
    }

    /// The largest likelihood of the model itself, and its last tangent. `weights` are those of the first step.
    pub(crate) fn estimate(
        model: &impl Model,
        data: &RunValues,
        start: &[f64],
        weights: &[f64],
    ) -> Option<(Estimate, Self)> {
        let mut tangent = Self::of(model, start)?;
        let mut found = Estimate::of_weighted(&tangent, data, start, weights.to_vec())?;
        for _ in 1..TANGENTS {
            let moved: f64 = found
                .at
                .iter()
                .zip(&tangent.at)
                .map(|(a, b)| (a - b).abs())
                .sum();
            if moved < STILL {
                break;
            }
            tangent = Self::of(model, &found.at)?;
            let weights = found.weights.clone();
            found = Estimate::of_weighted(&tangent, data, &found.at, weights)?;
        }
        Some((found, tangent))
    }
}

impl Model for Tangent {
    fn bounds(&self) -> Vec<(f64, f64)> {
        self.bounds.clone()
    }

    fn values(&self, at: &[f64]) -> Option<Vec<f64>> {
        let by = at.iter().zip(&self.at).map(|(a, b)| a - b);
        let by = DVector::from_iterator(self.at.len(), by);
        let change = &self.jacobian * by;
        Some(
            self.values
                .iter()
                .zip(change.iter())
                .map(|(v, c)| v + c)
                .collect(),
        )
    }

    fn jacobian(&self, _at: &[f64]) -> Option<DMatrix<f64>> {
        Some(self.jacobian.clone())
    }
}
