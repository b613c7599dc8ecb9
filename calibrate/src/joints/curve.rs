//! An angle's mean course over a cycle: mean and harmonics by least squares over the samples of all cycles, and the same without
//! each cycle in turn, which says how sure it is.

use std::f64::consts::TAU;

use nalgebra::{DMatrix, DVector};

/// Harmonics of an angle: where a dead band bends its course, those beyond sixteen hold 5e-5 of the area.
const MOST: usize = 16;
/// Samples of a cycle for each of them.
const SAMPLES: f64 = 4.0;

/// An angle over a cycle \[rad\].
#[derive(Debug, Clone, PartialEq)]
pub(super) struct AngleCurve {
    terms: DVector<f64>,
}

/// The mean course of all cycles, and how they differ from it.
pub(super) struct Fitted {
    pub(super) curve: AngleCurve,
    /// Without each cycle; empty where there is only one.
    pub(super) without: Vec<AngleCurve>,
    /// Root mean square distance of the samples from the curve \[rad\].
    pub(super) scatter: f64,
}

/// 1, then cosine and sine of each harmonic, at u.
fn basis(u: f64, terms: usize) -> DVector<f64> {
    let (sin, cos) = (TAU * u).sin_cos();
    let (mut c, mut s) = (1.0, 0.0);
    let term = |index: usize| match index {
        0 => 1.0,
        _ if index % 2 == 1 => {
            (c, s) = (c * cos - s * sin, s * cos + c * sin);
            c
        }
        _ => s,
    };
    DVector::from_iterator(terms, (0..terms).map(term))
}

impl AngleCurve {
    /// The angle at u.
    pub(super) fn at(&self, u: f64) -> f64 {
        basis(u, self.terms.len()).dot(&self.terms)
    }
}

/// Curve of the given cycles by (cycle, u, angle); `None` if the samples do not determine it.
pub(super) fn fit(
    samples: &[(usize, f64, f64)],
    cycles: usize,
    samples_per_cycle: f64,
) -> Option<Fitted> {
    // Bounded by MOST.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let harmonics = (samples_per_cycle / SAMPLES).min(MOST as f64) as usize;
    if harmonics == 0 || cycles == 0 {
        return None;
    }
    let terms = 1 + 2 * harmonics;
    let nothing = (DMatrix::<f64>::zeros(terms, terms), DVector::zeros(terms));
    let mut of_cycles = vec![nothing.clone(); cycles];
    for (cycle, u, angle) in samples {
        let row = basis(*u, terms);
        let (gram, right) = of_cycles.get_mut(*cycle)?;
        gram.ger(1.0, &row, &row, 1.0);
        right.axpy(*angle, &row, 1.0);
    }
    let sum = of_cycles
        .iter()
        .fold(nothing, |(gram, right), (g, r)| (gram + g, right + r));
    let solve = |gram: &DMatrix<f64>, right: &DVector<f64>| {
        // If samples are missing at the same place of all cycles, harmonics are undetermined; their Gram matrix shows it.
        let least = 0.02 * gram[(0, 0)];
        let sound = gram.clone().symmetric_eigenvalues().min() > least;
        let terms = gram.clone().cholesky().filter(|_| sound)?.solve(right);
        Some(AngleCurve { terms })
    };
    let curve = solve(&sum.0, &sum.1)?;
    let without = if cycles > 1 {
        let others = |(gram, right): &(DMatrix<f64>, DVector<f64>)| {
            solve(&(&sum.0 - gram), &(&sum.1 - right)).unwrap_or_else(|| curve.clone())
        };
        of_cycles.iter().map(others).collect()
    } else {
        Vec::new()
    };
    let square = |(_, u, angle): &(usize, f64, f64)| (curve.at(*u) - angle).powi(2);
    let squares: f64 = samples.iter().map(square).sum();
    Some(Fitted {
        scatter: (squares / samples.len() as f64).sqrt(),
        curve,
        without,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_course_is_found_and_a_hole_is_not_guessed() {
        let angle = |u: f64| 0.2 + (TAU * u).cos() + 0.1 * (3.0 * TAU * u).sin();
        let samples = |hole: f64| -> Vec<(usize, f64, f64)> {
            let all =
                (0..600).map(|i| (i / 200, f64::from(u32::try_from(i % 200).unwrap()) / 200.0));
            let kept = all.filter(|(_, u)| *u > hole);
            kept.map(|(cycle, u)| (cycle, u, angle(u))).collect()
        };
        let fitted = fit(&samples(-1.0), 3, 200.0).unwrap();
        assert!((fitted.curve.at(0.37) - angle(0.37)).abs() < 1e-12);
        assert!(fitted.without.len() == 3 && fitted.scatter < 1e-12);
        assert!(fit(&samples(0.2), 3, 200.0).is_none());
    }
}
