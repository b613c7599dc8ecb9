//! Errors of the timing, and checks of a request.

use swimmer_model::InvalidSamples;

/// Reason why a gait has no timing.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
pub enum TimingError {
    /// The rate limit is not positive and finite.
    #[error("the servos' largest rate is {rate} rad/s; give a number above 0")]
    Rate {
        /// The rate \[rad/s\].
        rate: f64,
    },
    /// The period is not positive and finite.
    #[error("the period is {period} s; give a finite number above 0")]
    Period {
        /// The period \[s\].
        period: f64,
    },
    /// The servos are too slow.
    #[error(
        "no timing runs this gait in {period} s with joints of at most {rate} rad/s: the shortest possible period is \
         {shortest:.4} s; give a longer period or faster servos"
    )]
    TooFast {
        /// The requested period \[s\].
        period: f64,
        /// The servos' rate \[rad/s\].
        rate: f64,
        /// The shortest period at that rate \[s\].
        shortest: f64,
    },
    /// The gait does not move.
    #[error("the gait stands still, so it has no timing; give one that moves")]
    Still,
    /// The retimed samples make no gait.
    #[error("the gait cannot be retimed: {0}")]
    Samples(#[from] InvalidSamples),
}

pub(super) fn check_rate(rate: f64) -> Result<(), TimingError> {
    if rate > 0.0 {
        Ok(())
    } else {
        Err(TimingError::Rate { rate })
    }
}

pub(super) fn check_period(period: f64) -> Result<(), TimingError> {
    if period.is_finite() && period > 0.0 {
        Ok(())
    } else {
        Err(TimingError::Period { period })
    }
}
