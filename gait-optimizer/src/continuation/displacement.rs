//! Displacement gaits: the search needs no guess, so the next gait is the nearest of all that it finds.

use super::branch_point::BranchPoint;
use super::follow::Family;
use super::{ContinuationProblem, Start};
use crate::displacement::{DisplacementProblem, Heading, every};
use crate::optimal_gait::OptimalGait;

pub(super) struct Displacement<'a> {
    pub(super) problem: &'a ContinuationProblem,
}

impl Displacement<'_> {
    /// Every gait of one sense at a parameter value, farthest first, including those that fail their certificate.
    fn all(&self, value: f64, heading: Heading) -> Result<Vec<OptimalGait>, String> {
        let problem = DisplacementProblem {
            bounds: self.problem.bounds_at(value),
            quarter_samples: (self.problem.samples / 4).clamp(64, 1 << 12),
            ..DisplacementProblem::new(self.problem.swimmer_at(value))
        };
        every(&problem, heading).map_err(|error| error.to_string())
    }

    fn nearest(&self, value: f64, to: &OptimalGait) -> Result<BranchPoint, String> {
        let place = kept(0.0, to.clone());
        let all = self.all(value, to.heading_counter_clockwise())?;
        let found = all.into_iter().map(|gait| kept(value, gait));
        // An optimum is preferred to an extremal that is not an optimum.
        let far = |kept: &BranchPoint| {
            let apart = kept.apart(&place);
            if kept.holds() || apart > 0.05 {
                apart
            } else {
                apart + 0.05
            }
        };
        found
            .min_by(|a, b| far(a).total_cmp(&far(b)))
            .ok_or_else(|| "no gait heads this way".to_owned())
    }
}

fn kept(value: f64, gait: OptimalGait) -> BranchPoint {
    BranchPoint::new(value, gait, None)
}

/// Those that are optima, at least among gaits with their symmetries.
fn optima(value: f64, all: Vec<OptimalGait>) -> impl Iterator<Item = BranchPoint> {
    let all = all.into_iter().map(move |gait| kept(value, gait));
    all.filter(BranchPoint::holds)
}

impl Family for Displacement<'_> {
    const JUMPS: bool = true;

    fn start(&self, start: &Start) -> Result<BranchPoint, String> {
        let value = self.problem.from;
        match start {
            Start::Displacement { heading, rank } => {
                let all = self.all(value, *heading)?;
                let mut optima = optima(value, all);
                optima
                    .nth(*rank)
                    .ok_or_else(|| format!("there are no {} optima", rank + 1))
            }
            Start::Gait(gait) if gait.symmetric => self.nearest(value, gait),
            _ => Err(
                "displacement gaits are followed only with the paper's two symmetries".to_owned(),
            ),
        }
    }

    fn next(
        &self,
        value: f64,
        here: &BranchPoint,
        _: Option<&BranchPoint>,
    ) -> Result<BranchPoint, String> {
        self.nearest(value, &here.gait)
    }

    fn optimum(&self, value: f64, last: &BranchPoint) -> Option<BranchPoint> {
        let all = self
            .all(value, last.gait.heading_counter_clockwise())
            .ok()?;
        optima(value, all).min_by(|a, b| a.apart(last).total_cmp(&b.apart(last)))
    }
}
