//! X/√E of a symmetric Fourier gait (paper, Appendix C) with exact gradient and Hessian with respect to the coefficients,
//! evaluated on a quarter of the closed curve.
//!
//! The objective is ln |x| − ½ ln E over the quarter. By Cauchy–Schwarz E ≥ S², with equality at constant power. In the limit of
//! high orders the maximum is therefore that of X/S at constant power.

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::Model;

use crate::closed_curve::{Basis, Functional, Weights, Workspace};

/// Value of the objective.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Value {
    /// ln |x| − ½ ln E, to be maximised.
    pub(crate) objective: f64,
    /// x of the quarter over L.
    pub(crate) x: f64,
    /// ∫√P of the quarter, P over `c_t`.
    pub(crate) power_length: f64,
}

impl Value {
    /// x/S.
    pub(crate) fn ratio(&self) -> f64 {
        self.x / self.power_length
    }

    /// Lighthill's efficiency at constant power.
    pub(crate) fn efficiency(&self) -> f64 {
        self.ratio().powi(2)
    }
}

/// Objective with gradient and Hessian.
#[derive(Debug, Clone)]
pub(crate) struct Expansion {
    pub(crate) value: Value,
    pub(crate) gradient: DVector<f64>,
    pub(crate) hessian: DMatrix<f64>,
}

/// Objective of one swimmer for series of one order.
#[derive(Debug)]
pub(crate) struct Objective<'a> {
    model: &'a Model<f64>,
    basis: Basis,
    work: Workspace,
    /// Maps the coefficients to those of the curve: cosines along φ₁ = φ₂, sines across it.
    embedding: DMatrix<f64>,
}

/// Evaluates Φ and Φ′ of the series with coefficients (A₁, B₁, A₂, B₂, …) at s.
pub(crate) fn series(coefficients: &[f64], s: f64) -> (Vector2<f64>, Vector2<f64>) {
    let (mut at, mut rate) = (Vector2::zeros(), Vector2::zeros());
    let (first, twice) = (s.sin_cos(), (2.0 * s).sin_cos());
    let (mut sin, mut cos) = first;
    let mut order = 1.0;
    for pair in coefficients.chunks_exact(2) {
        let (a, b) = (pair[0], pair[1]);
        at += Vector2::new(a * cos, b * sin);
        rate += Vector2::new(-order * a * sin, order * b * cos);
        (sin, cos) = (sin * twice.1 + cos * twice.0, cos * twice.1 - sin * twice.0);
        order += 2.0;
    }
    (from_diagonals(&at), from_diagonals(&rate))
}

/// Converts coordinates along and across φ₁ = φ₂ to joint angles.
fn from_diagonals(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(v.x - v.y, v.x + v.y) * std::f64::consts::FRAC_1_SQRT_2
}

impl<'a> Objective<'a> {
    /// Creates the objective for series of this order with this number of panels per quarter.
    pub(crate) fn new(model: &'a Model<f64>, order: usize, panels: usize) -> Self {
        let basis = Basis::quarter(order, panels);
        let work = Functional::new(model, &basis).workspace();
        let mut embedding = DMatrix::zeros(4 * order, 2 * order);
        for coefficient in 0..2 * order {
            let even = coefficient.is_multiple_of(2);
            let along = if even { Vector2::x() } else { Vector2::y() };
            let mut own = embedding.fixed_view_mut::<2, 1>(2 * coefficient, coefficient);
            own.copy_from(&from_diagonals(&along));
        }
        Self {
            model,
            basis,
            work,
            embedding,
        }
    }

    fn curve(&self, coefficients: &[f64]) -> DMatrix<f64> {
        let curve = &self.embedding * DVector::from_column_slice(coefficients);
        curve.reshape_generic(nalgebra::Dyn(2), nalgebra::Dyn(self.basis.functions()))
    }

    /// Evaluates the objective with x and S of the quarter.
    pub(crate) fn value(&mut self, coefficients: &[f64]) -> Value {
        let curve = self.curve(coefficients);
        let values = Functional::new(self.model, &self.basis).values(&curve, &mut self.work);
        self.worth(&values)
    }

    fn worth(&self, values: &crate::closed_curve::Values) -> Value {
        let (x, drag) = (values.displacement.x, self.model.side_drag());
        Value {
            objective: x.abs().ln() - 0.5 * (values.energy / drag).ln(),
            x,
            power_length: values.power_length / drag.sqrt(),
        }
    }

    /// Evaluates the objective with gradient and Hessian.
    pub(crate) fn expansion(&mut self, coefficients: &[f64]) -> Expansion {
        let curve = self.curve(coefficients);
        let functional = Functional::new(self.model, &self.basis);
        let values = functional.gradients(&curve, &mut self.work);
        let weights = Weights {
            momentum: Vector2::new(1.0 / values.displacement.x, 0.0),
            rotation: 0.0,
            energy: -0.5 / values.energy,
        };
        functional.hessian(&weights, &[], &mut self.work);
        let slope = |column: usize| self.embedding.tr_mul(&self.work.gradients.column(column));
        let (of_x, of_energy) = (slope(0) * weights.momentum.x, slope(3) / values.energy);
        let mut hessian = self
            .embedding
            .tr_mul(&(&self.work.hessian * &self.embedding));
        hessian.ger(-1.0, &of_x, &of_x, 1.0);
        hessian.ger(0.5, &of_energy, &of_energy, 1.0);
        Expansion {
            value: self.worth(&values),
            gradient: of_x - of_energy * 0.5,
            hessian,
        }
    }
}
