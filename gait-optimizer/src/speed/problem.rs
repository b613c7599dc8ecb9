//! Inputs of the fastest-gait search.

use swimmer_files::Bounds;
use swimmer_model::{Model, Swimmer};

use super::error::SpeedError;
use super::setting::{GaitRequirements, HeadingRule, Setting};
use crate::region::Region;

/// Inputs of the fastest-gait search.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedProblem {
    /// The swimmer.
    pub swimmer: Swimmer<f64>,
    /// Bounds on shapes. Bounds of quarter gaits (`min_angle`, `sector`) are refused.
    pub bounds: Bounds,
    /// Largest |φ̇ᵢ| \[rad/s\].
    pub rates: [f64; 2],
    /// Required direction of the displacement.
    pub heading: HeadingRule,
    /// Period \[s\] for the farthest gait in this time; `None` for the fastest gait of any period.
    pub period: Option<f64>,
    /// Most corners of a cycle: a chain of unlike cycles may always beat each of them.
    pub max_corners: usize,
    /// Number of closed curves from which the search starts.
    pub starts: usize,
    /// Seed of the random starts.
    pub seed: u64,
    /// Threads of the search; the result does not depend on it.
    pub threads: usize,
}

impl SpeedProblem {
    /// Default of [`Self::max_corners`].
    pub const MAX_CORNERS: usize = 16;
    /// Default of [`Self::starts`] for any heading.
    pub const STARTS: usize = 64;
    /// Default of [`Self::starts`] for a prescribed heading, where fewer starts lead to the fastest gait.
    pub const STARTS_OF_A_HEADING: usize = 256;
    /// Number of first starts that are good initial guesses for bounded angles: quick, and mostly sufficient.
    pub const GUESSES: usize = 3;

    /// A problem without bounds, for any heading.
    pub fn new(swimmer: Swimmer<f64>, rates: [f64; 2]) -> Self {
        Self {
            swimmer,
            bounds: Bounds::default(),
            rates,
            heading: HeadingRule::Any,
            period: None,
            max_corners: Self::MAX_CORNERS,
            starts: Self::STARTS,
            seed: 0,
            threads: 1,
        }
    }

    /// Returns the problem for a heading, with the default number of starts for it.
    #[must_use]
    pub fn led(self, heading: HeadingRule) -> Self {
        let starts = match heading {
            HeadingRule::Any => Self::STARTS,
            HeadingRule::Forward | HeadingRule::Sideways => Self::STARTS_OF_A_HEADING,
        };
        Self {
            heading,
            starts,
            ..self
        }
    }

    /// Rate of the faster servo \[rad/s\].
    pub(crate) fn fast(&self) -> f64 {
        self.rates[0].max(self.rates[1])
    }

    /// Returns the problem in units in which the faster servo turns by 1 rad per unit of time.
    pub(crate) fn setting<'a>(&self, model: &'a Model<f64>, region: &'a Region) -> Setting<'a> {
        let fast = self.fast();
        Setting {
            model,
            region,
            rates: self.rates.map(|rate| rate / fast),
            asked: GaitRequirements {
                heading: self.heading,
                period: self.period.map(|period| period * fast),
                ..GaitRequirements::default()
            },
            members: &[],
        }
    }
}

pub(crate) fn validate(problem: &SpeedProblem) -> Result<(), SpeedError> {
    for rate in problem.rates {
        if !(rate.is_finite() && rate > 0.0) {
            return Err(SpeedError::Rate { rate });
        }
    }
    if let Some(period) = problem.period
        && !(period.is_finite() && period > 0.0)
    {
        return Err(SpeedError::Period { period });
    }
    if problem.bounds.min_angle.is_some() || problem.bounds.sector {
        return Err(SpeedError::OfQuarters {
            bounds: problem.bounds,
        });
    }
    if problem.max_corners < 3 {
        return Err(SpeedError::Corners {
            corners: problem.max_corners,
        });
    }
    Ok(())
}
