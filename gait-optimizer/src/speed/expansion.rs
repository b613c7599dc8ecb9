//! Second-order expansion of ln(period / measure) about a chain under constraints, and the Newton step from there.

use nalgebra::{DMatrix, DVector};

use super::chain::{self, Layout, Net};
use super::ensemble;
use super::quadrature::Rule;
use super::setting::Setting;

/// Expansion of the objective to second order and of the constraints to first order.
pub(super) struct Expansion {
    pub(super) net: Net,
    /// Gradient of the objective.
    pub(super) gradient: DVector<f64>,
    /// Residuals of the constraints, those on the whole chain first.
    pub(super) values: DVector<f64>,
    pub(super) slopes: DMatrix<f64>,
    /// Second derivatives of the Lagrangian, or the identity if its multipliers are unknown.
    pub(super) hessian: DMatrix<f64>,
}

impl Expansion {
    /// Expansion with the constraints on the whole chain and space for `more` further ones. Returns `None` if the net motion is zero.
    pub(super) fn new(
        setting: &Setting,
        (layout, rule): (&Layout, &Rule),
        (z, y): (&DVector<f64>, Option<&DVector<f64>>),
        more: usize,
    ) -> Option<Self> {
        let jets = layout.jets(setting.model, rule, z);
        let (net, equalities, equality_slopes) = setting.equalities(layout, &jets, z);
        let measure = setting.measure(&net);
        if !measure.is_finite() || measure < setting.least_measure() {
            return None;
        }
        let (_, mut gradient) = chain::gradient(layout, &jets, z, setting.weights(&net, None));
        let (slope, bend) = ensemble::expansion((layout, rule), z, setting.members);
        gradient += slope;
        for index in layout.times() {
            gradient[index] += 1.0 / layout.period(z);
        }
        let count = equalities.len() + more;
        let mut values = DVector::zeros(count);
        let mut slopes = DMatrix::zeros(count, layout.size);
        for (row, (value, slope)) in equalities.iter().zip(&equality_slopes).enumerate() {
            values[row] = *value;
            slopes.set_row(row, &slope.transpose());
        }
        let hessian = match y {
            Some(y) => {
                let of = (layout, rule, jets.as_slice());
                setting.hessian(of, z, (&net, y.as_slice())) + bend
            }
            None => DMatrix::identity(layout.size, layout.size),
        };
        Some(Self {
            net,
            gradient,
            values,
            slopes,
            hessian,
        })
    }

    /// Residual of the stationarity conditions; the slopes are those over angles of a scale \[rad\].
    pub(super) fn residual(&self, y: &DVector<f64>, scale: f64) -> f64 {
        let pull = self.slopes.tr_mul(y);
        let slope = (&self.gradient + pull).amax() * scale;
        slope.max(self.values.amax())
    }

    /// The step, and the multipliers after it: `H dz + Jᵀ y = −gradient`, `J dz = −values`; `None` if that has no finite
    /// solution.
    pub(super) fn step(&self) -> Option<(DVector<f64>, DVector<f64>)> {
        let (size, count) = (self.gradient.len(), self.values.len());
        let mut matrix = DMatrix::zeros(size + count, size + count);
        let mut put = |at, shape, part: &DMatrix<f64>| matrix.view_mut(at, shape).copy_from(part);
        put((0, 0), (size, size), &self.hessian);
        put((size, 0), (count, size), &self.slopes);
        put((0, size), (size, count), &self.slopes.transpose());
        let mut right = DVector::zeros(size + count);
        right.rows_mut(0, size).copy_from(&-&self.gradient);
        right.rows_mut(size, count).copy_from(&-&self.values);
        let all = matrix.lu().solve(&right)?;
        let finite = all.iter().all(|value| value.is_finite());
        finite.then(|| {
            let (step, multipliers) = (all.rows(0, size), all.rows(size, count));
            (step.into_owned(), multipliers.into_owned())
        })
    }

    /// Least-squares multipliers.
    pub(super) fn nearest_multipliers(&self) -> Option<DVector<f64>> {
        let svd = self.slopes.transpose().svd(true, true);
        svd.solve(&-&self.gradient, 1e-12).ok()
    }

    /// Smallest eigenvalue of the reduced Hessian (second variation on the constraints' tangent space), and its eigenvector.
    pub(super) fn convexity(&self) -> (f64, DVector<f64>) {
        let size = self.gradient.len();
        // Orthonormal basis of the tangent space: the null space of the constraints' gradients.
        let qr = self.slopes.transpose().qr();
        let q = qr.q();
        let projector = DMatrix::identity(size, size) - &q * q.transpose();
        let eigen = projector.symmetric_eigen();
        let free: Vec<usize> = (0..size).filter(|&k| eigen.eigenvalues[k] > 0.5).collect();
        if free.is_empty() {
            return (f64::INFINITY, DVector::zeros(size));
        }
        let basis = DMatrix::from_fn(size, free.len(), |i, j| eigen.eigenvectors[(i, free[j])]);
        let reduced = basis.tr_mul(&(&self.hessian * &basis));
        let eigen = reduced.symmetric_eigen();
        let (least, value) = eigen.eigenvalues.argmin();
        (value, basis * eigen.eigenvectors.column(least))
    }
}
