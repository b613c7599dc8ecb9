//! Max–min problem: the gait with the best worst case, by an active-set method.
//!
//! The KKT conditions are Σ λₖ ∇fₖ = 0 with λₖ ≥ 0, Σ λₖ = 1, and λₖ > 0 only if fₖ is the least. The gait is therefore the best for a
//! weighted mean. The active set is updated by adding the worst member, equalising the active members, and dropping those with a
//! negative weight. The worst member is searched over the whole ensemble, so an active member moves with the gait until it is a
//! minimum.

use nalgebra::{DMatrix, DVector};

use super::ensemble::{Ensemble, Lowest, RobustSolution};
use super::newton::Design;
use super::{Over, RobustError};
use crate::member::Member;

/// Gait with its active members and their multipliers.
#[derive(Debug, Clone)]
pub(super) struct Held<P> {
    pub(super) point: P,
    pub(super) members: Vec<(Lowest, f64)>,
}

const EXCHANGES: usize = 30;
const STEPS: usize = 30;
/// Relative difference below which values are equal.
const EQUAL: f64 = 1e-11;
const DIFFERENCE: f64 = 1e-4;

impl<P> Held<P> {
    pub(super) fn weighted(&self) -> Vec<(Member, f64)> {
        let members = self.members.iter();
        members.map(|(one, weight)| (one.member, *weight)).collect()
    }
}

/// Best gait over the uncertainty.
pub(super) fn find<D: Design>(
    design: &D,
    ensemble: &Ensemble<'_>,
    over: Over,
) -> Result<RobustSolution<D::Point>, RobustError> {
    if over == Over::Mean {
        return Ok(RobustSolution {
            over,
            point: ensemble.solve(design, &design.start(), &ensemble.normal)?,
            weighted: ensemble.normal.clone(),
        });
    }
    let held = worst(design, ensemble)?;
    Ok(RobustSolution {
        over,
        weighted: held.weighted(),
        point: held.point,
    })
}

/// Gait with the best worst case.
fn worst<D: Design>(design: &D, ensemble: &Ensemble<'_>) -> Result<Held<D::Point>, RobustError> {
    let mut held = Held {
        point: design.start(),
        members: Vec::new(),
    };
    let mut apart = f64::INFINITY;
    for _ in 0..EXCHANGES {
        let value = |member: &Member| design.value(&held.point, member);
        let Some(lowest) = ensemble.lowest(value) else {
            break;
        };
        let level = held.members.iter().map(|(one, _)| value(&one.member));
        let level = level.fold(f64::INFINITY, f64::min);
        apart = (level - lowest.value) / level.abs();
        if apart <= 10.0 * EQUAL {
            return Ok(held);
        }
        let mut known = held.members.iter_mut();
        if let Some((one, _)) = known.find(|(one, _)| ensemble.is_same(one, &lowest)) {
            *one = lowest;
        } else {
            let weight = if held.members.is_empty() { 1.0 } else { 0.0 };
            held.members.push((lowest, weight));
        }
        equalise(design, ensemble, &mut held)?;
    }
    Err(RobustError::NotConverged { residual: apart })
}

/// Solves for the weights at which all active members have the same value; members whose weight becomes negative are dropped.
pub(super) fn equalise<D: Design>(
    design: &D,
    ensemble: &Ensemble<'_>,
    held: &mut Held<D::Point>,
) -> Result<(), RobustError> {
    let mut left = f64::INFINITY;
    for _ in 0..STEPS {
        held.point = ensemble.solve(design, &held.point, &held.weighted())?;
        let (apart, scale) = differences(design, held);
        left = apart.amax() / scale;
        if held.members.len() < 2 || left <= EQUAL {
            return Ok(());
        }
        // Derivatives of the differences by the weights of all members except the first.
        let columns: Result<Vec<DVector<f64>>, RobustError> = (1..held.members.len())
            .map(|i| {
                let mut other = held.clone();
                shift(&mut other.members, i, DIFFERENCE);
                other.point = ensemble.solve(design, &held.point, &other.weighted())?;
                Ok((differences(design, &other).0 - &apart) / DIFFERENCE)
            })
            .collect();
        let step = DMatrix::from_columns(&columns?).lu().solve(&apart);
        let Some(step) = step.filter(|step| step.iter().all(|s| s.is_finite())) else {
            break;
        };
        for (i, by) in step.iter().enumerate() {
            shift(&mut held.members, i + 1, -by.clamp(-0.5, 0.5));
        }
        if let Some(negative) = held.members.iter().position(|(_, weight)| *weight < 0.0) {
            held.members.remove(negative);
            let total: f64 = held.members.iter().map(|(_, weight)| weight.max(0.0)).sum();
            for (_, weight) in &mut held.members {
                *weight = if total > 0.0 {
                    weight.max(0.0) / total
                } else {
                    1.0
                };
            }
        }
    }
    Err(RobustError::NotConverged { residual: left })
}

/// Transfers weight from the first active member to member `i`.
fn shift(members: &mut [(Lowest, f64)], i: usize, by: f64) {
    members[i].1 += by;
    members[0].1 -= by;
}

/// Difference of each active member's value from the first one's, and the scale of the values.
fn differences<D: Design>(design: &D, held: &Held<D::Point>) -> (DVector<f64>, f64) {
    let values = held.members.iter();
    let values: Vec<f64> = values
        .map(|(one, _)| design.value(&held.point, &one.member))
        .collect();
    let first = values.first().copied().unwrap_or(f64::NAN);
    let apart = values.iter().skip(1).map(|value| value - first);
    let apart = DVector::from_iterator(values.len().saturating_sub(1), apart);
    (apart, first.abs())
}
