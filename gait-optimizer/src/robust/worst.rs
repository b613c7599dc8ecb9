//! Max–min: the gait whose worst member fares best.
//!
//! At such a gait Σ λₖ ∇fₖ = 0 with λₖ ≥ 0, Σ λₖ = 1, and λₖ > 0 only where fₖ is the least: the gait is the best for a
//! weighted mean, and the weights are found by adding the worst member, making the active ones equal, and dropping those
//! whose weight would be negative. The worst member is looked for over all that is left open, so an active one moves along with
//! the gait until it is a minimum.

use nalgebra::{DMatrix, DVector};

use super::ensemble::{Ensemble, Found, Lowest};
use super::newton::Design;
use super::{Over, RobustError};
use crate::member::Member;

/// A gait with the members that hold it, each with its multiplier.
#[derive(Debug, Clone)]
pub(super) struct Held<P> {
    pub(super) point: P,
    pub(super) members: Vec<(Lowest, f64)>,
}

const EXCHANGES: usize = 30;
const STEPS: usize = 30;
/// Values this close, relatively, are equal.
const EQUAL: f64 = 1e-11;
const DIFFERENCE: f64 = 1e-4;

impl<P> Held<P> {
    pub(super) fn weighted(&self) -> Vec<(Member, f64)> {
        let members = self.members.iter();
        members.map(|(one, weight)| (one.member, *weight)).collect()
    }
}

/// The gait that is the best over the uncertainty.
pub(super) fn find<D: Design>(
    design: &D,
    ensemble: &Ensemble<'_>,
    over: Over,
) -> Result<Found<D::Point>, RobustError> {
    if over == Over::Mean {
        return Ok(Found {
            over,
            point: ensemble.solve(design, &design.start(), &ensemble.normal)?,
            weighted: ensemble.normal.clone(),
        });
    }
    let held = worst(design, ensemble)?;
    Ok(Found {
        over,
        weighted: held.weighted(),
        point: held.point,
    })
}

/// The gait of the best worst case.
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

/// Solves for the weights at which all active members fare alike; members whose weight turns negative are dropped.
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
        // How the differences answer to the weights of all but the first member.
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

/// Moves weight to active member `i` from the first.
fn shift(members: &mut [(Lowest, f64)], i: usize, by: f64) {
    members[i].1 += by;
    members[0].1 -= by;
}

/// Value of each active member but the first, less the first's; and their size.
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
