//! One step of Newton's method on a stationary point under equations.

use nalgebra::{DMatrix, DVector};

/// The step, and the multipliers after it: `H dz + F y = −gradient`, `J dz = −values`, F being what each multiplier weighs in the
/// stationarity, as a rule Jᵀ; none where that has no finite solution.
pub(super) fn step(
    (hessian, gradient): (&DMatrix<f64>, &DVector<f64>),
    forces: &DMatrix<f64>,
    (slopes, values): (&DMatrix<f64>, &DVector<f64>),
) -> Option<(DVector<f64>, DVector<f64>)> {
    let (size, count) = (gradient.len(), values.len());
    let mut matrix = DMatrix::zeros(size + count, size + count);
    matrix.view_mut((0, 0), (size, size)).copy_from(hessian);
    matrix.view_mut((size, 0), (count, size)).copy_from(slopes);
    matrix.view_mut((0, size), (size, count)).copy_from(forces);
    let mut right = DVector::zeros(size + count);
    right.rows_mut(0, size).copy_from(&-gradient);
    right.rows_mut(size, count).copy_from(&-values);
    let all = matrix.lu().solve(&right)?;
    let finite = all.iter().all(|value| value.is_finite());
    finite.then(|| {
        let (step, multipliers) = (all.rows(0, size), all.rows(size, count));
        (step.into_owned(), multipliers.into_owned())
    })
}
