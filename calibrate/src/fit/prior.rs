//! Priors of parameters, as additional measurements: the likelihood weighs both.

use nalgebra::DMatrix;

use super::errors::Variance;
use super::parameter::Parameter;
use super::run_model::RunModel;
use super::run_values::RunValues;
use crate::least_squares::Model;

/// A parameter's value and its standard deviation, in the fit's units.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Prior {
    pub(crate) parameter: Parameter,
    pub(crate) value: f64,
    pub(crate) width: f64,
}

/// A model whose last values are parameters themselves.
pub(crate) struct WithPriors<'a> {
    model: &'a RunModel,
    places: Vec<usize>,
}

impl<'a> WithPriors<'a> {
    /// The model, and the data with what is known beforehand.
    pub(crate) fn new(
        model: &'a RunModel,
        data: &RunValues,
        priors: &[Prior],
    ) -> (Self, RunValues) {
        let mut data = data.clone();
        let mut places = Vec::new();
        for prior in priors {
            let Some(place) = model.parameters.iter().position(|p| *p == prior.parameter) else {
                continue;
            };
            places.push(place);
            data.values.push(prior.value);
            data.push_known();
            data.within.push(Variance {
                value: prior.width.powi(2),
                freedom: f64::INFINITY,
            });
        }
        (Self { model, places }, data)
    }
}

impl Model for WithPriors<'_> {
    fn bounds(&self) -> Vec<(f64, f64)> {
        self.model.bounds()
    }

    fn values(&self, at: &[f64]) -> Option<Vec<f64>> {
        let mut values = self.model.values(at)?;
        values.extend(self.places.iter().map(|place| at[*place]));
        Some(values)
    }

    fn jacobian(&self, at: &[f64]) -> Option<DMatrix<f64>> {
        let of_runs = self.model.jacobian(at)?;
        let runs = of_runs.nrows();
        Some(DMatrix::from_fn(
            runs + self.places.len(),
            at.len(),
            |row, column| match row.checked_sub(runs) {
                None => of_runs[(row, column)],
                Some(prior) => f64::from(u8::from(self.places[prior] == column)),
            },
        ))
    }
}
