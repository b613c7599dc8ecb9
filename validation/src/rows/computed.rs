//! Computed values with which the rows of the paper are compared.

use gait_optimizer::{BestAmplitude, Condition, OptimalGait};

/// Name of a quantity and its computed value.
pub(super) type Computed = (&'static str, f64);

/// Number of conditions that a gait violates when it is certified from its samples; NaN if that is impossible.
pub(super) fn failed_checks(gait: &OptimalGait) -> f64 {
    gait.certify().map_or(f64::NAN, |certificate| {
        let checks = certificate.checks().iter();
        checks.filter(|check| !check.pass).count() as f64
    })
}

/// Value of one condition of that certificate.
pub(super) fn value_of(gait: &OptimalGait, condition: Condition) -> f64 {
    let certificate = gait.certify().ok();
    let value = certificate.and_then(|certificate| certificate.value(condition));
    value.unwrap_or(f64::NAN)
}

/// Largest of values that are not negative; NaN if one of them is NaN, so that a row with it fails.
pub(super) fn largest(values: impl Iterator<Item = f64>) -> f64 {
    values.fold(0.0, |largest, value| {
        if largest.is_nan() || largest >= value {
            largest
        } else {
            value
        }
    })
}

/// First locally best amplitude.
pub(super) fn first(best: &[BestAmplitude]) -> &BestAmplitude {
    best.first().unwrap_or(&NONE)
}

/// Second locally best amplitude.
pub(super) fn second(best: &[BestAmplitude]) -> &BestAmplitude {
    best.get(1).unwrap_or(&NONE)
}

/// Placeholder for a missing amplitude: every comparison with it fails.
const NONE: BestAmplitude = BestAmplitude {
    amplitude: f64::NAN,
    displacement_over_length: f64::NAN,
    efficiency: f64::NAN,
};

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_largest_value_keeps_a_nan() {
        assert!((largest([0.1, 0.3, 0.2].into_iter()) - 0.3).abs() < 1e-15);
        assert!(largest([0.1, f64::NAN, 0.2].into_iter()).is_nan());
        assert!(largest([f64::NAN].into_iter()).is_nan());
    }
}
