//! What a fit leaves has two causes: errors within runs (`errors.rs`), and something that all cycles of a run share and the next
//! run does not: the fluid drifted, a reflector was glued on anew. For the second there is one variance for each of X, ΔY and
//! Δθ, by the method of moments. Both together say how sure the parameters are.

use nalgebra::{DMatrix, DVector};

use super::errors::{MOST_FREEDOM, Variance};

/// Variances of all residuals, and what they mean for the parameters.
#[derive(Debug, Clone)]
pub(crate) struct Components {
    /// Variance from run to run of X, ΔY, Δθ, in the residuals' units squared.
    pub(crate) between: [f64; 3],
    /// Degrees of freedom that each rests on.
    pub(crate) freedom: [f64; 3],
    /// Variance of each residual within its run, in the residuals' order.
    pub(crate) within: Vec<Variance>,
    /// (JᵀWJ)⁻¹JᵀW: what each residual moves the parameters by.
    pub(crate) gain: DMatrix<f64>,
}

impl Components {
    /// From the residuals (X, ΔY, Δθ of each run) of a least-squares fit with this Jacobian and these weights; `None` where
    /// it is singular. A residual without weight says nothing.
    pub(crate) fn of(
        jacobian: &DMatrix<f64>,
        weights: &[f64],
        residuals: &[f64],
        within: Vec<Variance>,
    ) -> Option<Self> {
        let mut weighted = jacobian.clone();
        for (mut row, weight) in weighted.row_iter_mut().zip(weights) {
            row *= *weight;
        }
        let inverse = weighted.tr_mul(jacobian).try_inverse()?;
        let gain = inverse * weighted.transpose();
        let rows = jacobian.nrows();
        let left = DMatrix::identity(rows, rows) - jacobian * &gain;
        // What residuals of one quantity owe to the errors of another.
        let mut owed = DMatrix::<f64>::zeros(3, 3);
        let mut sums = DVector::<f64>::zeros(3);
        let mut traces = [0.0; 3];
        for k in (0..rows).filter(|k| weights.get(*k).is_some_and(|w| *w > 0.0)) {
            sums[k % 3] += residuals.get(k)?.powi(2);
            traces[k % 3] += left[(k, k)];
            for (l, within) in within.iter().enumerate() {
                let share = left[(k, l)].powi(2);
                owed[(k % 3, l % 3)] += share;
                sums[k % 3] -= share * within.value;
            }
        }
        let freedom = [0, 1, 2].map(|q| (traces[q].powi(2) / owed[(q, q)]).max(1.0));
        Some(Self {
            between: non_negative(&owed, &sums),
            freedom,
            within,
            gain,
        })
    }

    /// Variance of residual `row`.
    pub(crate) fn variance(&self, row: usize) -> f64 {
        self.within.get(row).map_or(0.0, |within| within.value) + self.between[row % 3]
    }

    /// Covariance of the parameters.
    pub(crate) fn covariance(&self) -> DMatrix<f64> {
        let mut scaled = self.gain.clone();
        for (row, mut column) in scaled.column_iter_mut().enumerate() {
            column *= self.variance(row);
        }
        scaled * self.gain.transpose()
    }

    /// A parameter's variance and the degrees of freedom that it rests on (Satterthwaite).
    pub(crate) fn of_parameter(&self, parameter: usize) -> Variance {
        let (mut sum, mut uncertainty) = (0.0, 0.0);
        let mut shared = [0.0; 3];
        for (row, within) in self.within.iter().enumerate() {
            let part = self.gain[(parameter, row)].powi(2) * self.variance(row);
            sum += part;
            if self.between[row % 3] > 0.0 {
                shared[row % 3] += part;
            } else {
                uncertainty += part.powi(2) / within.freedom.max(1.0);
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

/// Solves A x = b where x must not be negative: what comes out below zero is zero, and the rest is solved again.
fn non_negative(a: &DMatrix<f64>, b: &DVector<f64>) -> [f64; 3] {
    let mut kept = vec![0, 1, 2];
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
                let mut out = [0.0; 3];
                for (place, value) in kept.iter().zip(solution.iter()) {
                    out[*place] = *value;
                }
                return out;
            }
        }
    }
    [0.0; 3]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_variance_from_run_to_run_is_recovered() {
        // A straight line through twelve runs, with errors of 0.1, 0.2 and 0 from run to run.
        let jacobian = DMatrix::from_fn(
            36,
            2,
            |k, j| if j == 0 { 1.0 } else { (k / 3) as f64 / 12.0 },
        );
        let wave = |k: usize| if (k / 3).is_multiple_of(2) { 1.0 } else { -1.0 };
        let errors = DVector::from_fn(36, |k, _| wave(k) * [0.1, 0.2, 0.0][k % 3]);
        let inverse = jacobian.tr_mul(&jacobian).try_inverse().unwrap();
        let left = &errors - &jacobian * (inverse * jacobian.transpose() * &errors);
        let within = vec![
            Variance {
                value: 1e-8,
                freedom: 9.0
            };
            36
        ];
        let found = Components::of(&jacobian, &[1.0; 36], left.as_slice(), within).unwrap();
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
        // What is certain to a third is not certain at all: fewer degrees of freedom than residuals.
        assert!(found.of_parameter(0).freedom < 30.0);
    }

    #[test]
    fn nothing_below_zero() {
        let a = DMatrix::identity(3, 3);
        let [x, y, z] = non_negative(&a, &DVector::from_vec(vec![1.0, -1.0, 2.0]));
        assert!((x - 1.0).abs() + y.abs() + (z - 2.0).abs() < 1e-12);
    }
}
