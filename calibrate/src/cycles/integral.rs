//! Sums over evenly spaced samples that are integrals, wherever the first sample falls.

use nalgebra::{DMatrix, DVector};

/// Weights by which sums over evenly spaced samples are integrals from 0 to 1, to the order `end` in the spacing (Euler
/// and Maclaurin). Ends where samples are missing or uneven keep weights of 1.
pub(super) fn weights(places: &[f64], spacing: f64, end: usize) -> Vec<f64> {
    let mut weights = vec![1.0; places.len()];
    let even = |places: &mut dyn Iterator<Item = f64>| {
        let near: Vec<f64> = places.take(end.max(2)).collect();
        let steps = near.windows(2).all(|pair| {
            let step = pair.iter().rev().copied().reduce(|b, a| b - a);
            step.is_some_and(|step| (step / spacing - 1.0).abs() < 0.01)
        });
        let lead = near.first().copied().unwrap_or(1.0) / spacing;
        // A sample at the very end may be rounded to either side of it.
        (near.len() == end.max(2) && steps && (-0.01..=1.01).contains(&lead)).then_some(lead)
    };
    if places.len() < 4 * end {
        return weights;
    }
    let corrections = |lead| end_corrections(lead, end);
    let left = even(&mut places.iter().copied()).and_then(corrections);
    let right = even(&mut places.iter().rev().map(|u| 1.0 - u)).and_then(corrections);
    for (weight, correction) in weights.iter_mut().zip(left.unwrap_or_default()) {
        *weight += correction;
    }
    for (weight, correction) in weights.iter_mut().rev().zip(right.unwrap_or_default()) {
        *weight += correction;
    }
    weights
}

/// Corrections c with Σ cⱼ (α + j)ᵐ = B(α)/(m + 1), B the Bernoulli polynomial of degree m + 1: what the first samples at
/// α, α + 1, … spacings from an end lack for the integral.
fn end_corrections(lead: f64, count: usize) -> Option<Vec<f64>> {
    let a = lead;
    let right = [
        a - 0.5,
        (a * a - a) / 2.0 + 1.0 / 12.0,
        (a * a * a - 1.5 * a * a + 0.5 * a) / 3.0,
        (a.powi(4) - 2.0 * a.powi(3) + a * a - 1.0 / 30.0) / 4.0,
    ];
    let right = DVector::from_iterator(count, right.into_iter().take(count));
    let powers = DMatrix::from_fn(count, count, |m, j| {
        (a + j as f64).powi(i32::try_from(m).unwrap_or(0))
    });
    let solution = powers.lu().solve(&right)?;
    Some(solution.iter().copied().collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sums_are_integrals_wherever_the_first_sample_falls() {
        for (end, tolerance) in [(3, 1e-8), (4, 1e-10)] {
            for lead in [0.0, 0.3, 0.5, 0.999] {
                let places: Vec<f64> = (0..300).map(|i| (f64::from(i) + lead) / 300.0).collect();
                let sum: f64 = places
                    .iter()
                    .zip(weights(&places, 1.0 / 300.0, end))
                    .map(|(u, weight)| weight * (3.0 * u).exp() / 300.0)
                    .sum();
                let off = sum / ((3_f64.exp() - 1.0) / 3.0) - 1.0;
                assert!(off.abs() < tolerance, "{end} at {lead}: {off:.1e}");
            }
        }
    }
}
