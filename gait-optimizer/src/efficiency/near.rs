//! The gait of a design from the gait of a neighbouring one: its arcs shot again, no series and no path of bounds.

use super::chain::Origin;
use super::{EfficiencyProblem, Found, finished};
use crate::extremal::continuation::within_walls;
use crate::extremal::{Extremal, polish, polish_chain, walls};
use crate::optimal_gait::OptimalGait;

/// An efficiency gait from which the gaits of neighbouring problems are found: another swimmer or other bounds, a little changed.
/// The first step reads the arcs off its curve, each further one starts from the arcs themselves.
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
    /// From a gait with the paper's two symmetries; any other leads nowhere.
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

    /// The optimum of a problem that lies near, with its own certificate. It costs a fraction of
    /// [`efficiency()`](super::efficiency()). None where the arcs lead to no gait of the branch, or to one that fails its
    /// certificate.
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
        let Found { gait, extremal } = finished(of, extremal.ok()?, Origin::arcs()).ok()?;
        (problem.branch.contains(&gait) && gait.certificate.pass()).then_some(Self {
            gait,
            extremal: Some(extremal),
        })
    }
}
