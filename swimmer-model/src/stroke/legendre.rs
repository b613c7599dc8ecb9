//! Polynomials on a panel: Gauss–Legendre nodes, Legendre series through values at the nodes, their exact integrals.

use crate::Scalar;

/// Most nodes of a panel. A rule of N nodes integrates polynomials of degree 2N − 1 exactly.
pub(super) const N: usize = 12;

/// A rule of M nodes, M even and at most [`N`].
pub(super) struct Rule<const M: usize>;

/// The positive roots of P₈ and P₁₂ to six digits; Newton's method does the rest when the crate is compiled.
const ROOTS_8: [f64; 4] = [0.183_435, 0.525_532, 0.796_666, 0.960_290];
const ROOTS_12: [f64; 6] = [
    0.125_233, 0.367_831, 0.587_318, 0.769_903, 0.904_117, 0.981_561,
];

const fn near_root(nodes: usize, i: usize) -> f64 {
    if nodes == 8 { ROOTS_8[i] } else { ROOTS_12[i] }
}

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

/// P′_M(x).
const fn slope(m: usize, x: f64) -> f64 {
    let p = legendre(x);
    m as f64 * (p[m - 1] - x * p[m]) / (1.0 - x * x)
}

impl<const M: usize> Rule<M> {
    /// Nodes on [−1, 1], increasing.
    pub(super) const NODES: [f64; M] = {
        let mut nodes = [0.0; M];
        let mut i = 0;
        while i < M / 2 {
            let mut x = near_root(M, i);
            let mut step = 0;
            while step < 4 {
                x -= legendre(x)[M] / slope(M, x);
                step += 1;
            }
            nodes[M / 2 + i] = x;
            nodes[M / 2 - 1 - i] = -x;
            i += 1;
        }
        nodes
    };

    /// Row k turns values at the nodes into the coefficient of P_k.
    const PROJECT: [[f64; M]; M] = {
        let mut rows = [[0.0; M]; M];
        let mut j = 0;
        while j < M {
            let x = Self::NODES[j];
            let p = legendre(x);
            let weight = 2.0 / ((1.0 - x * x) * slope(M, x) * slope(M, x));
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

    /// Whether it has the same sign all over [−1, 1] for certain.
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
