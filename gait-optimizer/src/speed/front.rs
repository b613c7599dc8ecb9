//! Trade-off between displacement and speed: the farthest gait in each period.

use crate::parallel::{Watch, in_parallel};

use super::error::SpeedError;
use super::fastest::Fastest;
use super::period::{Branches, rungs, searched};
use super::problem::SpeedProblem;

/// Shortest and longest period of a front, relative to that of the fastest gait.
const SHORTEST: f64 = 0.3;
const LONGEST: f64 = 2.0;
/// Periods of a front.
const PERIODS: usize = 24;
/// Approximate share of the work that the fastest gait takes.
const FASTEST_SHARE: f64 = 0.1;

/// Trade-off between speed and displacement per cycle.
#[derive(Debug, Clone, PartialEq)]
pub struct Front {
    /// Fastest gait of any period.
    pub fastest: Fastest,
    /// Farthest gait in each of [`Self::periods`], laps and rests included. `None` if no gait of at most this period was certified.
    pub farthest: Vec<Option<Fastest>>,
    /// Periods \[s\], ascending.
    pub periods: Vec<f64>,
}

/// Finds the fastest gait, and the farthest gaits in shorter and longer periods. The `period` of the problem is ignored.
///
/// # Errors
/// [`SpeedError`] if no fastest gait is found.
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
    let mut searches: Vec<SpeedProblem> = periods
        .iter()
        .map(|period| SpeedProblem {
            period: Some(*period),
            ..*problem
        })
        .collect();
    searches.extend(rungs(problem, &fastest));
    let share = |share: f64| watch(FASTEST_SHARE + (1.0 - FASTEST_SHARE) * share);
    let found = searched(&searches, problem.threads, &share);
    let branches = Branches {
        problem,
        fastest: Some(&fastest),
        known: found.into_iter().filter_map(Result::ok).collect(),
    };
    let farthest = in_parallel(
        periods.len(),
        problem.threads,
        &|_| (),
        || (),
        |(), index| branches.farthest(periods[index]),
    );
    Ok(Front {
        fastest,
        farthest,
        periods,
    })
}
