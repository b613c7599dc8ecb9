//! What is asked for.

use swimmer_files::Bounds;
use swimmer_model::{Model, Swimmer};

use super::error::SpeedError;
use super::setting::{Asked, HeadingRule, Setting};
use crate::region::Region;

/// The fastest gait of which swimmer, within what.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct SpeedProblem {
    /// Whose gait.
    pub swimmer: Swimmer<f64>,
    /// Bounds on shapes; those of quarters (`min_angle`, `sector`) make no sense here.
    pub bounds: Bounds,
    /// Largest |φ̇ᵢ| \[rad/s\].
    pub rates: [f64; 2],
    /// Which way the gait shall lead.
    pub heading: HeadingRule,
    /// The period \[s\], where the farthest gait in this time is asked for.
    pub period: Option<f64>,
    /// Most corners of a cycle: a chain of unlike cycles may always beat each of them.
    pub max_corners: usize,
    /// Closed curves to start from.
    pub starts: usize,
    /// Of the random ones.
    pub seed: u64,
    /// Threads to search with; the answer does not depend on it.
    pub threads: usize,
}

impl SpeedProblem {
    /// Most corners of a cycle unless told otherwise.
    pub const MAX_CORNERS: usize = 16;
    /// Starts unless told otherwise.
    pub const STARTS: usize = 64;
    /// And where the heading is prescribed: fewer of them lead to the fastest gait then.
    pub const STARTS_OF_A_HEADING: usize = 256;
    /// The first starts, each a good guess where angles are bounded: for an answer at once, as a rule the fastest.
    pub const GUESSES: usize = 3;

    /// Without bounds, any way.
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

    /// Led this way, from as many starts as that takes.
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

    /// The faster servo's rate \[rad/s\].
    pub(crate) fn fast(&self) -> f64 {
        self.rates[0].max(self.rates[1])
    }

    /// The problem in units in which the faster servo turns by 1 rad.
    pub(crate) fn setting<'a>(&self, model: &'a Model<f64>, region: &'a Region) -> Setting<'a> {
        let fast = self.fast();
        Setting {
            model,
            region,
            rates: self.rates.map(|rate| rate / fast),
            beyond: Vec::new(),
            asked: Asked {
                heading: self.heading,
                period: self.period.map(|period| period * fast),
                ..Asked::default()
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
