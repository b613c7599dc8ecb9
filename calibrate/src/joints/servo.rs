//! Fit of a servo's response: gain, offset, lag and dead band between command and measured angle.

use nalgebra::{DMatrix, DVector};

use super::curve::{AngleCurve, Fitted};
use super::{Measured, MeasuredServo};
use crate::least_squares::{Model, minimise};

/// Number of places of a cycle at which both courses are compared.
const PLACES: usize = 256;
/// Dead bands from which the search starts \[rad\].
const DEAD_BANDS: [f64; 3] = [0.01, 0.06, 0.15];
/// Half a difference's width.
const STEP: f64 = 1e-4;

/// Model of one servo: gain, offset \[rad\], lag \[cycles\] and dead band \[rad\] predict its course.
struct Servo<F>(F);

const DEAD_BAND: usize = 3;

impl<F: Fn(f64) -> f64> Model for Servo<F> {
    fn bounds(&self) -> Vec<(f64, f64)> {
        vec![(0.2, 2.0), (-0.6, 0.6), (-0.25, 0.25), (0.0, 0.5)]
    }

    fn values(&self, at: &[f64]) -> Option<Vec<f64>> {
        let [gain, offset, lag, dead_band] = *at else {
            return None;
        };
        let place = |i: usize| (i % PLACES) as f64 / PLACES as f64;
        let wanted = |i: usize| gain * (self.0)((place(i) - lag).rem_euclid(1.0)) + offset;
        let mut shaft = wanted(0);
        // The first cycle forgets where the shaft came from.
        let mut out = Vec::with_capacity(2 * PLACES);
        for i in 0..2 * PLACES {
            let wanted = wanted(i);
            shaft = shaft.clamp(wanted - dead_band, wanted + dead_band);
            out.push(shaft);
        }
        Some(out.split_off(PLACES))
    }

    fn jacobian(&self, at: &[f64]) -> Option<DMatrix<f64>> {
        let mut jacobian = DMatrix::zeros(PLACES, at.len());
        for column in 0..at.len() {
            let look = |by: f64| {
                let mut z = at.to_vec();
                z[column] += by;
                self.values(&z)
            };
            let below = if column == DEAD_BAND && at[column] < STEP {
                0.0
            } else {
                STEP
            };
            let (behind, ahead) = (look(-below)?, look(STEP)?);
            for (row, (b, a)) in behind.iter().zip(&ahead).enumerate() {
                jacobian[(row, column)] = (a - b) / (below + STEP);
            }
        }
        Some(jacobian)
    }
}

/// `period_s` where a lag means something.
pub(super) fn of(
    fitted: &Fitted,
    command: impl Fn(f64) -> f64,
    period_s: Option<f64>,
) -> Option<MeasuredServo> {
    let course = |curve: &AngleCurve| -> Vec<f64> {
        let places = (0..PLACES).map(|i| i as f64 / PLACES as f64);
        places.map(|u| curve.at(u)).collect()
    };
    let (model, measured) = (Servo(command), course(&fitted.curve));
    let (even, bounds) = (vec![1.0; PLACES], model.bounds());
    let ends = DEAD_BANDS.iter().filter_map(|dead_band| {
        let start = [1.0, 0.0, 0.0, *dead_band];
        minimise(&model, &measured, &even, &start, &bounds)
    });
    let best = ends.min_by(|a, b| a.cost.total_cmp(&b.cost))?;
    let jacobian = &best.jacobian;
    let inverse = jacobian.tr_mul(jacobian).try_inverse()?;
    let moves = inverse * jacobian.transpose();
    // To first order, where each cycle's absence takes the parameters (the jackknife).
    let count = fitted.without.len() as f64;
    let steps: Vec<DVector<f64>> = fitted
        .without
        .iter()
        .map(|without| {
            let change = course(without).into_iter().zip(&measured);
            &moves * DVector::from_iterator(PLACES, change.map(|(a, b)| a - b))
        })
        .collect();
    let error = |parameter: usize| {
        let mean = steps.iter().map(|step| step[parameter]).sum::<f64>() / count;
        let squares = steps.iter().map(|step| (step[parameter] - mean).powi(2));
        ((count - 1.0) / count * squares.sum::<f64>()).sqrt()
    };
    let measured = |parameter: usize, unit: f64| Measured {
        value: unit * best.at[parameter],
        error: unit * error(parameter),
    };
    Some(MeasuredServo {
        gain: measured(0, 1.0),
        offset: measured(1, 1.0),
        lag: period_s.map(|period_s| measured(2, period_s)),
        dead_band: measured(DEAD_BAND, 1.0),
    })
}

/// The mean of what runs say of one thing, each weighed by its error and by what they differ beyond it (the method of moments).
pub fn combined(values: &[Measured]) -> Option<Measured> {
    let known: Vec<(f64, f64)> = values
        .iter()
        .filter(|m| m.value.is_finite() && m.error.is_finite() && m.error > 0.0)
        .map(|m| (m.value, m.error.powi(2)))
        .collect();
    if known.is_empty() {
        return values.first().copied();
    }
    let mean = |more: f64| {
        let weights = known.iter().map(|(_, variance)| 1.0 / (variance + more));
        let sum: f64 = weights.clone().sum();
        let product: f64 = weights.zip(&known).map(|(w, (value, _))| w * value).sum();
        (product / sum, sum)
    };
    let (plain, sum) = mean(0.0);
    let spread: f64 = known
        .iter()
        .map(|(value, variance)| (value - plain).powi(2) / variance)
        .sum();
    let squares: f64 = known.iter().map(|(_, v)| v.powi(-2)).sum();
    let more = (spread - (known.len() as f64 - 1.0)) / (sum - squares / sum);
    let (value, sum) = mean(if more.is_finite() { more.max(0.0) } else { 0.0 });
    Some(Measured {
        value,
        error: sum.recip().sqrt(),
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn runs_that_differ_weigh_alike_and_widen_the_error() {
        let of = |value: f64, error: f64| Measured { value, error };
        let alike = combined(&[of(1.0, 0.1), of(1.1, 0.1), of(0.9, 0.1)]).unwrap();
        assert!(
            (alike.value - 1.0).abs() < 1e-12 && (alike.error - 0.1 / 3_f64.sqrt()).abs() < 1e-12
        );
        let unlike = combined(&[of(1.0, 1e-3), of(2.0, 1e-2)]).unwrap();
        assert!(
            (unlike.value - 1.5).abs() < 0.01 && (unlike.error - 0.5).abs() < 0.05,
            "{unlike:?}"
        );
        assert!(combined(&[]).is_none());
    }
}
