//! What a row of the paper is compared with.

use gait_optimizer::{BestAmplitude, Condition, OptimalGait};

/// A quantity's name, and what it came to.
pub(super) type Computed = (&'static str, f64);

/// How many conditions a gait fails when only its samples are known; NaN where it cannot be asked.
pub(super) fn failed_checks(gait: &OptimalGait) -> f64 {
    gait.certify().map_or(f64::NAN, |certificate| {
        let checks = certificate.checks().iter();
        checks.filter(|check| !check.pass).count() as f64
    })
}

/// One number of that certificate.
pub(super) fn value_of(gait: &OptimalGait, condition: Condition) -> f64 {
    let certificate = gait.certify().ok();
    let value = certificate.and_then(|certificate| certificate.value(condition));
    value.unwrap_or(f64::NAN)
}

/// The first best amplitude.
pub(super) fn first(best: &[BestAmplitude]) -> &BestAmplitude {
    best.first().unwrap_or(&NONE)
}

/// The second one.
pub(super) fn second(best: &[BestAmplitude]) -> &BestAmplitude {
    best.get(1).unwrap_or(&NONE)
}

/// No such amplitude: every comparison with it fails.
const NONE: BestAmplitude = BestAmplitude {
    amplitude: f64::NAN,
    displacement_over_length: f64::NAN,
    efficiency: f64::NAN,
};
