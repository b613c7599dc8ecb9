//! Legendre–Gauss–Radau collocation on one element of unit length.
//!
//! The right end of the element is a node, the left end is not, so the last node of an element is the first point of the next
//! (the "flipped" points; the Radau IIA method). Source: D. Garg et al., *Direct trajectory optimization and costate
//! estimation of finite-horizon and infinite-horizon optimal control problems using a Radau pseudospectral method*,
//! Comput. Optim. Appl. 49 (2011), with the barycentric differentiation matrix of J.-P. Berrut and L. N. Trefethen,
//! *Barycentric Lagrange interpolation*, SIAM Review 46 (2004).

use nalgebra::{DMatrix, DVector, DVectorView};

/// Highest supported degree; more elements are more accurate than higher degrees.
pub(crate) const HIGHEST_DEGREE: usize = 16;

/// Collocation rule of degree d: a polynomial of degree d through d + 1 points, collocated at the last d of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rule {
    /// The d + 1 points: 0, then the nodes, the last of which is 1.
    pub(crate) points: DVector<f64>,
    /// Differentiation matrix: slope at each node (column) per value at each point (row).
    pub(crate) slopes: DMatrix<f64>,
    /// Integration matrix: integral from 0 to each node (column) per value at each node (row).
    pub(crate) integrals: DMatrix<f64>,
}

impl Rule {
    /// Returns the rule of a degree, clamped to 1 … [`HIGHEST_DEGREE`].
    pub(crate) fn new(degree: usize) -> Self {
        let degree = degree.clamp(1, HIGHEST_DEGREE);
        let points = points(degree);
        let barycentric = DVector::from_fn(degree + 1, |i, _| {
            let others = (0..=degree).filter(|&other| other != i);
            1.0 / others
                .map(|other| points[i] - points[other])
                .product::<f64>()
        });
        let mut slopes = DMatrix::from_fn(degree + 1, degree, |i, j| {
            if i == j + 1 {
                return 0.0;
            }
            barycentric[i] / barycentric[j + 1] / (points[j + 1] - points[i])
        });
        for j in 0..degree {
            // The slope of a constant is zero.
            slopes[(j + 1, j)] = -slopes.column(j).sum();
        }
        // On the nodes alone, integration from 0 is the inverse of differentiation.
        let integrals = slopes.rows(1, degree).into_owned().try_inverse();
        Self {
            integrals: integrals.unwrap_or_else(|| DMatrix::zeros(degree, degree)),
            points,
            slopes,
        }
    }

    pub(crate) fn degree(&self) -> usize {
        self.integrals.nrows()
    }

    /// Quadrature weights of the d nodes on the element.
    pub(crate) fn weights(&self) -> DVectorView<'_, f64> {
        self.integrals.column(self.degree() - 1)
    }

    /// Values of the d + 1 Lagrange polynomials at `tau`.
    pub(crate) fn shares(&self, tau: f64) -> DVector<f64> {
        let points = &self.points;
        DVector::from_fn(points.len(), |i, _| {
            let others = (0..points.len()).filter(|&other| other != i);
            let products = others.fold([1.0; 2], |[above, below], other| {
                [
                    above * (tau - points[other]),
                    below * (points[i] - points[other]),
                ]
            });
            products[0] / products[1]
        })
    }
}

/// Returns 0 and the zeros of `P_d − P_{d−1}`, mapped from \[−1, 1\] to \[0, 1\]. They are the eigenvalues of the Jacobi matrix of
/// the Legendre polynomials with its last entry modified so that 1 is an eigenvalue (G. H. Golub, *Some modified matrix
/// eigenvalue problems*, SIAM Review 15 (1973)).
fn points(degree: usize) -> DVector<f64> {
    let d = degree as f64;
    let mut jacobi = DMatrix::zeros(degree, degree);
    for i in 1..degree {
        let k = i as f64;
        jacobi[(i, i - 1)] = k / (4.0 * k * k - 1.0).sqrt();
        jacobi[(i - 1, i)] = jacobi[(i, i - 1)];
    }
    jacobi[(degree - 1, degree - 1)] = d / (2.0 * d - 1.0);
    let mut points: Vec<f64> = jacobi
        .symmetric_eigenvalues()
        .iter()
        .map(|x| 0.5 * (1.0 + x))
        .collect();
    points.push(0.0);
    points.sort_by(f64::total_cmp);
    points[degree] = 1.0;
    points.into()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_nodes_of_degree_three() {
        // Radau IIA of order 5: (4 ∓ √6)/10 and 1.
        let rule = Rule::new(3);
        let points = &rule.points;
        let root = 6.0_f64.sqrt();
        for (point, known) in
            points
                .iter()
                .zip([0.0, (4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0])
        {
            assert!((point - known).abs() < 1e-15, "{points:?}");
        }
        let weights = rule.weights();
        assert!((weights[2] - 1.0 / 9.0).abs() < 1e-15, "{weights:?}");
    }

    /// Slopes are exact to degree d, quadrature to degree 2d − 2.
    #[test]
    fn polynomials_are_exact() {
        for degree in 1..=HIGHEST_DEGREE {
            let rule = Rule::new(degree);
            let power = i32::try_from(degree).unwrap();
            for j in 1..=degree {
                let slope: f64 = rule
                    .slopes
                    .column(j - 1)
                    .iter()
                    .zip(rule.points.iter())
                    .map(|(share, point)| share * point.powi(power))
                    .sum();
                let exact = f64::from(power) * rule.points[j].powi(power - 1);
                assert!(
                    (slope - exact).abs() < 1e-11,
                    "degree {degree}: {slope} {exact}"
                );
            }
            let integral = |power: i32| {
                rule.weights()
                    .iter()
                    .zip(rule.points.iter().skip(1))
                    .map(|(weight, point)| weight * point.powi(power))
                    .sum::<f64>()
            };
            let best = 2 * power - 2;
            assert!((integral(best) - 1.0 / f64::from(best + 1)).abs() < 1e-13);
            // The next degree is not exact.
            assert!((integral(best + 1) - 1.0 / f64::from(best + 2)).abs() > 1e-22);
        }
    }

    #[test]
    fn interpolation_runs_through_the_points() {
        let rule = Rule::new(7);
        let shares = rule.shares(0.3);
        let value: f64 = shares
            .iter()
            .zip(rule.points.iter())
            .map(|(share, point)| share * point.powi(7))
            .sum();
        assert!((value - 0.3_f64.powi(7)).abs() < 1e-14);
        let shares = rule.shares(rule.points[4]);
        assert!((shares[4] - 1.0).abs() < 1e-15 && shares[3].abs() < 1e-15);
    }
}
