//! Test for outliers. Each value is left out in turn, to first order: r_s and χ follow the other values, the variances are estimated
//! from these, and the value is compared with their prediction. Every fit reports the result. The likelihood
//! (`evidence/deletion.rs`) repeats the test without the first-order shortcut and continues without the outlier.

use nalgebra::{DMatrix, DVector};

use super::components::Components;
use super::errors::Variance;
use crate::quantities::QUANTITIES;
use crate::student;

/// Chance that some value of a campaign without fault is called an outlier.
pub(crate) const FALSE_ALARM: f64 = 0.01;

/// A value that the others do not expect.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Unlike {
    /// X, ΔY, Δθ of the first run, of the second, …
    pub(crate) row: usize,
    /// By how many standard errors.
    pub(crate) standard_errors: f64,
    chance: f64,
}

/// The worst value, if it stands out.
pub(crate) fn worst(
    jacobian: &DMatrix<f64>,
    weights: &[f64],
    residuals: &[f64],
    within: &[Variance],
) -> Option<Unlike> {
    let is_of_run = |row: &usize| weights[*row] > 0.0 && within[*row].freedom.is_finite();
    let rows: Vec<usize> = (0..residuals.len()).filter(is_of_run).collect();
    let looks = rows.len();
    let unlike = |row: usize| unlike(jacobian, weights, residuals, within, (row, looks));
    let all = rows.into_iter().filter_map(unlike);
    let worst = all.min_by(|a, b| a.chance.total_cmp(&b.chance))?;
    (worst.chance < FALSE_ALARM).then_some(worst)
}

fn unlike(
    jacobian: &DMatrix<f64>,
    weights: &[f64],
    residuals: &[f64],
    within: &[Variance],
    (row, looks): (usize, usize),
) -> Option<Unlike> {
    let mut weights = weights.to_vec();
    weights[row] = 0.0;
    let first = Components::of(jacobian, &weights, residuals, within.to_vec())?;
    let step = &first.gain * DVector::from_column_slice(residuals);
    let left = DVector::from_column_slice(residuals) - jacobian * step;
    let others = Components::of(jacobian, &weights, left.as_slice(), within.to_vec())?;
    let gradient = jacobian.row(row);
    let expected = (gradient * others.covariance() * gradient.transpose())[(0, 0)];
    let standard_errors = left[row] / (expected + others.variance(row)).sqrt();
    Some(Unlike {
        row,
        standard_errors,
        chance: chance(&others, row, standard_errors, looks)?,
    })
}

/// Probability that the largest of this many deviations is this large.
pub(crate) fn chance(
    others: &Components,
    row: usize,
    standard_errors: f64,
    looks: usize,
) -> Option<f64> {
    // Where nothing differs from run to run, the cycles' own variances are all there is.
    let freedom = if others.between[row % QUANTITIES] > 0.0 {
        others.freedom[row % QUANTITIES]
    } else {
        others.freedom[row % QUANTITIES].min(others.within.get(row)?.freedom)
    };
    let chance = student::two_sided(freedom.max(1.0), standard_errors);
    (!chance.is_nan()).then(|| (chance * looks as f64).min(1.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_in_thirty() {
        let jacobian = DMatrix::from_fn(
            30,
            2,
            |k, j| if j == 0 { 1.0 } else { (k / QUANTITIES) as f64 },
        );
        let within = vec![
            Variance {
                value: 1e-6,
                freedom: 9.0
            };
            30
        ];
        let noise = |k: usize| 1e-3 * ((k * k * 7919) as f64).sin();
        let mut residuals: Vec<f64> = (0..30).map(noise).collect();
        assert_eq!(worst(&jacobian, &[1.0; 30], &residuals, &within), None);
        residuals[7] += 0.1;
        let found = worst(&jacobian, &[1.0; 30], &residuals, &within).unwrap();
        assert!(found.row == 7 && found.standard_errors > 20.0, "{found:?}");
    }
}
