//! Legendre–Gauss–Radau collocation on one element of unit length, for any degree.
//!
//! The element's right end is a node, its left end is none, so that the last node of an element is the first point of the
//! next (the "flipped" points; the Radau IIA method). Source: D. Garg et al., *Direct trajectory optimization and costate
//! estimation of finite-horizon and infinite-horizon optimal control problems using a Radau pseudospectral method*,
//! Comput. Optim. Appl. 49 (2011), with the barycentric differentiation matrix of J.-P. Berrut and L. N. Trefethen,
//! *Barycentric Lagrange interpolation*, SIAM Review 46 (2004).

use std::sync::LazyLock;

use nalgebra::DMatrix;

/// Highest degree in use. Above it the elements are split instead: the blocks grow with the square of the degree.
pub(crate) const HIGHEST_DEGREE: usize = 16;

/// Room for one share per point of any rule.
pub(crate) type Shares = [f64; HIGHEST_DEGREE + 1];

/// Shares before they are known.
pub(crate) const NO_SHARES: Shares = [0.0; HIGHEST_DEGREE + 1];

static RULES: LazyLock<Vec<Rule>> =
    LazyLock::new(|| (1..=HIGHEST_DEGREE).map(Rule::of_degree).collect());

/// The rule of a degree d: a polynomial of degree d through d + 1 points, collocated at the last d of them.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Rule {
    pub(crate) degree: usize,
    /// The d + 1 points: 0, then the nodes, the last of them 1.
    pub(crate) points: Vec<f64>,
    /// Slope at node j (row j − 1) per value at point i (column i).
    differentiation: Vec<f64>,
    /// Integral from 0 to node j (row j − 1) per value at node i (column i − 1).
    integration: Vec<f64>,
    /// Of the barycentric interpolation through all d + 1 points.
    barycentric: Vec<f64>,
}

/// The rule of a degree, which is brought between 1 and [`HIGHEST_DEGREE`].
pub(crate) fn rule(degree: usize) -> &'static Rule {
    &RULES[degree.clamp(1, HIGHEST_DEGREE) - 1]
}

impl Rule {
    fn of_degree(degree: usize) -> Self {
        let mut points = vec![0.0];
        points.extend((0..degree).rev().map(|i| 0.5 * (1.0 + node(degree, i))));
        let barycentric: Vec<f64> = (0..=degree)
            .map(|i| {
                let apart = |r: &usize| *r != i;
                1.0 / (0..=degree)
                    .filter(apart)
                    .map(|r| points[i] - points[r])
                    .product::<f64>()
            })
            .collect();
        let mut differentiation = vec![0.0; degree * (degree + 1)];
        for j in 1..=degree {
            let row = &mut differentiation[(j - 1) * (degree + 1)..j * (degree + 1)];
            for i in (0..=degree).filter(|&i| i != j) {
                row[i] = barycentric[i] / barycentric[j] / (points[j] - points[i]);
            }
            // A constant has no slope.
            row[j] = -row.iter().sum::<f64>();
        }
        // Over the nodes alone differentiation is the inverse of integration from 0.
        let square = DMatrix::from_fn(degree, degree, |j, i| {
            differentiation[j * (degree + 1) + i + 1]
        });
        let inverse = square
            .try_inverse()
            .unwrap_or_else(|| DMatrix::zeros(degree, degree));
        let integration = (0..degree * degree)
            .map(|k| inverse[(k / degree, k % degree)])
            .collect();
        Self {
            degree,
            points,
            differentiation,
            integration,
            barycentric,
        }
    }

    /// Slope at node j = 1, …, d per value at each of the d + 1 points.
    pub(crate) fn slope(&self, j: usize) -> &[f64] {
        &self.differentiation[(j - 1) * (self.degree + 1)..j * (self.degree + 1)]
    }

    /// Integral from 0 to node j = 1, …, d per value at each node.
    pub(crate) fn integral(&self, j: usize) -> &[f64] {
        &self.integration[(j - 1) * self.degree..j * self.degree]
    }

    /// Quadrature weights of the d nodes over the whole element.
    pub(crate) fn weights(&self) -> &[f64] {
        self.integral(self.degree)
    }

    /// What each of the d + 1 points counts in the value at `tau`; written to the first d + 1 places of `shares`.
    pub(crate) fn shares(&self, tau: f64, shares: &mut Shares) {
        self.barycentric_shares(tau, shares, |weight, _| weight);
    }

    /// The same for a polynomial of degree d − 1 through the nodes alone, such as the rate; the first point counts nothing.
    pub(crate) fn rate_shares(&self, tau: f64, shares: &mut Shares) {
        self.barycentric_shares(tau, shares, |weight, point| weight * point);
    }

    fn barycentric_shares(&self, tau: f64, shares: &mut Shares, weigh: impl Fn(f64, f64) -> f64) {
        shares.fill(0.0);
        let mut sum = 0.0;
        for (i, (&weight, &point)) in self.barycentric.iter().zip(&self.points).enumerate() {
            let weight = weigh(weight, point);
            if weight != 0.0 && (tau - point).abs() < 1e-15 {
                shares.fill(0.0);
                shares[i] = 1.0;
                return;
            }
            if weight != 0.0 {
                shares[i] = weight / (tau - point);
                sum += shares[i];
            }
        }
        for share in shares {
            *share /= sum;
        }
    }
}

/// Zero i of `P_d − P_{d−1}` on \[−1, 1\], from the right; the first is 1. Newton's method from the Chebyshev–Radau points.
fn node(degree: usize, i: usize) -> f64 {
    if i == 0 {
        return 1.0;
    }
    let mut x = (std::f64::consts::TAU * i as f64 / (2 * degree - 1) as f64).cos();
    for _ in 0..20 {
        let (mut before, mut here) = (1.0, x);
        let (mut slope_before, mut slope) = (0.0, 1.0);
        for n in 1..degree {
            let n = n as f64;
            let next = ((2.0 * n + 1.0) * x * here - n * before) / (n + 1.0);
            let next_slope = slope_before + (2.0 * n + 1.0) * here;
            (before, here) = (here, next);
            (slope_before, slope) = (slope, next_slope);
        }
        let step = (here - before) / (slope - slope_before);
        x -= step;
        if step.abs() < 1e-16 {
            break;
        }
    }
    x
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_known_nodes_of_degree_three() {
        // Radau IIA of order 5: (4 ∓ √6)/10 and 1.
        let points = &rule(3).points;
        let root = 6.0_f64.sqrt();
        for (point, known) in
            points
                .iter()
                .zip([0.0, (4.0 - root) / 10.0, (4.0 + root) / 10.0, 1.0])
        {
            assert!((point - known).abs() < 1e-15, "{points:?}");
        }
        let weights = rule(3).weights();
        assert!((weights[2] - 1.0 / 9.0).abs() < 1e-15, "{weights:?}");
    }

    /// Slopes are exact to degree d, quadrature to degree 2d − 2.
    #[test]
    fn polynomials_are_exact() {
        for degree in 1..=HIGHEST_DEGREE {
            let rule = rule(degree);
            let power = i32::try_from(degree).unwrap();
            for j in 1..=degree {
                let slope: f64 = rule
                    .slope(j)
                    .iter()
                    .zip(&rule.points)
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
                    .zip(&rule.points[1..])
                    .map(|(weight, point)| weight * point.powi(power))
                    .sum::<f64>()
            };
            let best = 2 * power - 2;
            assert!((integral(best) - 1.0 / f64::from(best + 1)).abs() < 1e-13);
            // One degree more is not exact.
            assert!((integral(best + 1) - 1.0 / f64::from(best + 2)).abs() > 1e-22);
        }
    }

    #[test]
    fn interpolation_runs_through_the_points() {
        let mut shares = NO_SHARES;
        let rule = rule(7);
        rule.shares(0.3, &mut shares);
        let value: f64 = shares
            .iter()
            .zip(&rule.points)
            .map(|(share, point)| share * point.powi(7))
            .sum();
        assert!((value - 0.3_f64.powi(7)).abs() < 1e-14);
        rule.shares(rule.points[4], &mut shares);
        assert!((shares[4] - 1.0).abs() < 1e-15 && shares[3].abs() < 1e-15);
    }
}
