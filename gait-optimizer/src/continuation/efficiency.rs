//! Continuation of efficiency gaits: each gait by shooting from the arcs of the previous one.

use swimmer_model::{Gait, Model};

use super::branch_point::BranchPoint;
use super::follow::Family;
use super::{ContinuationProblem, OtherSide, Start};
use crate::efficiency::{EfficiencyProblem, best_symmetric};
use crate::extremal::continuation::{alike, mirrored, other_side, within_walls};
use crate::extremal::gait::gait;
use crate::extremal::{Extremal, polish, polish_chain, walls};
use crate::region::Region;

pub(super) struct Efficiency<'a> {
    pub(super) problem: &'a ContinuationProblem,
}

/// Largest extrapolation along the secant through two gaits, over their distance.
const FARTHEST: f64 = 2.0;

impl Efficiency<'_> {
    fn model(&self, value: f64) -> Result<Model<f64>, String> {
        Model::new(&self.problem.swimmer_at(value).of_unit_length())
            .map_err(|error| error.to_string())
    }

    fn walls(&self, value: f64) -> Region {
        walls(
            &self.problem.bounds_at(value),
            &self.problem.swimmer_at(value).links,
        )
    }

    fn kept(
        &self,
        value: f64,
        model: &Model<f64>,
        extremal: Extremal,
    ) -> Result<BranchPoint, String> {
        let problem = self.problem;
        let (swimmer, bounds) = (problem.swimmer_at(value), problem.bounds_at(value));
        let samples = problem.samples.clamp(64, 1 << 14);
        let gait = gait((&swimmer, model, &bounds), &extremal, samples);
        let gait = gait.map_err(|error| error.to_string())?;
        Ok(BranchPoint::new(value, gait, Some(extremal)))
    }

    fn polished<G: Gait<f64> + ?Sized>(
        &self,
        value: f64,
        curve: &G,
        quarter: bool,
    ) -> Result<BranchPoint, String> {
        let model = self.model(value)?;
        let extremal = polish(&model, &self.walls(value), curve, quarter)
            .map_err(|error| error.to_string())?;
        self.kept(value, &model, extremal)
    }
}

impl Family for Efficiency<'_> {
    const JUMPS: bool = false;

    fn start(&self, start: &Start) -> Result<BranchPoint, String> {
        let value = self.problem.from;
        let gait = match start {
            Start::Gait(gait) => (**gait).clone(),
            Start::Efficiency(branch) => best_symmetric(
                &EfficiencyProblem {
                    bounds: self.problem.bounds_at(value),
                    ..EfficiencyProblem::new(self.problem.swimmer_at(value), *branch)
                },
                &|_| (),
            )
            .map_err(|error| error.to_string())?,
            Start::Displacement { .. } => {
                return Err("it is no efficiency gait".to_owned());
            }
        };
        let curve = gait.gait().map_err(|error| error.to_string())?;
        let kept = self.polished(value, &curve, gait.symmetric)?;
        if kept.holds() {
            Ok(kept)
        } else {
            Err(format!(
                "the extremal there is no optimum: it fails {}",
                kept.gait.certificate.failures()
            ))
        }
    }

    fn next(
        &self,
        value: f64,
        here: &BranchPoint,
        before: Option<&BranchPoint>,
    ) -> Result<BranchPoint, String> {
        let (model, walls) = (self.model(value)?, self.walls(value));
        let extremal = here.extremal.as_ref().ok_or("it is no efficiency gait")?;
        let chain = &extremal.chain;
        let secant = before.and_then(|before| {
            let factor = (value - here.value) / (here.value - before.value);
            let last = &before.extremal.as_ref()?.chain;
            (alike(last, chain) && factor > 0.0 && factor <= FARTHEST)
                .then(|| mirrored(last, chain, factor))
        });
        let mut reason = String::new();
        for guess in secant.into_iter().chain([chain.clone()]) {
            let guess = within_walls(&walls, &guess);
            match polish_chain(&model, &walls, guess) {
                Ok(extremal) => return self.kept(value, &model, extremal),
                Err(error) => reason = error.to_string(),
            }
        }
        if here.gait.symmetric {
            return Err(reason);
        }
        // The first shape of a closed chain is held on a line, which may no longer be suitable.
        let curve = here.gait.gait().map_err(|error| error.to_string())?;
        self.polished(value, &curve, false).map_err(|_| reason)
    }

    fn other_side(&self, before: &BranchPoint, last: &BranchPoint) -> Option<OtherSide> {
        let model = self.model(before.value).ok()?;
        let other = other_side(&model, before.extremal.as_ref()?, last.extremal.as_ref()?)?;
        Some(OtherSide {
            value: before.value,
            efficiency: other.efficiency(&model),
            start_angle: other.start().x,
            ascent_directions: other.ascents(&model),
        })
    }
}
