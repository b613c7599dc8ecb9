//! Variance components. Residuals have two causes: errors within runs (`errors.rs`), and errors that all cycles of a run share and
//! the next run does not, such as drift of the fluid or a reflector that was glued on anew. The second kind has one variance for each
//! of X, ΔY, Δθ, Y and turn, by the method of moments. Both together give the uncertainty of the parameters.

use nalgebra::{DMatrix, DVector};

use super::errors::{MOST_FREEDOM, Variance};
use crate::least_squares::weighted;
use crate::quantities::QUANTITIES;

/// Variances of all residuals, and what they mean for the parameters.
#[derive(Debug, Clone)]
pub(crate) struct Components {
    /// Variance from run to run of each quantity, in the residuals' units squared.
    pub(crate) between: [f64; QUANTITIES],
    /// Degrees of freedom that each rests on.
    pub(crate) freedom: [f64; QUANTITIES],
    /// Variance of each residual within its run, in the residuals' order.
    pub(crate) within: Vec<Variance>,
    /// (JᵀWJ)⁻¹JᵀW: what each residual moves the parameters by.
    pub(crate) gain: DMatrix<f64>,
}

impl Components {
    /// From the residuals (the values of each run, then the priors) of a least-squares fit with this Jacobian and these weights.
    /// A residual of weight 0 has no influence. Returns `None` if the normal equations are singular.
    pub(crate) fn of(
        jacobian: &DMatrix<f64>,
        weights: &[f64],
        residuals: &[f64],
        within: Vec<Variance>,
    ) -> Option<Self> {
        let weighted = weighted(jacobian, weights);
        let inverse = weighted.tr_mul(jacobian).try_inverse()?;
        let gain = inverse * weighted.transpose();
        let rows = jacobian.nrows();
        let left = DMatrix::identity(rows, rows) - jacobian * &gain;
        // Contribution of the errors of one quantity to the residuals of another.
        let mut owed = DMatrix::<f64>::zeros(QUANTITIES, QUANTITIES);
        let mut sums = DVector::<f64>::zeros(QUANTITIES);
        let mut squares = [0.0; QUANTITIES];
        let mut traces = [0.0; QUANTITIES];
        let mut unknown = [false; QUANTITIES];
        for k in (0..rows).filter(|k| weights.get(*k).is_some_and(|w| *w > 0.0)) {
            let Some(q) = quantity(&within, k) else {
                continue;
            };
            squares[q] += residuals.get(k)?.powi(2);
            traces[q] += left[(k, k)];
            unknown[q] |= within.get(k).is_some_and(|within| !within.is_known());
            for (l, error) in within.iter().enumerate() {
                let share = left[(k, l)].powi(2);
                sums[q] -= share * error.value;
                if let Some(other) = quantity(&within, l) {
                    owed[(q, other)] += share;
                }
            }
        }
        for (sum, squares) in sums.iter_mut().zip(squares) {
            *sum += squares;
        }
        let freedom = std::array::from_fn(|q| (traces[q].powi(2) / owed[(q, q)]).max(1.0));
        let mut between = non_negative(&owed, &sums);
        for (q, between) in between.iter_mut().enumerate() {
            // Values without an error are as sure as they fit.
            if unknown[q] && *between <= 0.0 && traces[q] > 0.0 {
                *between = squares[q] / traces[q];
            }
        }
        Some(Self {
            between,
            freedom,
            within,
            gain,
        })
    }

    /// Returns `true` if residual `row` is a value of a run, and not a prior.
    pub(crate) fn is_of_run(&self, row: usize) -> bool {
        quantity(&self.within, row).is_some()
    }

    /// Variance of residual `row`.
    pub(crate) fn variance(&self, row: usize) -> f64 {
        let between = quantity(&self.within, row).map_or(0.0, |q| self.between[q]);
        self.within.get(row).map_or(0.0, |within| within.value) + between
    }

    /// Covariance of the parameters.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        let mut scaled = self.gain.clone();
        for (row, mut column) in scaled.column_iter_mut().enumerate() {
            column *= self.variance(row);
        }
        scaled * self.gain.transpose()
    }

    /// Correlation between the errors of two parameters.
    pub(crate) fn correlation(&self, i: usize, j: usize) -> f64 {
        let covariance = self.covariance();
        covariance[(i, j)] / (covariance[(i, i)] * covariance[(j, j)]).sqrt()
    }

    /// A parameter's variance and the degrees of freedom that it rests on (Satterthwaite).
    pub(crate) fn of_parameter(&self, parameter: usize) -> Variance {
        let (mut sum, mut uncertainty) = (0.0, 0.0);
        let mut shared = [0.0; QUANTITIES];
        for (row, within) in self.within.iter().enumerate() {
            let part = self.gain[(parameter, row)].powi(2) * self.variance(row);
            sum += part;
            match quantity(&self.within, row) {
                Some(q) if self.between[q] > 0.0 => shared[q] += part,
                _ => uncertainty += part.powi(2) / within.freedom.max(1.0),
            }
        }
        for (part, freedom) in shared.iter().zip(self.freedom) {
            uncertainty += part.powi(2) / freedom;
        }
        Variance {
            value: sum,
            freedom: if uncertainty > 0.0 {
                (sum.powi(2) / uncertainty).max(1.0)
            } else {
                MOST_FREEDOM
            },
        }
    }
}

/// Quantity of a row of the values; `None` for a prior.
fn quantity(within: &[Variance], row: usize) -> Option<usize> {
    let of_run = within.get(row).is_some_and(|v| v.freedom.is_finite());
    of_run.then_some(row % QUANTITIES)
}

/// Solves A x = b where x must not be negative: what comes out below zero is zero, and the rest is solved again.
fn non_negative(a: &DMatrix<f64>, b: &DVector<f64>) -> [f64; QUANTITIES] {
    // A quantity without residuals has no variance.
    let mut kept: Vec<usize> = (0..QUANTITIES).filter(|q| a[(*q, *q)] > 0.0).collect();
    while !kept.is_empty() {
        let matrix = DMatrix::from_fn(kept.len(), kept.len(), |i, j| a[(kept[i], kept[j])]);
        let right = DVector::from_fn(kept.len(), |i, _| b[kept[i]]);
        let Some(solution) = matrix.lu().solve(&right) else {
            break;
        };
        let least = (0..kept.len()).min_by(|i, j| solution[*i].total_cmp(&solution[*j]));
        match least {
            Some(i) if solution[i] < 0.0 => {
                kept.remove(i);
            }
            _ => {
                let mut out = [0.0; QUANTITIES];
                for (place, value) in kept.iter().zip(solution.iter()) {
                    out[*place] = *value;
                }
                return out;
            }
        }
    }
    [0.0; QUANTITIES]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_from_run_to_run_is_recovered() {
        // A straight line through twelve runs, with errors of 0.1, 0.2 and 0 from run to run.
        let jacobian = DMatrix::from_fn(60, 2, |k, j| {
            if j == 0 {
                1.0
            } else {
                (k / QUANTITIES) as f64 / 12.0
            }
        });
        let wave = |k: usize| {
            if (k / QUANTITIES).is_multiple_of(2) {
                1.0
            } else {
                -1.0
            }
        };
        let errors = DVector::from_fn(60, |k, _| {
            wave(k) * [0.1, 0.2, 0.0, 0.0, 0.0][k % QUANTITIES]
        });
        let inverse = jacobian.tr_mul(&jacobian).try_inverse().unwrap();
        let left = &errors - &jacobian * (inverse * jacobian.transpose() * &errors);
        let within = vec![
            Variance {
                value: 1e-8,
                freedom: 9.0
            };
            60
        ];
        let found = Components::of(&jacobian, &[1.0; 60], left.as_slice(), within).unwrap();
        assert!(
            (found.between[0].sqrt() / 0.1 - 1.0).abs() < 0.1,
            "{found:?}"
        );
        assert!((found.between[1].sqrt() / 0.2 - 1.0).abs() < 0.1);
        assert!(found.between[2] < 1e-4);
        assert!(
            found.freedom.iter().all(|f| (10.0..=12.0).contains(f)),
            "{:?}",
            found.freedom
        );
        // An estimate with a relative uncertainty of a third has fewer degrees of freedom than residuals.
        assert!(found.of_parameter(0).freedom < 30.0);
    }

    #[test]
    fn nothing_below_zero() {
        let a = DMatrix::identity(QUANTITIES, QUANTITIES);
        let [x, y, z, ..] = non_negative(&a, &DVector::from_vec(vec![1.0, -1.0, 2.0, 0.0, 0.0]));
        assert!((x - 1.0).abs() + y.abs() + (z - 2.0).abs() < 1e-12);
    }
}
