//! Polynomials through Chebyshev–Lobatto nodes on \[0, 1\]: derivative at the nodes and integral up to each, exact for the
//! polynomial. (Its values are exact at both ends, where arcs meet bounds and symmetry lines.)

use std::f64::consts::PI;

use nalgebra::{DMatrix, Vector2};

/// A rule of `degree + 1` nodes.
#[derive(Debug, Clone)]
pub(super) struct Nodes {
    /// From 0 to 1, increasing.
    pub(super) place: Vec<f64>,
    derivative: DMatrix<f64>,
    integral: DMatrix<f64>,
}

impl Nodes {
    pub(super) fn new(degree: usize) -> Self {
        let n = degree.max(2);
        let angle = |j: usize| PI * (n - j) as f64 / n as f64;
        let half = |j: usize| if j == 0 || j == n { 0.5 } else { 1.0 };
        // Coefficient k of the polynomial in T_k, from the values at the nodes.
        let coefficients = DMatrix::from_fn(n + 1, n + 1, |k, j| {
            2.0 / n as f64 * half(k) * half(j) * (k as f64 * angle(j)).cos()
        });
        let sign = |k: usize| if k.is_multiple_of(2) { 1.0 } else { -1.0 };
        let slopes = DMatrix::from_fn(n + 1, n + 1, |j, k| {
            let order = k as f64;
            let slope = if j == n {
                order * order
            } else if j == 0 {
                -sign(k) * order * order
            } else {
                order * (order * angle(j)).sin() / angle(j).sin()
            };
            2.0 * slope
        });
        let areas = DMatrix::from_fn(n + 1, n + 1, |j, k| {
            let t = |k: usize| (k as f64 * angle(j)).cos();
            let order = k as f64;
            let primitive = match k {
                0 => t(1) + 1.0,
                1 => (t(2) - 1.0) / 4.0,
                _ => {
                    (t(k + 1) + sign(k)) / (2.0 * (order + 1.0))
                        - (t(k - 1) + sign(k)) / (2.0 * (order - 1.0))
                }
            };
            0.5 * primitive
        });
        Self {
            place: (0..=n).map(|j| 0.5 * (1.0 + angle(j).cos())).collect(),
            derivative: slopes * &coefficients,
            integral: areas * coefficients,
        }
    }

    pub(super) fn count(&self) -> usize {
        self.place.len()
    }

    /// The derivative of a curve at the nodes.
    pub(super) fn slopes(&self, values: &[Vector2<f64>]) -> Vec<Vector2<f64>> {
        self.derivative
            .row_iter()
            .map(|row| {
                row.iter()
                    .zip(values)
                    .fold(Vector2::zeros(), |sum, (weight, value)| {
                        sum + value * *weight
                    })
            })
            .collect()
    }

    /// The integral from 0 to each node.
    pub(super) fn integrals(&self, values: &[f64]) -> Vec<f64> {
        self.integral
            .row_iter()
            .map(|row| {
                row.iter()
                    .zip(values)
                    .map(|(weight, value)| weight * value)
                    .sum()
            })
            .collect()
    }

    /// The integral from 0 to 1.
    pub(super) fn whole(&self, values: impl Iterator<Item = f64>) -> f64 {
        let last = self.integral.nrows().saturating_sub(1);
        self.integral
            .row(last)
            .iter()
            .zip(values)
            .map(|(weight, value)| weight * value)
            .sum()
    }

    /// The polynomial at t, in barycentric form.
    pub(super) fn value(&self, values: &[Vector2<f64>], t: f64) -> Vector2<f64> {
        let last = self.place.len().saturating_sub(1);
        let (mut above, mut below) = (Vector2::zeros(), 0.0);
        for (j, (place, value)) in self.place.iter().zip(values).enumerate() {
            let apart = t - place;
            if apart.abs() < 1e-15 {
                return *value;
            }
            let half = if j == 0 || j == last { 0.5 } else { 1.0 };
            let weight = if j.is_multiple_of(2) { half } else { -half } / apart;
            above += value * weight;
            below += weight;
        }
        above / below
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
        let whole = nodes.whole(curve.iter().map(|value| value.x));
        assert!((whole - (1.0 / 6.0 - 0.5)).abs() < 1e-14);
        let between = nodes.value(&curve, 0.377);
        assert!((between.y - (2.0 * 0.377_f64).exp()).abs() < 1e-13);
    }
}
