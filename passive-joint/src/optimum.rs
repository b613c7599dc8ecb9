//! Best waveform of the driven joint, with its first-order (KKT) conditions, next to the best sinusoid under the same bounds.

use nalgebra::DVector;

use crate::adjoint::CycleValues;
use crate::interior::{Maximisation, Maximum};
use crate::problem::{INSTANTS, Scaled};
use crate::{PassiveError, PassiveJoint, Problem, Waveform};

/// Optimality conditions of a waveform, for the logarithm of the objective in the variables of the search: coefficients in rad, κ over
/// W_pp(0).
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Conditions {
    /// Largest component of the gradient of the Lagrangian.
    pub stationarity: f64,
    /// Largest product of a multiplier, which is positive, and the slack of its bound.
    pub complementarity: f64,
    /// True if the second variation is negative along the active bounds.
    pub is_strict: bool,
}

/// A waveform that is best under its bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct Optimum {
    /// Waveform of the driven joint.
    pub waveform: Waveform,
    /// The passive joint.
    pub passive: PassiveJoint,
    /// Period \[s\].
    pub period: f64,
    /// Displacement, energy and their derivatives.
    pub values: CycleValues,
    /// Logarithm of the objective; differences of it are shares.
    pub value: f64,
    /// Optimality conditions.
    pub conditions: Conditions,
    /// Largest angle of the driven joint \[rad\].
    pub largest_angle: f64,
    /// Largest rate of the driven joint \[rad/s\].
    pub largest_rate: f64,
}

/// Results of a search under the same bounds.
#[derive(Debug, Clone, PartialEq)]
pub struct Optima {
    /// The best waveform.
    pub best: Optimum,
    /// The best sinusoid.
    pub sine: Optimum,
}

/// Finds the best waveform, and the best sinusoid under the same bounds.
///
/// # Errors
/// A problem without an optimum or with invalid numbers, or a search that does not converge.
pub fn optimize(problem: &Problem<'_>) -> Result<Optima, PassiveError> {
    let sine_problem = Problem {
        harmonics: 1,
        ..*problem
    };
    let scaled = Scaled::new(problem)?;
    let sine_scaled = Scaled::new(&sine_problem)?;
    let (sine, at) = search(&sine_scaled, sine_scaled.sine())?;
    if problem.harmonics == 1 {
        let best = sine.clone();
        return Ok(Optima { best, sine });
    }
    let (best, _) = search(&scaled, scaled.extended(&at))?;
    Ok(Optima { best, sine })
}

fn search(
    scaled: &Scaled<'_>,
    start: DVector<f64>,
) -> Result<(Optimum, DVector<f64>), PassiveError> {
    let objective = |x: &DVector<f64>| scaled.value(x);
    let maximisation = Maximisation {
        objective: &objective,
        rows: &scaled.rows,
        limits: &scaled.limits,
    };
    let Maximum {
        x,
        value,
        stationarity,
        complementarity,
        is_strict,
    } = maximisation.solve(start)?;
    let (waveform, passive, period) = (scaled.waveform(&x), scaled.passive(&x)?, scaled.period(&x));
    let values = scaled.values(&x)?;
    let [largest_angle, largest_rate] = largest(&waveform, period);
    let optimum = Optimum {
        largest_angle,
        largest_rate,
        waveform,
        passive,
        period,
        values,
        value,
        conditions: Conditions {
            stationarity,
            complementarity,
            is_strict,
        },
    };
    Ok((optimum, x))
}

/// Largest angle \[rad\] and rate \[rad/s\] of a waveform, between the instants of the bounds too.
fn largest(waveform: &Waveform, period: f64) -> [f64; 2] {
    let samples = 8 * INSTANTS;
    (0..samples).fold([0.0; 2], |[angle, rate], sample| {
        let [a, b] = waveform.at(0.5 * sample as f64 / samples as f64);
        [a.abs().max(angle), (b.abs() / period).max(rate)]
    })
}
