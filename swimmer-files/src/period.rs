//! Periods of a cycle that a robot can play.

use std::ops::RangeInclusive;

/// Shortest and longest period \[s\].
const PLAYABLE: RangeInclusive<f64> = 0.1..=4000.0;

/// A period that no robot plays.
#[derive(Debug, Clone, Copy, PartialEq, thiserror::Error)]
#[error(
    "a period of {period} s is not playable; give {} s to {} s",
    PLAYABLE.start(),
    PLAYABLE.end()
)]
pub struct UnplayablePeriod {
    /// The period \[s\].
    pub period: f64,
}

/// Checks that a robot can play cycles of this period \[s\].
///
/// # Errors
/// The period is shorter than 0.1 s, longer than 4000 s, or NaN.
///
/// ```
/// use swimmer_files::check_playable_period;
///
/// assert!(check_playable_period(30.0).is_ok());
/// let refused = check_playable_period(0.05).unwrap_err();
/// assert_eq!(refused.to_string(), "a period of 0.05 s is not playable; give 0.1 s to 4000 s");
/// ```
pub fn check_playable_period(period: f64) -> Result<(), UnplayablePeriod> {
    if PLAYABLE.contains(&period) {
        Ok(())
    } else {
        Err(UnplayablePeriod { period })
    }
}
