//! Warm start: the efficiency gait of a problem from that of a neighbouring problem, by shooting from its arcs.

use super::chain::Origin;
use super::{EfficiencyProblem, PolishedGait, finished};
use crate::extremal::continuation::within_walls;
use crate::extremal::{Extremal, polish, polish_chain, walls};
use crate::optimal_gait::OptimalGait;

/// Efficiency gait that is the initial guess for neighbouring problems, with a slightly different swimmer or bounds. The first step
/// detects the arcs on its curve; each further step starts from the arcs themselves.
///
/// ```
/// use gait_optimizer::{Branch, EfficiencyProblem, EfficiencySeed, efficiency};
/// use swimmer_model::Swimmer;
///
/// let mut problem = EfficiencyProblem::new(Swimmer::purcell(), Branch::Small);
/// let mut seed = EfficiencySeed::new(efficiency(&problem).unwrap());
/// for chi in [2.01, 2.02] {
///     problem.swimmer.chi = chi;
///     seed = seed.near(&problem).unwrap();
///     assert!(seed.gait().certificate.pass());
/// }
/// let direct = efficiency(&problem).unwrap();
/// assert!((seed.gait().efficiency / direct.efficiency - 1.0).abs() < 1e-9);
/// ```
#[derive(Debug, Clone)]
pub struct EfficiencySeed {
    gait: OptimalGait,
    extremal: Option<Extremal>,
}

impl EfficiencySeed {
    /// Starts from a gait with the paper's two symmetries; other gaits do not converge.
    pub fn new(gait: OptimalGait) -> Self {
        Self {
            gait,
            extremal: None,
        }
    }

    /// The gait.
    pub fn gait(&self) -> &OptimalGait {
        &self.gait
    }

    /// Returns the optimum of a neighbouring problem with its own certificate, at a fraction of the cost of
    /// [`efficiency()`](super::efficiency()). Returns `None` if shooting does not find a gait of the branch or its certificate fails.
    pub fn near(&self, problem: &EfficiencyProblem) -> Option<Self> {
        let model = problem.validated().ok()?;
        if !self.gait.symmetric {
            return None;
        }
        let walls = walls(&problem.bounds, &problem.swimmer.links);
        let extremal = match &self.extremal {
            Some(Extremal { chain, .. }) => {
                polish_chain(&model, &walls, within_walls(&walls, chain))
            }
            None => polish(&model, &walls, &self.gait.gait().ok()?, true),
        };
        let of = (problem, &model, &problem.bounds);
        let PolishedGait { gait, extremal } = finished(of, extremal.ok()?, Origin::arcs()).ok()?;
        (problem.branch.contains(&gait) && gait.certificate.pass()).then_some(Self {
            gait,
            extremal: Some(extremal),
        })
    }
}
