//! Polynomials through Chebyshev–Lobatto nodes on \[0, 1\]: derivative at the nodes and integral up to each, exact for the
//! polynomial. (Its values are exact at both ends, where arcs meet bounds and symmetry lines.)

use std::f64::consts::PI;
use std::iter::Sum;
use std::ops::Mul;

use nalgebra::{DMatrix, DVector, Vector2};

use crate::height_map::legendre::gauss;

/// Rule with `degree + 1` nodes.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// Nodes from 0 to 1, increasing.
    pub(super) place: Vec<f64>,
    derivative: DMatrix<f64>,
    integral: DMatrix<f64>,
}

impl Nodes {
    pub(super) fn new(degree: usize) -> Self {
        let n = degree.max(2);
        let place: Vec<f64> = (0..=n)
            .map(|j| 0.5 * (1.0 - (PI * j as f64 / n as f64).cos()))
            .collect();
        let mut nodes = Self {
            derivative: DMatrix::zeros(n + 1, n + 1),
            integral: DMatrix::zeros(n + 1, n + 1),
            place,
        };
        let (points, weights) = gauss(n / 2 + 1);
        for (j, &at) in nodes.place.iter().enumerate() {
            // The derivative of a constant is zero.
            let others = (0..=n).filter(|&k| k != j);
            for k in others {
                let slope = nodes.weight(k) / nodes.weight(j) / (at - nodes.place[k]);
                nodes.derivative[(j, k)] = slope;
                nodes.derivative[(j, j)] -= slope;
            }
            for (s, weight) in points.iter().zip(&weights) {
                let shares = nodes.shares(0.5 * at * (s + 1.0));
                for (k, share) in shares.into_iter().enumerate() {
                    nodes.integral[(j, k)] += 0.5 * at * weight * share;
                }
            }
        }
        nodes
    }

    /// Weight of the barycentric form.
    fn weight(&self, j: usize) -> f64 {
        let half = if j == 0 || j + 1 == self.count() {
            0.5
        } else {
            1.0
        };
        if j.is_multiple_of(2) { half } else { -half }
    }

    /// Values of the Lagrange polynomials at t.
    fn shares(&self, t: f64) -> Vec<f64> {
        let terms = self.place.iter().enumerate();
        let mut terms: Vec<f64> = terms
            .map(|(j, place)| self.weight(j) / (t - place))
            .collect();
        if let Some(here) = self
            .place
            .iter()
            .position(|place| (t - place).abs() < 1e-15)
        {
            terms.fill(0.0);
            terms[here] = 1.0;
        }
        let whole: f64 = terms.iter().sum();
        terms.iter().map(|term| term / whole).collect()
    }

    pub(super) fn count(&self) -> usize {
        self.place.len()
    }

    /// Derivative of a curve at the nodes.
    pub(super) fn slopes(&self, values: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        let rows = self.derivative.row_iter();
        rows.map(|row| {
            row.iter()
                .zip(values)
                .map(|(weight, value)| value * *weight)
                .sum()
        })
        .collect()
    }

    /// Integral from 0 to each node.
    pub(super) fn integrals(&self, values: &[f64]) -> Vec<f64> {
        (&self.integral * DVector::from_column_slice(values))
            .data
            .into()
    }

    /// Value of the polynomial at t.
    pub(super) fn value<V: Copy + Mul<f64, Output = V> + Sum>(&self, values: &[V], t: f64) -> V {
        let shares = self.shares(t).into_iter().zip(values);
        shares.map(|(share, value)| *value * share).sum()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn it_is_exact_for_polynomials_and_spectral_for_the_rest() {
        let nodes = Nodes::new(18);
        let curve: Vec<_> = nodes
            .place
            .iter()
            .map(|&t| Vector2::new(t.powi(5) - t, (2.0 * t).exp()))
            .collect();
        for ((&t, slope), value) in nodes.place.iter().zip(nodes.slopes(&curve)).zip(&curve) {
            assert!((slope.x - (5.0 * t.powi(4) - 1.0)).abs() < 1e-11);
            assert!((slope.y - 2.0 * value.y).abs() < 1e-11);
        }
        let second: Vec<f64> = curve.iter().map(|value| value.y).collect();
        for (&t, area) in nodes.place.iter().zip(nodes.integrals(&second)) {
            assert!((area - ((2.0 * t).exp() - 1.0) / 2.0).abs() < 1e-13);
        }
        let between = nodes.value(&curve, 0.377);
        assert!((between.y - (2.0 * 0.377_f64).exp()).abs() < 1e-13);
    }
}
