//! Displacement against speed: the farthest gait in every period.

use crate::parallel::{Watch, in_parallel};

use super::error::SpeedError;
use super::fastest::Fastest;
use super::problem::SpeedProblem;

/// Periods of a front, over that of the fastest gait: shorter ones carry less far and slower, longer ones farther and slower.
const SHORTEST: f64 = 0.3;
const LONGEST: f64 = 2.0;
/// Periods that are looked at.
const PERIODS: usize = 24;
/// Of the time, about, for the fastest gait.
const FASTEST_SHARE: f64 = 0.1;

/// The trade between speed and displacement per cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// The fastest gait of all.
    pub fastest: Fastest,
    /// The farthest gait in each of [`Self::periods`] \[s\]; none where none was certified, or one that an earlier, shorter cycle
    /// outdoes: that one and a rest carry farther.
    pub farthest: Vec<Option<Fastest>>,
    /// \[s\], rising.
    pub periods: Vec<f64>,
}

/// The fastest gait, and the farthest ones in shorter and longer periods.
///
/// # Errors
/// [`SpeedError`] where there is no fastest gait; `period` of the problem is not looked at.
pub fn front(problem: &SpeedProblem, watch: Watch<'_>) -> Result<Front, SpeedError> {
    let free = SpeedProblem {
        period: None,
        ..*problem
    };
    let fastest = free.watched(&|share| watch(FASTEST_SHARE * share))?;
    let periods: Vec<f64> = (0..PERIODS)
        .map(|k| SHORTEST + (LONGEST - SHORTEST) * k as f64 / (PERIODS - 1) as f64)
        .map(|share| share * fastest.period)
        .collect();
    let mut farthest = in_parallel(
        periods.len(),
        problem.threads,
        &|share| watch(FASTEST_SHARE + (1.0 - FASTEST_SHARE) * share),
        || (),
        |(), index| {
            let one = SpeedProblem {
                period: Some(periods[index]),
                threads: 1,
                ..*problem
            };
            one.watched(&|_| ()).ok()
        },
    );
    let mut reached = 0.0;
    for found in &mut farthest {
        let here = found.as_ref().map(|found| found.distance_over_length);
        match here {
            Some(here) if here >= reached => reached = here,
            _ => *found = None,
        }
    }
    Ok(Front {
        fastest,
        farthest,
        periods,
    })
}
