//! Newton's method for the fixed point of one cycle.

use crate::PassiveError;

const MOST_STEPS: u32 = 40;
/// Largest difference between the ends of the cycle \[rad\].
const CLOSURE: f64 = 1e-13;

/// End of a cycle.
pub(crate) struct CycleEnd {
    /// Passive angle \[rad\].
    pub(crate) angle: f64,
    /// Derivative of the angle with respect to the angle at the start.
    pub(crate) growth: f64,
}

/// Passive angle that one cycle returns to, and the derivative there: the Floquet multiplier. The last call of `run` is the one
/// from that angle.
///
/// # Errors
/// No fixed point after a bounded number of steps, or one that disturbances leave.
pub(crate) fn fixed_point(
    mut run: impl FnMut(f64) -> Option<CycleEnd>,
) -> Result<(f64, f64), PassiveError> {
    let (mut start, mut residual) = (0.0_f64, f64::INFINITY);
    for iterations in 0..MOST_STEPS {
        let CycleEnd { angle, growth } = run(start).ok_or(PassiveError::NotConverged {
            iterations,
            residual,
        })?;
        residual = angle - start;
        if residual.abs() <= CLOSURE * (1.0 + start.abs()) {
            return if growth.abs() < 1.0 {
                Ok((start, growth))
            } else {
                Err(PassiveError::Unstable { multiplier: growth })
            };
        }
        start -= residual / (growth - 1.0);
    }
    Err(PassiveError::NotConverged {
        iterations: MOST_STEPS,
        residual,
    })
}
