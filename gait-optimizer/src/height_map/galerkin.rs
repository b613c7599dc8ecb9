//! Galerkin solution for the minimum-perturbation frame in polynomials of one order: a Poisson equation for its angle, then a
//! coupled system for its position, by preconditioned conjugate gradients.

use nalgebra::{DMatrix, Vector2};
use swimmer_model::Model;

use super::space::{Field, Space, table};
use crate::batch::{Batch, Connection};

/// b_x, b_y, b_θ in products of orthonormal Legendre polynomials of Φ / D; rows run along φ₁, lengths over L.
#[derive(Debug, Clone)]
pub(super) struct Coefficients {
    pub(super) rows: [Field; 3],
}

/// Number of Gauss points beyond the order, since the connection is not a polynomial.
const MORE_POINTS: usize = 10;
/// Relative residual at which conjugate gradients stop.
const RESIDUAL: f64 = 1e-15;
/// Largest number of iterations; about twenty are needed.
const ROUNDS: usize = 200;

/// One function for each of b_x and b_y, or for each joint.
type Pair = [Field; 2];

/// Rows x, y, θ of the connection times D at the Gauss points, so that lengths and slopes are those of the square \[−1, 1\]².
type Rows = [Pair; 3];

/// Solves both problems for a swimmer with L = 1.
pub(super) fn solve(model: &Model<f64>, half_width: f64, order: usize) -> Coefficients {
    let space = Space::new(order, order + MORE_POINTS);
    let rows = rows(model, half_width, &space);
    let [t1, t2] = &rows[2];
    // Minimises ∫|a + ∇b|², without mean.
    let load = space.test(&Field::zeros(t1.nrows(), t1.ncols()), [t1, t2]);
    let theta = -divided(&space, &load, 0.0);
    let [x, y] = place(&space, &rows);
    let mut coefficients = Coefficients {
        rows: [x, y, theta].map(|row| space.in_legendre(&row)),
    };
    coefficients.vanish_at_zero();
    coefficients
}

fn rows(model: &Model<f64>, half_width: f64, space: &Space) -> Rows {
    let count = space.nodes.len();
    let zero = || [DMatrix::zeros(count, count), DMatrix::zeros(count, count)];
    let mut rows = [zero(), zero(), zero()];
    // Column-major, as matrices are stored.
    let shape = |number: usize| {
        let (s1, s2) = (space.nodes[number % count], space.nodes[number / count]);
        Vector2::new(s1, s2) * half_width
    };
    let phi = (0..count * count).map(shape);
    Batch::of(model).each(Connection, phi, |number, a| {
        for (k, row) in rows.iter_mut().enumerate() {
            for (joint, row) in row.iter_mut().enumerate() {
                row[number] = a[(k, joint)] * half_width;
            }
        }
    });
    rows
}

/// Solves (−Δ + shift) b = load. The solution for a zero shift is determined up to a constant.
fn divided(space: &Space, load: &Field, shift: f64) -> Field {
    let lambda = &space.eigenvalues;
    DMatrix::from_fn(space.order(), space.order(), |i, j| {
        let stiffness = lambda[i] + lambda[j] + shift;
        if stiffness > 0.0 {
            load[(i, j)] / stiffness
        } else {
            0.0
        }
    })
}

/// Returns b_x and b_y, which minimise ∫|a^x + ∇b_x − a^θ b_y|² + |a^y + ∇b_y + a^θ b_x|².
fn place(space: &Space, rows: &Rows) -> Pair {
    let [on_x, on_y, [t1, t2]] = rows;
    let turning = t1.component_mul(t1) + t2.component_mul(t2);
    let shift = space.mean(&turning);
    let load = adjoint(space, rows, [on_x, on_y]).map(|row| -row);
    let precondition = |r: &Pair| [divided(space, &r[0], shift), divided(space, &r[1], shift)];
    // Conjugate gradients, preconditioned.
    let mut b = [
        Field::zeros(space.order(), space.order()),
        Field::zeros(space.order(), space.order()),
    ];
    let mut residual = load;
    let mut z = precondition(&residual);
    let mut direction = z.clone();
    let mut rho = dot(&residual, &z);
    let goal = rho * RESIDUAL * RESIDUAL;
    for _ in 0..ROUNDS {
        if rho.is_nan() || rho <= goal {
            break;
        }
        let (x, y) = (space.sample(&direction[0]), space.sample(&direction[1]));
        let along_x = [0, 1].map(|k| &x.slopes[k] - rows[2][k].component_mul(&y.value));
        let along_y = [0, 1].map(|k| &y.slopes[k] + rows[2][k].component_mul(&x.value));
        let image = adjoint(space, rows, [&along_x, &along_y]);
        let step = rho / dot(&direction, &image);
        for k in 0..2 {
            b[k] += &direction[k] * step;
            residual[k] -= &image[k] * step;
        }
        z = precondition(&residual);
        let next = dot(&residual, &z);
        for k in 0..2 {
            direction[k] = &z[k] + &direction[k] * (next / rho);
        }
        rho = next;
    }
    b
}

/// Inner products of the given rows with ∇ψ + a^θ ⊗ J ψ for each pair of basis functions (ψ, 0) and (0, ψ).
fn adjoint(space: &Space, rows: &Rows, [x, y]: [&Pair; 2]) -> Pair {
    let [t1, t2] = &rows[2];
    let along = |row: &Pair| t1.component_mul(&row[0]) + t2.component_mul(&row[1]);
    [
        space.test(&along(y), [&x[0], &x[1]]),
        space.test(&-along(x), [&y[0], &y[1]]),
    ]
}

fn dot(a: &Pair, b: &Pair) -> f64 {
    a[0].dot(&b[0]) + a[1].dot(&b[1])
}

impl Coefficients {
    pub(super) fn order(&self) -> usize {
        self.rows[0].nrows()
    }

    /// Largest change from another order at 51 × 51 points, in the inner part of the square and on all of it.
    pub(super) fn change_from(&self, before: &Self) -> (f64, f64) {
        let places: Vec<f64> = (0..=50).map(|k| f64::from(k) / 25.0 - 1.0).collect();
        let (now, _) = table(&places, self.order());
        let (then, _) = table(&places, before.order());
        let is_inner = |k: usize| {
            places
                .get(k)
                .is_some_and(|s| s.abs() <= super::INNER + 1e-12)
        };
        let (mut inner, mut all) = (0.0_f64, 0.0_f64);
        for (row, old) in self.rows.iter().zip(&before.rows) {
            let change = &now * row * now.transpose() - &then * old * then.transpose();
            for (k, value) in change.iter().enumerate() {
                let (i, j) = (k % places.len(), k / places.len());
                // `max` would ignore NaN.
                let value = if value.is_nan() {
                    f64::INFINITY
                } else {
                    value.abs()
                };
                all = all.max(value);
                if is_inner(i) && is_inner(j) {
                    inner = inner.max(value);
                }
            }
        }
        (inner, all)
    }

    /// Shifts b_θ so that it vanishes at Φ = 0.
    fn vanish_at_zero(&mut self) {
        let order = self.rows[2].nrows();
        let (p, _) = table(&[0.0], order);
        let at_zero = (&p * &self.rows[2] * p.transpose())[(0, 0)];
        // The constant p₀p₀ is ½.
        self.rows[2][(0, 0)] -= 2.0 * at_zero;
    }
}
