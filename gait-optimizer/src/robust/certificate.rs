//! What a robust gait's certificate holds: first-order conditions of the weighted objective, second-order ones, bounds, the
//! curve itself, and every value swum again by the model's own integration.

use nalgebra::DVector;
use swimmer_files::Bounds;
use swimmer_model::{Links, Model, Stroke};

use super::arcs::Arcs;
use super::fourier::FourierFamily;
use super::{Ensemble, Values};
use crate::Check;
use crate::certificate::simple_and_turning_once;
use crate::cycle::Cycle;
use crate::region::Region;

/// The ensemble maximum principle.
pub(super) fn of_arcs(
    family: &Arcs,
    x: &DVector<f64>,
    members: &[(&Model<f64>, f64)],
) -> Vec<Check> {
    let evidence = family.evidence(x, members);
    let mut checks = vec![
        Check::at_most("robust_height", evidence.free_height, 1e-8),
        Check::at_least(
            "robust_legendre_clebsch_least",
            evidence.legendre_clebsch,
            1e-6,
        ),
    ];
    checks.extend(
        evidence
            .multiplier
            .map(|least| Check::at_least("robust_bound_multiplier_least", least, -1e-9)),
    );
    checks
}

/// Stationary, and a maximum.
pub(super) fn of_series(
    family: &FourierFamily,
    x: &DVector<f64>,
    members: &[(&Model<f64>, f64)],
) -> Vec<Check> {
    vec![
        Check::at_most("robust_gradient", family.gradient_norm(x, members), 1e-8),
        Check::at_most(
            "robust_curvature",
            family.largest_curvature(x, members),
            0.0,
        ),
    ]
}

/// Bounds kept, a simple curve that turns once.
pub(super) fn of_curve(cycle: &Cycle, bounds: &Bounds, links: &Links<f64>) -> Vec<Check> {
    // Those that hold all round; the family has none of the others.
    let full = Bounds {
        min_angle: None,
        sector: false,
        ..*bounds
    };
    let region = Region::new(&full, links);
    let overstepped = cycle
        .phi
        .iter()
        .map(|phi| {
            let beyond = bounds
                .max_angle
                .map_or(f64::NEG_INFINITY, |max| phi.amax() - max);
            region.overstepped(phi).max(beyond)
        })
        .fold(f64::NEG_INFINITY, f64::max);
    let mut checks = Vec::new();
    if overstepped > f64::NEG_INFINITY {
        checks.push(Check::at_most("bound_overstepped_rad", overstepped, 1e-10));
    }
    checks.extend(simple_and_turning_once(&cycle.phi, &cycle.phi));
    checks
}

/// X of all members swum again.
pub(super) fn of_displacement(
    ensemble: &Ensemble,
    cycle: &Cycle,
    values: &Values,
    sign: f64,
    held_by: &[[f64; 3]],
) -> Vec<Check> {
    again(
        ensemble,
        cycle,
        values,
        held_by,
        1.0,
        |stroke| sign * stroke.displacement.x,
        sign,
    )
}

/// ξ of all members swum again.
pub(super) fn of_efficiency(
    ensemble: &Ensemble,
    cycle: &Cycle,
    values: &Values,
    held_by: &[[f64; 3]],
) -> Vec<Check> {
    let scale = values.nominal.abs();
    again(
        ensemble,
        cycle,
        values,
        held_by,
        scale,
        Stroke::efficiency,
        1.0,
    )
}

fn again(
    ensemble: &Ensemble,
    cycle: &Cycle,
    values: &Values,
    held_by: &[[f64; 3]],
    scale: f64,
    value: impl Fn(&Stroke<f64>) -> f64,
    sign: f64,
) -> Vec<Check> {
    let swum = |model: &Model<f64>| cycle.swum(model);
    let of = |model: &Model<f64>| swum(model).map_or(f64::NAN, |stroke| value(&stroke));
    let nominal = swum(&ensemble.nominal);
    let worst = ensemble
        .candidates
        .iter()
        .map(of)
        // Unlike f64::min this keeps a NaN.
        .fold(
            f64::INFINITY,
            |least, one| if one >= least { least } else { one },
        );
    let mean: f64 = ensemble
        .normal
        .iter()
        .zip(&ensemble.weights)
        .map(|(model, weight)| of(model) * weight)
        .sum();
    let off = |found: f64, told: f64| (found - sign * told).abs() / scale;
    let mut checks = vec![
        Check::at_most(
            "nominal_swum_again",
            off(nominal.as_ref().map_or(f64::NAN, &value), values.nominal),
            1e-8,
        ),
        Check::at_most("worst_swum_again", off(worst, values.worst), 1e-8),
        Check::at_most("mean_swum_again", off(mean, values.mean), 1e-8),
        Check::at_most(
            "net_lateral",
            nominal.map_or(f64::NAN, |stroke| stroke.displacement.y.abs()),
            1e-8,
        ),
        Check::at_most(
            "net_rotation_rad",
            nominal.map_or(f64::NAN, |stroke| stroke.rotation.abs()),
            1e-8,
        ),
    ];
    let least = held_by
        .iter()
        .map(|[_, _, weight]| *weight)
        .fold(f64::INFINITY, f64::min);
    if least.is_finite() {
        checks.push(Check::at_least("worst_case_multiplier_least", least, 0.0));
    }
    checks
}
