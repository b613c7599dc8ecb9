//! Gauss–Legendre quadrature on \[−1, 1\], its nodes and weights computed by the compiler.

/// Rule of `N` nodes, exact for polynomials up to degree 2N − 1.
///
/// ```
/// use swimmer_model::GaussLegendre;
///
/// let rule = GaussLegendre::<3>::NODES.iter().zip(GaussLegendre::<3>::WEIGHTS);
/// let integral: f64 = rule.map(|(x, weight)| weight * x.powi(4)).sum();
/// assert!((integral - 2.0 / 5.0).abs() < 1e-15);
/// ```
#[derive(Debug, Clone, Copy)]
pub struct GaussLegendre<const N: usize>;

impl<const N: usize> GaussLegendre<N> {
    /// Nodes, increasing.
    pub const NODES: [f64; N] = {
        let mut nodes = [0.0; N];
        let mut i = 0;
        while i < N / 2 {
            let mut x = near_root(N, i);
            // Newton's method doubles the digits; the start has two or more.
            let mut step = 0;
            while step < 6 {
                x -= legendre(N, x)[0] / slope(N, x);
                step += 1;
            }
            nodes[N - 1 - i] = x;
            nodes[i] = -x;
            i += 1;
        }
        nodes
    };

    /// Weights of the nodes.
    pub const WEIGHTS: [f64; N] = {
        let mut weights = [0.0; N];
        let mut i = 0;
        while i < N {
            let x = Self::NODES[i];
            let slope = slope(N, x);
            weights[i] = 2.0 / ((1.0 - x * x) * slope * slope);
            i += 1;
        }
        weights
    };
}

/// Tricomi's estimate of the i-th largest root of `P_n`.
const fn near_root(n: usize, i: usize) -> f64 {
    cosine((i as f64 + 0.75) / (n as f64 + 0.5) * core::f64::consts::PI)
}

/// Cosine of an angle from 0 to π/2, to 1e-6.
const fn cosine(angle: f64) -> f64 {
    let square = angle * angle;
    let (mut sum, mut term) = (1.0, 1.0);
    let mut k = 0.0;
    while k < 10.0 {
        term *= -square / ((k + 1.0) * (k + 2.0));
        sum += term;
        k += 2.0;
    }
    sum
}

/// `P_n(x)` and `P_{n−1}(x)`.
const fn legendre(n: usize, x: f64) -> [f64; 2] {
    let (mut below, mut here) = (0.0, 1.0);
    let mut k = 0;
    while k < n {
        let order = k as f64;
        (below, here) = (
            here,
            ((2.0 * order + 1.0) * x * here - order * below) / (order + 1.0),
        );
        k += 1;
    }
    [here, below]
}

/// `P′_n(x)`, inside the interval.
const fn slope(n: usize, x: f64) -> f64 {
    let [here, below] = legendre(n, x);
    n as f64 * (below - x * here) / (1.0 - x * x)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A rule of N nodes is the only one that integrates all 2N monomials below degree 2N.
    fn is_exact<const N: usize>() {
        let (nodes, weights) = (GaussLegendre::<N>::NODES, GaussLegendre::<N>::WEIGHTS);
        for degree in 0..2 * i32::try_from(N).unwrap() {
            let sum: f64 = nodes
                .iter()
                .zip(weights)
                .map(|(x, w)| w * x.powi(degree))
                .sum();
            let exact = if degree % 2 == 0 {
                2.0 / f64::from(degree + 1)
            } else {
                0.0
            };
            assert!(
                (sum - exact).abs() < 1e-14,
                "{N} nodes, degree {degree}: {sum}"
            );
        }
        assert!(nodes.is_sorted() && nodes.iter().all(|x| x.abs() < 1.0));
    }

    #[test]
    fn every_rule_is_exact() {
        is_exact::<1>();
        is_exact::<2>();
        is_exact::<3>();
        is_exact::<4>();
        is_exact::<5>();
        is_exact::<8>();
        is_exact::<12>();
        is_exact::<20>();
    }
}
