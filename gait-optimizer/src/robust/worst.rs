//! Max–min: the gait whose worst member fares best.
//!
//! At such a gait Σ λₖ ∇fₖ = 0 with λₖ ≥ 0, Σ λₖ = 1, and λₖ > 0 only where fₖ is the least: the gait is the best for a
//! weighted mean, and the weights are found by adding the worst member, making the active ones equal, and dropping those
//! whose weight would be negative.

use nalgebra::{DMatrix, DVector};
use swimmer_model::Model;

use super::RobustError;
use super::newton::Design;

/// A gait with the members that hold it.
#[derive(Debug, Clone)]
pub(super) struct Held {
    pub(super) x: DVector<f64>,
    /// Member and multiplier.
    pub(super) active: Vec<(usize, f64)>,
}

const EXCHANGES: usize = 30;
const STEPS: usize = 30;
/// Values this close, relatively, are equal.
const EQUAL: f64 = 1e-11;
const DIFFERENCE: f64 = 1e-4;

/// The gait of the best worst case among `members`.
pub(super) fn worst(design: &impl Design, members: &[Model<f64>]) -> Result<Held, RobustError> {
    let mut x = design.start();
    let mut active: Vec<(usize, f64)> = Vec::new();
    for _ in 0..EXCHANGES {
        let values = design.values(&x, members);
        let Some((least, value)) = values
            .iter()
            .copied()
            .enumerate()
            .min_by(|a, b| a.1.total_cmp(&b.1))
        else {
            break;
        };
        let level = active
            .iter()
            .filter_map(|(member, _)| values.get(*member))
            .copied()
            .fold(f64::INFINITY, f64::min);
        if value >= level - 10.0 * EQUAL * level.abs() {
            return Ok(Held { x, active });
        }
        let weight = if active.is_empty() { 1.0 } else { 0.0 };
        active.push((least, weight));
        x = equalise(design, members, &mut active, x)?;
    }
    Err(RobustError::NotConverged { residual: f64::NAN })
}

/// Solves for the weights at which all active members fare alike; members whose weight turns negative are dropped.
fn equalise(
    design: &impl Design,
    members: &[Model<f64>],
    active: &mut Vec<(usize, f64)>,
    mut x: DVector<f64>,
) -> Result<DVector<f64>, RobustError> {
    for _ in 0..STEPS {
        x = solve(design, members, active, &x)?;
        let apart = differences(design, members, active, &x);
        let scale = design
            .values(&x, members)
            .iter()
            .fold(0.0, |a: f64, b| a.max(b.abs()));
        if active.len() < 2 || apart.amax() <= EQUAL * scale {
            return Ok(x);
        }
        // How the differences answer to the weights of all but the first member.
        let columns: Result<Vec<DVector<f64>>, RobustError> = (1..active.len())
            .map(|i| {
                let shifted = shift(active, i, DIFFERENCE);
                let there = solve(design, members, &shifted, &x)?;
                Ok((differences(design, members, &shifted, &there) - &apart) / DIFFERENCE)
            })
            .collect();
        let step = DMatrix::from_columns(&columns?).lu().solve(&apart);
        let Some(step) = step.filter(|step| step.iter().all(|s| s.is_finite())) else {
            break;
        };
        for (i, by) in step.iter().enumerate() {
            *active = shift(active, i + 1, -by.clamp(-0.5, 0.5));
        }
        if let Some(negative) = active.iter().position(|(_, weight)| *weight < 0.0) {
            active.remove(negative);
            let total: f64 = active.iter().map(|(_, weight)| weight.max(0.0)).sum();
            for (_, weight) in active.iter_mut() {
                *weight = if total > 0.0 {
                    weight.max(0.0) / total
                } else {
                    1.0
                };
            }
        }
    }
    Err(RobustError::NotConverged { residual: f64::NAN })
}

/// Weight moved to active member `i` from the first.
fn shift(active: &[(usize, f64)], i: usize, by: f64) -> Vec<(usize, f64)> {
    let mut shifted = active.to_vec();
    if let Some((_, weight)) = shifted.get_mut(i) {
        *weight += by;
    }
    if let Some((_, weight)) = shifted.first_mut() {
        *weight -= by;
    }
    shifted
}

fn solve(
    design: &impl Design,
    members: &[Model<f64>],
    active: &[(usize, f64)],
    start: &DVector<f64>,
) -> Result<DVector<f64>, RobustError> {
    let weighted: Vec<(&Model<f64>, f64)> = active
        .iter()
        .filter_map(|(member, weight)| Some((members.get(*member)?, *weight)))
        .collect();
    design.solve(start, &weighted)
}

/// Value of each active member but the first, less the first's.
fn differences(
    design: &impl Design,
    members: &[Model<f64>],
    active: &[(usize, f64)],
    x: &DVector<f64>,
) -> DVector<f64> {
    let chosen: Vec<Model<f64>> = active
        .iter()
        .filter_map(|(member, _)| members.get(*member).copied())
        .collect();
    let values = design.values(x, &chosen);
    let first = values.first().copied().unwrap_or(f64::NAN);
    DVector::from_iterator(
        values.len().saturating_sub(1),
        values.iter().skip(1).map(|value| value - first),
    )
}
