//! Conversion of an extremal to a gait with its certificate.

use swimmer_files::{AnyGait, Bounds, Objective};
use swimmer_model::{Gait, Model, Swimmer, Tolerance, swim};

use super::{Extremal, Unpolished};
use crate::certificate::Condition;
use crate::certify::{certified, slopes_open};
use crate::cycle::power;
use crate::optimal_gait::OptimalGait;

/// Largest number of samples of a cycle.
const MOST_SAMPLES: usize = 8192;
/// Largest variation of the power between samples, over its mean.
const CONSTANT_POWER: f64 = 1e-6;

/// Converts an extremal to a gait of a swimmer, whose model has L = 1, with its certificate, which the caller inspects. The number of
/// samples is raised if their interpolation does not keep the power constant or the slopes are too inaccurate for the certificate.
pub(crate) fn gait(
    (swimmer, model, bounds): (&Swimmer<f64>, &Model<f64>, &Bounds),
    extremal: &Extremal,
    mut samples: usize,
) -> Result<OptimalGait, Unpolished> {
    let (cycle, curve) = loop {
        let cycle = extremal.cycle(model, samples).ok_or(Unpolished::Trace)?;
        let curve = cycle.gait().map_err(|_| Unpolished::Trace)?;
        // The variation of the power is of third order in the spacing of the samples, the error of the slopes of sixth order.
        let off = (power_variation(model, &cycle.u, &curve) / CONSTANT_POWER).cbrt();
        let off = off.max(slopes_open(&cycle).powf(1.0 / 6.0));
        if off <= 1.0 || samples > MOST_SAMPLES {
            break (cycle, curve);
        }
        samples = more(samples, off);
    };
    let symmetric = extremal.is_quarter();
    let stroke = swim(model, &curve, &Tolerance::new(1e-12));
    let of = (Objective::Efficiency, swimmer, bounds);
    // The arcs are more accurate than the samples: d is parallel to p, and p · d is the length.
    let (d, efficiency) = (extremal.displacement(), extremal.efficiency(model));
    let mut gait = certified(OptimalGait {
        efficiency,
        displacement_over_length: d.x,
        lateral_over_length: d.y,
        displacement: d.x * swimmer.total_length(),
        ..OptimalGait::of_cycle(of, symmetric, cycle, &stroke)
    });
    // Values of the arcs against the integrated samples.
    let swum = stroke.displacement;
    gait.certificate = gait.certificate.with(vec![
        Condition::ShootingResidual.check(extremal.residual),
        Condition::MomentumAlongDisplacement
            .check((swum.perp(&d) / (swum.norm() * d.norm())).abs()),
        Condition::MomentumScale.check((swum.norm() / d.norm() - 1.0).abs()),
        Condition::EfficiencySwumAgain
            .check((stroke.efficiency_constant_power() / efficiency - 1.0).abs()),
    ]);
    Ok(gait)
}

/// Number of samples that reduces the spacing by this factor.
fn more(samples: usize, off: f64) -> usize {
    let factor = (1.1 * off).clamp(1.1, 2.0);
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some thousands
    let more = (samples as f64 * factor).ceil() as usize;
    more
}

/// (max − min)/mean of the power at the midpoints of the samples.
fn power_variation(model: &Model<f64>, u: &[f64], gait: &AnyGait) -> f64 {
    let (mut least, mut most, mut sum) = (f64::INFINITY, 0.0_f64, 0.0);
    for [from, to] in u.array_windows() {
        let middle = gait.at(0.5 * (from + to));
        let power = power(model, &middle.phi, &middle.rate);
        least = least.min(power);
        most = most.max(power);
        sum += power;
    }
    (most - least) * (u.len() - 1) as f64 / sum
}
