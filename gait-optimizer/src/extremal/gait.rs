//! From an extremal to a gait with its certificate.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, Bounds, Objective};
use swimmer_model::{Gait, Model, Stroke, Swimmer, Tolerance, swim};

use super::evidence::{Evidence, follow};
use super::sampled::sampled;
use super::shooting::Class;
use super::wall::Walls;
use super::{Extremal, Unpolished};
use crate::certificate::{Certificate, Condition};
use crate::certify::slopes_open;
use crate::optimal_gait::OptimalGait;

/// Samples of a cycle are not made more beyond this.
const MOST_SAMPLES: usize = 8192;

/// What a gait is made for.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Order<'a> {
    /// The swimmer as it is, and the model of the same with L = 1.
    pub(crate) swimmer: &'a Swimmer<f64>,
    pub(crate) model: &'a Model<f64>,
    pub(crate) bounds: &'a Bounds,
    /// Samples of a cycle.
    pub(crate) samples: usize,
}

/// An extremal as a gait, with all its checks; whether they pass is for the caller to see. Where the interpolated samples do
/// not keep the power constant, or leave its slopes open where [`certify`](crate::certify()) asks for them, there are more of them
/// than were asked for.
pub(crate) fn gait(order: &Order<'_>, extremal: &Extremal) -> Result<OptimalGait, Unpolished> {
    let Order { model, .. } = *order;
    let walls = Walls::new(order.bounds, &order.swimmer.links);
    let (chain, class) = (&extremal.solved.chain, extremal.class);
    let parts = if class == Class::Quarter { 4 } else { 1 };
    let lost = || Unpolished::Trace;
    let evidence = follow(model, &walls, chain).ok_or_else(lost)?;
    let mut samples = order.samples / parts;
    let (cycle, curve, variation) = loop {
        let cycle = sampled(model, class, chain, samples).ok_or_else(lost)?;
        let curve = cycle.gait().map_err(|_| lost())?;
        let variation = power_variation(model, &cycle.u, &curve);
        // The power varies by the third power of the samples' distance, slopes are open by the sixth.
        let off = (variation / Condition::ConstantPowerOfSamples.tolerance()).cbrt();
        let off = off.max(slopes_open(&cycle).powf(1.0 / 6.0));
        if off <= 1.0 || samples * parts > MOST_SAMPLES {
            break (cycle, curve, variation);
        }
        samples = more(samples, off);
    };
    let stroke = swim(model, &curve, &Tolerance::new(1e-12));
    let certificate = certificate(model, extremal, &walls, (&evidence, &stroke), variation);
    let symmetric = class == Class::Quarter;
    let [x, y] = if symmetric {
        [4.0 * evidence.displacement.x, 0.0]
    } else {
        evidence.displacement.into()
    };
    let of = (Objective::Efficiency, order.swimmer, order.bounds);
    Ok(OptimalGait {
        // The arcs know these closer than the samples do.
        efficiency: extremal.efficiency(model),
        displacement_over_length: x,
        lateral_over_length: y,
        displacement: x * order.swimmer.total_length(),
        certificate,
        ..OptimalGait::of_cycle(of, symmetric, cycle, &stroke)
    })
}

/// So many samples that they should suffice where they are too far apart by this factor.
fn more(samples: usize, off: f64) -> usize {
    let factor = (1.1 * off).clamp(1.1, 2.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some thousands
    let more = (samples as f64 * factor).ceil() as usize;
    more
}

/// What the arcs tell, known to rounding and at once: [`certify`](crate::certify()) sees samples and a few waves alone, and takes as
/// long as the search.
fn certificate(
    model: &Model<f64>,
    extremal: &Extremal,
    walls: &Walls,
    (evidence, stroke): (&Evidence, &Stroke<f64>),
    power_variation: f64,
) -> Certificate {
    let first = extremal.solved.chain.states.first();
    let p = first.map_or(Vector2::repeat(f64::NAN), |z| Vector2::new(z[3], z[4]));
    let d = stroke.displacement;
    let mut checks = vec![
        Condition::ShootingResidual.check(extremal.solved.residual),
        Condition::FollowedAgain.check(evidence.off_extremal),
        Condition::PowerFollowedAgain.check(evidence.power[1] - evidence.power[0]),
        Condition::MomentumOfPose.check(evidence.momentum),
        Condition::MomentumAlongDisplacement.check((d.perp(&p) / (d.norm() * p.norm())).abs()),
        Condition::MomentumScale.check((p.norm() * d.norm() / stroke.power_length - 1.0).abs()),
        Condition::NoRotation.check(stroke.rotation.abs()),
        Condition::ConstantPowerOfSamples.check(power_variation),
        Condition::EfficiencySwumAgain
            .check((stroke.efficiency_constant_power() / extremal.efficiency(model) - 1.0).abs()),
    ];
    checks.extend(
        evidence
            .multiplier
            .map(|least| Condition::EffortOnBound.check(least)),
    );
    if walls.nearest(&Vector2::zeros()).is_some() {
        checks.push(Condition::KeepsWalls.check(evidence.overstepped));
    }
    let none_of = |ascents: Option<usize>| ascents.map_or(f64::NAN, |count| count as f64);
    checks.push(Condition::NoAscent.check(none_of(extremal.ascents(model))));
    if extremal.class == Class::Quarter {
        let ascents = none_of(extremal.ascents_without_symmetry(model));
        checks.push(Condition::NoAscentWithoutSymmetry.check(ascents));
    }
    Certificate::new(checks)
}

/// (max − min)/mean of the power in the middle of the samples' intervals.
fn power_variation(model: &Model<f64>, u: &[f64], gait: &AnyGait) -> f64 {
    let (mut least, mut most, mut sum) = (f64::INFINITY, 0.0_f64, 0.0);
    for [from, to] in u.array_windows() {
        let middle = gait.at(0.5 * (from + to));
        let power = middle
            .rate
            .dot(&(model.power_matrix(&middle.phi) * middle.rate));
        least = least.min(power);
        most = most.max(power);
        sum += power;
    }
    (most - least) * (u.len() - 1) as f64 / sum
}
