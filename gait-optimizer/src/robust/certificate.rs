//! Conditions of a robust gait's certificate that do not depend on its family: bounds, the curve itself, and every value by the
//! model's own integration.

use swimmer_files::Bounds;
use swimmer_model::Links;

use super::Values;
use super::ensemble::{Ensemble, RobustSolution};
use super::newton::Design;
use crate::certificate::{Check, Condition, simple_and_turning_once};
use crate::cycle::Cycle;
use crate::member::Member;
use crate::numerics::worse;
use crate::region::Region;

/// Conditions that the bounds hold and that the curve is simple and turns once.
pub(super) fn of_curve(cycle: &Cycle, bounds: &Bounds, links: &Links<f64>) -> Vec<Check> {
    let overstepped = overstepped(cycle, bounds, links);
    let mut checks = Vec::new();
    if overstepped > f64::NEG_INFINITY {
        checks.push(Condition::KeepsBounds.check(overstepped));
    }
    checks.extend(simple_and_turning_once(&cycle.phi, &cycle.phi));
    checks
}

/// Largest violation of the bounds that hold in all quarters \[rad\]; the families do not support the others.
pub(super) fn overstepped(cycle: &Cycle, bounds: &Bounds, links: &Links<f64>) -> f64 {
    let full = Bounds {
        min_angle: None,
        sector: false,
        ..*bounds
    };
    let region = Region::new(&full, links);
    let by = cycle.phi.iter().map(|phi| region.overstepped(phi));
    by.fold(f64::NEG_INFINITY, worse)
}

/// Conditions that all values agree with the model's own integration and with a new search for the worst case, and that the active
/// members have the value of the worst case.
pub(super) fn swum_again<D: Design>(
    ensemble: &Ensemble<'_>,
    design: &D,
    found: &RobustSolution<D::Point>,
    cycle: &Cycle,
    values: &Values,
) -> Vec<Check> {
    let scale = if D::RELATIVE {
        values.nominal.abs()
    } else {
        1.0
    };
    let swum = |member: &Member| {
        let swum = cycle.turned(member.gain).swum(&member.model);
        swum.map_or(f64::NAN, |stroke| design.swum(&found.point, &stroke))
    };
    let again = ensemble.brings(swum, design.unit());
    let mut checks: Vec<Check> = [
        (Condition::NominalSwumAgain, again.nominal - values.nominal),
        (Condition::WorstSwumAgain, again.worst - values.worst),
        (Condition::MeanSwumAgain, again.mean - values.mean),
    ]
    .map(|(condition, off)| condition.check(off.abs() / scale))
    .into();
    if !found.holders().is_empty() {
        let holders = found.holders().iter();
        let (least, apart) = holders.fold((f64::INFINITY, 0.0_f64), |(least, apart), one| {
            let off = (design.unit() * swum(&one.0) - values.worst).abs() / scale;
            (one.1.min(least), if off <= apart { apart } else { off })
        });
        checks.push(Condition::WorstCaseMultiplier.check(least));
        checks.push(Condition::WorstCaseHeld.check(apart));
    }
    checks
}
