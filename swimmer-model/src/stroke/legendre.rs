//! Polynomials on a panel: Legendre series through values at Gauss–Legendre nodes, and their exact integrals.

use crate::{GaussLegendre, Scalar};

/// Most nodes of a panel. A rule of N nodes integrates polynomials of degree 2N − 1 exactly.
pub(super) const N: usize = 12;

/// A rule of M nodes, at most [`N`].
pub(super) struct Rule<const M: usize>;

/// P₀(x) … P_N(x).
const fn legendre(x: f64) -> [f64; N + 1] {
    let mut p = [1.0; N + 1];
    p[1] = x;
    let mut k = 1;
    while k < N {
        let order = k as f64;
        p[k + 1] = ((2.0 * order + 1.0) * x * p[k] - order * p[k - 1]) / (order + 1.0);
        k += 1;
    }
    p
}

impl<const M: usize> Rule<M> {
    /// Nodes on [−1, 1], increasing.
    pub(super) const NODES: [f64; M] = GaussLegendre::<M>::NODES;

    /// Row k turns values at the nodes into the coefficient of P_k.
    const PROJECT: [[f64; M]; M] = {
        let mut rows = [[0.0; M]; M];
        let mut j = 0;
        while j < M {
            let p = legendre(Self::NODES[j]);
            let weight = GaussLegendre::<M>::WEIGHTS[j];
            let mut k = 0;
            while k < M {
                rows[k][j] = (k as f64 + 0.5) * weight * p[k];
                k += 1;
            }
            j += 1;
        }
        rows
    };

    /// Row j holds the integrals of P₀ … P_{M−1} from −1 to node j.
    const INTEGRATE: [[f64; M]; M] = {
        let mut rows = [[0.0; M]; M];
        let mut j = 0;
        while j < M {
            let p = legendre(Self::NODES[j]);
            rows[j][0] = Self::NODES[j] + 1.0;
            let mut k = 1;
            while k < M {
                rows[j][k] = (p[k + 1] - p[k - 1]) / (2.0 * k as f64 + 1.0);
                k += 1;
            }
            j += 1;
        }
        rows
    };
}

/// A polynomial of degree N − 1 or less on [−1, 1] by its Legendre coefficients.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Series<T>([T; N]);

impl<T: Scalar> Series<T> {
    /// The polynomial that takes these values at a rule's nodes.
    #[inline]
    pub(super) fn through<const M: usize>(values: &[T; M]) -> Self {
        let mut coefficients = [T::zero(); N];
        for (coefficient, row) in coefficients.iter_mut().zip(&Rule::<M>::PROJECT) {
            *coefficient = dot(row, values);
        }
        Self(coefficients)
    }

    /// Its integrals from −1 to each node of the rule that it was drawn by.
    #[inline]
    pub(super) fn integrals_at_nodes<const M: usize>(&self) -> [T; M] {
        core::array::from_fn(|j| dot(&Rule::<M>::INTEGRATE[j], &self.0))
    }

    /// Size of the last two coefficients of a rule: how well the polynomial resolves what it was drawn through.
    pub(super) fn tail<const M: usize>(&self) -> T {
        self.0[M - 1].abs().max(self.0[M - 2].abs())
    }

    /// `true` if it provably has the same sign on all of [−1, 1].
    pub(super) fn keeps_its_sign(&self) -> bool {
        let [mean, rest @ ..] = &self.0;
        let rest = rest.iter().fold(T::zero(), |sum, c| sum + c.abs());
        mean.abs() > rest
    }

    /// Integral over [−1, 1].
    pub(super) fn whole_integral(&self) -> T {
        self.0[0] + self.0[0]
    }

    /// Value at s.
    pub(super) fn value(&self, s: T) -> T {
        let p = polynomials(s);
        (0..N).fold(T::zero(), |sum, k| sum + self.0[k] * p[k])
    }

    /// Derivative at s.
    pub(super) fn derivative(&self, s: T) -> T {
        // P′_{k+1} = P′_{k−1} + (2k + 1) P_k
        let p = polynomials(s);
        let (mut before, mut here) = (T::zero(), T::one());
        let mut sum = self.0[1];
        for k in 2..N {
            let next = before + T::from_f64(2.0 * k as f64 - 1.0) * p[k - 1];
            sum += self.0[k] * next;
            (before, here) = (here, next);
        }
        sum
    }

    /// Integral from −1 to s.
    pub(super) fn integral(&self, s: T) -> T {
        let p = polynomials(s);
        (1..N).fold(self.0[0] * (s + T::one()), |sum, k| {
            sum + self.0[k] * (p[k + 1] - p[k - 1]) / T::from_f64(2.0 * k as f64 + 1.0)
        })
    }
}

#[inline]
fn dot<T: Scalar>(row: &[f64], values: &[T]) -> T {
    row.iter()
        .zip(values)
        .fold(T::zero(), |sum, (&a, &b)| sum + T::from_f64(a) * b)
}

fn polynomials<T: Scalar>(s: T) -> [T; N + 1] {
    let mut p = [T::one(); N + 1];
    p[1] = s;
    for k in 1..N {
        let order = k as f64;
        let (a, b) = (
            T::from_f64((2.0 * order + 1.0) / (order + 1.0)),
            T::from_f64(order / (order + 1.0)),
        );
        p[k + 1] = a * s * p[k] - b * p[k - 1];
    }
    p
}
