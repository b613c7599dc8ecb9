//! Coarse curves as shapes: their sense, whether they are simple, and whether two are the same gait.

use nalgebra::{DMatrix, Vector2};

use crate::certificate::{crossings, turning_number};
use crate::closed_curve::Basis;

/// Sides of the polygon that a coarse curve is looked at as.
const SIDES: usize = 240;

/// The closed polygon of a curve, last point = first.
pub(crate) fn polygon(basis: &Basis, coefficients: &DMatrix<f64>) -> Vec<Vector2<f64>> {
    (0..=SIDES)
        .map(|k| basis.shape(coefficients, (k % SIDES) as f64 / SIDES as f64))
        .collect()
}

/// Whether a closed polygon turns once and never crosses itself.
pub(crate) fn is_simple(points: &[Vector2<f64>]) -> bool {
    (turning_number(points).abs() - 1.0).abs() < 1e-6 && crossings(points) == 0
}
