//! Polynomial space of the frame, in the basis that diagonalises the Neumann problem.
//!
//! On \[−1, 1\] the eigenfunctions qᵢ of stiffness against mass, among polynomials of degree below n, are orthonormal and
//! have orthogonal slopes: ∫qᵢqⱼ = δᵢⱼ, ∫qᵢ′qⱼ′ = λᵢδᵢⱼ. In their products on the square the Laplacian with natural boundary
//! conditions is multiplication by λᵢ + λⱼ: Poisson's equation is solved by one division, and the coupled problem has an effective
//! preconditioner.

use nalgebra::{DMatrix, DVector};

use super::legendre::{gauss, polynomials};

/// Polynomials of degree below n in each of two directions, with a Gauss rule.
#[derive(Debug, Clone)]
pub(super) struct Space {
    /// Gauss points.
    pub(super) nodes: Vec<f64>,
    /// Eigenvalues λᵢ.
    pub(super) eigenvalues: DVector<f64>,
    /// Coefficients of qᵢ in orthonormal Legendre polynomials, one column per i.
    legendre: DMatrix<f64>,
    /// Values of qᵢ at the nodes, one row per node.
    values: DMatrix<f64>,
    slopes: DMatrix<f64>,
    /// The same values, transposed and times the weights: one column per node.
    weighted_values: DMatrix<f64>,
    weighted_slopes: DMatrix<f64>,
}

/// Values of a function on the tensor grid of Gauss points, or its coefficients; the row index runs along φ₁.
pub(super) type Field = DMatrix<f64>;

/// Function and its slopes in both directions at the Gauss points.
#[derive(Debug, Clone)]
pub(super) struct Sampled {
    pub(super) value: Field,
    pub(super) slopes: [Field; 2],
}

impl Space {
    /// Polynomials of degree below `order`, with a rule of `points` Gauss points.
    pub(super) fn new(order: usize, points: usize) -> Self {
        let (nodes, weights) = gauss(points);
        // p_k′ = Σ √(2j+1)(2k+1) p_j over j < k of the other parity.
        let derivative = DMatrix::from_fn(order, order, |j, k| {
            if j < k && (j + k) % 2 == 1 {
                (((2 * j + 1) * (2 * k + 1)) as f64).sqrt()
            } else {
                0.0
            }
        });
        let stiffness = derivative.transpose() * &derivative;
        let eigen = stiffness.symmetric_eigen();
        let (p, d) = table(&nodes, order);
        let (values, slopes) = (p * &eigen.eigenvectors, d * &eigen.eigenvectors);
        Self {
            weighted_values: weighed(&values, &weights),
            weighted_slopes: weighed(&slopes, &weights),
            values,
            slopes,
            nodes,
            // The eigenvalue of the constant is zero to rounding.
            eigenvalues: eigen
                .eigenvalues
                .map(|value| if value < 1e-6 { 0.0 } else { value }),
            legendre: eigen.eigenvectors,
        }
    }

    pub(super) fn order(&self) -> usize {
        self.eigenvalues.len()
    }

    /// Evaluates the function with these coefficients at the Gauss points.
    pub(super) fn sample(&self, coefficients: &Field) -> Sampled {
        let across = coefficients * self.values.transpose();
        let steep = coefficients * self.slopes.transpose();
        Sampled {
            value: &self.values * &across,
            slopes: [&self.slopes * &across, &self.values * &steep],
        }
    }

    /// Computes ∫ (f ψ + g·∇ψ) for each basis function ψ.
    pub(super) fn test(&self, f: &Field, g: [&Field; 2]) -> Field {
        let across = &self.weighted_values * f + &self.weighted_slopes * g[0];
        let steep = &self.weighted_values * g[1];
        across * self.weighted_values.transpose() + steep * self.weighted_slopes.transpose()
    }

    /// Mean of f over the square.
    pub(super) fn mean(&self, f: &Field) -> f64 {
        let (mut sum, mut area) = (0.0, 0.0);
        let (_, weights) = gauss(self.nodes.len());
        for (column, w2) in f.column_iter().zip(&weights) {
            for (value, w1) in column.iter().zip(&weights) {
                sum += w1 * w2 * value;
                area += w1 * w2;
            }
        }
        sum / area
    }

    /// Coefficients in products of orthonormal Legendre polynomials.
    pub(super) fn in_legendre(&self, coefficients: &Field) -> Field {
        &self.legendre * coefficients * self.legendre.transpose()
    }
}

/// Transposes values at the nodes of a rule, one row per node, and multiplies them by the weights.
pub(super) fn weighed(values: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    let mut transposed = values.transpose();
    for (mut column, weight) in transposed.column_iter_mut().zip(weights) {
        column *= *weight;
    }
    transposed
}

/// Orthonormal Legendre polynomials and their slopes at given points, one row per point.
pub(super) fn table(places: &[f64], order: usize) -> (DMatrix<f64>, DMatrix<f64>) {
    let mut values = DMatrix::zeros(places.len(), order);
    let mut slopes = DMatrix::zeros(places.len(), order);
    let (mut p, mut d) = (vec![0.0; order], vec![0.0; order]);
    for (i, s) in places.iter().enumerate() {
        polynomials(*s, &mut p, &mut d);
        for (value, p) in values.row_mut(i).iter_mut().zip(&p) {
            *value = *p;
        }
        for (slope, d) in slopes.row_mut(i).iter_mut().zip(&d) {
            *slope = *d;
        }
    }
    (values, slopes)
}
