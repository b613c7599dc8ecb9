//! Least squares within bounds: the one minimiser of this crate, for the model itself and for polynomials through it.

use nalgebra::{DMatrix, DVector};

/// Steps of one minimisation.
const STEPS: usize = 60;
/// Parameters are of order one: what moves less stands still.
const STILL: f64 = 1e-10;

/// Model that predicts measured values from parameters.
pub(crate) trait Model {
    /// Least and largest value of each parameter.
    fn bounds(&self) -> Vec<(f64, f64)>;

    /// All values; `None` if the model has none there.
    fn values(&self, at: &[f64]) -> Option<Vec<f64>>;

    /// Their derivatives: a row for each value, a column for each parameter.
    fn jacobian(&self, at: &[f64]) -> Option<DMatrix<f64>>;
}

/// A minimum.
#[derive(Debug, Clone)]
pub(crate) struct Minimum {
    pub(crate) at: Vec<f64>,
    /// Model less measured.
    pub(crate) residuals: Vec<f64>,
    pub(crate) jacobian: DMatrix<f64>,
    /// Weighted sum of squares.
    pub(crate) cost: f64,
}

/// Weighted sum of squares.
pub(crate) fn cost(residuals: &[f64], weights: &[f64]) -> f64 {
    let squares = residuals.iter().zip(weights).map(|(r, w)| w * r * r);
    squares.sum()
}

/// The matrix with its rows multiplied by their weights.
pub(crate) fn weighted(matrix: &DMatrix<f64>, weights: &[f64]) -> DMatrix<f64> {
    let mut out = matrix.clone();
    for (mut row, weight) in out.row_iter_mut().zip(weights) {
        row *= *weight;
    }
    out
}

/// From a start to the nearest minimum (Levenberg–Marquardt); a parameter at its bound that would leave it stands still, and so
/// does one whose bounds are one value.
pub(crate) fn minimise(
    model: &impl Model,
    measured: &[f64],
    weights: &[f64],
    start: &[f64],
    bounds: &[(f64, f64)],
) -> Option<Minimum> {
    let clamp = |z: Vec<f64>| -> Vec<f64> {
        let values = z.into_iter().zip(bounds);
        values
            .map(|(z, (low, high))| z.clamp(*low, *high))
            .collect()
    };
    let look = |z: &[f64]| -> Option<(f64, Vec<f64>)> {
        let values = model.values(z)?;
        let residuals: Vec<f64> = values.iter().zip(measured).map(|(a, b)| a - b).collect();
        Some((cost(&residuals, weights), residuals))
    };
    let mut at = clamp(start.to_vec());
    let (mut cost, mut residuals) = look(&at)?;
    let mut jacobian = model.jacobian(&at)?;
    let mut damping = 1e-4;
    for _ in 0..STEPS {
        let weighted = weighted(&jacobian, weights);
        let mut bend = weighted.tr_mul(&jacobian);
        let mut slope = weighted.tr_mul(&DVector::from_column_slice(&residuals));
        for (i, (low, high)) in bounds.iter().enumerate() {
            let outwards =
                (at[i] <= *low && slope[i] >= 0.0) || (at[i] >= *high && slope[i] <= 0.0);
            if outwards || low >= high {
                slope[i] = 0.0;
                bend.row_mut(i).fill(0.0);
                bend.column_mut(i).fill(0.0);
                bend[(i, i)] = 1.0;
            } else {
                bend[(i, i)] *= 1.0 + damping;
            }
        }
        let step = bend.lu().solve(&slope)?;
        let next = clamp(at.iter().zip(step.iter()).map(|(a, s)| a - s).collect());
        let moved: f64 = next.iter().zip(&at).map(|(a, b)| (a - b).abs()).sum();
        match look(&next) {
            Some(seen) if seen.0 <= cost => {
                at = next;
                (cost, residuals) = seen;
                jacobian = model.jacobian(&at)?;
                damping = (damping / 10.0).max(1e-12);
            }
            _ => damping *= 10.0,
        }
        if moved < STILL || damping > 1e8 {
            break;
        }
    }
    Some(Minimum {
        at,
        residuals,
        jacobian,
        cost,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// a·exp(−b u) at five places.
    struct Decay;

    impl Model for Decay {
        fn bounds(&self) -> Vec<(f64, f64)> {
            vec![(0.0, 10.0), (0.0, 10.0)]
        }

        fn values(&self, at: &[f64]) -> Option<Vec<f64>> {
            let value = |u: i32| at[0] * (-at[1] * f64::from(u)).exp();
            Some((0..5).map(value).collect())
        }

        fn jacobian(&self, at: &[f64]) -> Option<DMatrix<f64>> {
            Some(DMatrix::from_fn(5, 2, |u, column| {
                let decay = (-at[1] * u as f64).exp();
                if column == 0 {
                    decay
                } else {
                    -at[0] * u as f64 * decay
                }
            }))
        }
    }

    #[test]
    fn the_minimum_is_found_inside_at_a_bound_and_along_a_line() {
        let measured = Decay.values(&[3.0, 0.7]).unwrap();
        let from = |bounds: [(f64, f64); 2]| {
            minimise(&Decay, &measured, &[1.0; 5], &[1.0, 0.1], &bounds).unwrap()
        };
        let free = from([(0.0, 10.0), (0.0, 10.0)]);
        assert!(
            (free.at[0] - 3.0).abs() + (free.at[1] - 0.7).abs() < 1e-8,
            "{free:?}"
        );
        let bounded = from([(0.0, 2.5), (0.0, 10.0)]);
        assert!(
            (bounded.at[0] - 2.5).abs() < 1e-12 && bounded.at[1] < 0.7,
            "{bounded:?}"
        );
        // Held fast, the decay's best height follows from linear least squares.
        let held = from([(0.0, 10.0), (0.2, 0.2)]);
        let decay = Decay.values(&[1.0, 0.2]).unwrap();
        let product = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let best = product(&decay, &measured) / product(&decay, &decay);
        assert!((held.at[0] - best).abs() < 1e-8, "{held:?} {best}");
    }
}
