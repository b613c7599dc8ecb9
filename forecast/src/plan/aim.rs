//! Aim correction: shifts the target of a chain of legs until the chain, as the robot plays it, ends at the true target.

use swimmer_model::{Model, Pose};

use super::budget::Budget;
use super::legs::settled;
use super::member::Nets;
use super::{Family, PlanError, PlanRequest, Step, distance};
use crate::path::Polyline;
use crate::playlist::{PlaylistTable, leads_to, played, refused, tables};

/// Largest number of corrections.
const SHOTS: usize = 12;
/// Miss at which the correction ends \[m, rad\]: the resolution of the table is no better.
const GOOD: [f64; 2] = [2e-5, 2e-4];
/// Largest miss of an accepted chain \[m, rad\].
const ACCEPTED: [f64; 2] = [5e-4, 5e-3];

pub(super) struct Aim<'a> {
    pub(super) model: &'a Model<f64>,
    pub(super) family: &'a Family,
    pub(super) request: &'a PlanRequest,
    pub(super) nets: &'a Nets,
    pub(super) way_in: Pose<f64>,
}

/// Chain to be corrected, by its legs alone: the many small cycles of an approach along a wall would magnify every correction.
pub(super) struct Chain<'a> {
    pub(super) out: &'a [Step],
    pub(super) legs: Vec<Step>,
    pub(super) back: Vec<Step>,
}

impl Chain<'_> {
    fn steps(&self) -> Vec<Step> {
        [self.out, &self.legs, &self.back].concat()
    }
}

/// Chain that meets its target when played.
pub(super) struct Hit {
    pub(super) steps: Vec<Step>,
    pub(super) reached: Pose<f64>,
    pub(super) way: Polyline,
    off: [f64; 2],
}

impl Aim<'_> {
    /// Plays a chain and corrects its aim. Returns `None` if it does not meet the target. `begun`: pose at the common shape.
    pub(super) fn hit(
        &self,
        begun: &Pose<f64>,
        mut chain: Chain<'_>,
        budget: &mut Budget<'_>,
    ) -> Result<Option<Hit>, PlanError> {
        let [out, legs, back] =
            [chain.out, &chain.legs, &chain.back].map(|steps| self.nets.after(steps));
        // Where any heading will do, the one that the chain was made for.
        let heading = (*begun * out * legs * back * self.way_in.inverse()).theta;
        let target = Pose::new(
            self.request.to.x,
            self.request.to.y,
            self.request.heading.unwrap_or(heading),
        );
        let mut aimed_at = target;
        let mut best: Option<Hit> = None;
        for _ in 0..SHOTS {
            let shot = self.play(&target, chain.steps())?;
            budget.spend(shot.way.vertices().len());
            // Distance of the played end from the end at which the model was aimed.
            let missed_by = aimed_at.inverse() * shot.reached;
            aimed_at = target * missed_by.inverse();
            let good = shot.off[0] < GOOD[0] && shot.off[1] < GOOD[1];
            if best
                .as_ref()
                .is_none_or(|best| shot.badness() < best.badness())
            {
                best = Some(shot);
            }
            if good {
                break;
            }
            let wanted = (*begun * out).inverse() * (aimed_at * self.way_in) * back.inverse();
            let Some(mut next) = settled(self.nets, &wanted, &chain.legs, 1.0) else {
                break;
            };
            // The played motion jumps by a tick where the period does: let it jump once.
            for (next, before) in next.iter_mut().zip(&chain.legs) {
                if next.cycles == before.cycles {
                    next.period = next.period.max(before.period);
                }
            }
            chain.legs = next;
        }
        Ok(best.filter(|best| best.off[0] < ACCEPTED[0] && best.off[1] < ACCEPTED[1]))
    }

    fn play(&self, target: &Pose<f64>, steps: Vec<Step>) -> Result<Hit, PlanError> {
        let tables = self.tables(&steps)?;
        let way = played(&tables, &self.request.servos);
        let reached = self.request.from * leads_to(self.model, &way);
        Ok(Hit {
            steps,
            off: distance(&reached, target),
            reached,
            way,
        })
    }

    fn tables(&self, steps: &[Step]) -> Result<Vec<PlaylistTable>, PlanError> {
        let word = |step: usize| {
            steps
                .get(step)
                .map_or("last", |step| step.member.word(self.family.mirrored))
        };
        let played: Vec<_> = steps
            .iter()
            .map(|step| step.repeated(self.family))
            .collect();
        let tables = tables(&played).map_err(|error| PlanError::Refused {
            gait: word(0),
            reason: error.to_string(),
        })?;
        let links = &self.model.swimmer().links;
        match refused(&tables, &self.request.servos, links) {
            Some((step, reason)) => Err(PlanError::Refused {
                gait: word(step),
                reason,
            }),
            None => Ok(tables),
        }
    }
}

impl Hit {
    /// Metres and the tenth of a radian count alike.
    fn badness(&self) -> f64 {
        self.off[0] + 0.1 * self.off[1]
    }
}
