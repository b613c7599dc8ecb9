//! Conditions of a fastest gait, evaluated from its curve alone, independent of the search.
//!
//! With p along the net displacement d, V = |d|/T and the height h = μ · F, the costate σ of Φ obeys H = σ·Φ̇ − V ≡ 0,
//! Φ̇ᵢ = ωᵢ sgn σᵢ and σ̇ = h (−Φ̇₂, Φ̇₁) (and η∇g, η ≥ 0, on a bound g ≤ 0). The rates are read off the curve, whose servos run at
//! them. The unknowns follow from the integrals of h between switches by least squares: the multiplier of rotation (and of a
//! prescribed heading), and the jump of σ at each corner on a bound.

mod affine;
mod from_anywhere;
mod legs;
mod second_order;
mod switching;

use nalgebra::Vector2;
use swimmer_files::{AnyGait, ArcKind, Bounds, GaitFile};
use swimmer_model::{Model, Tolerance, crossing_share, swim};

pub(crate) use super::setting::GaitRequirements;
use super::setting::{Goal, Setting};
use crate::certificate::{Certificate, Check, Condition, Dependence, again_within};
use crate::cycle::Cycle;
use crate::member::Member;
use crate::numerics::worse;
use crate::region::Region;
pub(crate) use from_anywhere::{certify_speed, turned_per_period};
use legs::{Leg, Legs};
use switching::Switching;

/// A corner this close to a bound rests on it \[rad, or over L\].
pub(super) const RESTS: f64 = 1e-8;

impl GaitRequirements {
    /// Returns true if gaits join at this shape.
    pub(super) fn joins(&self, phi: &Vector2<f64>) -> bool {
        self.anchor
            .is_some_and(|anchor| (anchor - phi).norm() < RESTS)
    }
}

/// Certifies a cycle as a gait. Returns `None` if its samples are no valid gait.
pub(super) fn of_cycle(
    setting: &Setting,
    bounds: Bounds,
    cycle: &Cycle,
) -> Option<(AnyGait, Certificate)> {
    let gait = cycle.gait().ok()?;
    let file = cycle.file(bounds);
    let of = (setting.model, setting.members);
    let certificate = certificate(of, setting.region, setting.asked, &file, &gait);
    Some((gait, certificate))
}

/// Certifies one cycle with its timing, for the swimmer with L = 1, or for the weighted displacement of the members if there are any.
pub(crate) fn certificate(
    (model, members): (&Model<f64>, &[(Member, f64)]),
    region: &Region,
    asked: GaitRequirements,
    file: &GaitFile,
    gait: &AnyGait,
) -> Certificate {
    let mut checks = of_the_curve(model, region, file, gait);
    let Some(legs) = Legs::new((model, members), region, asked.goal, file, gait) else {
        checks.push(Condition::Moves.check(1.0));
        return Certificate::new(checks);
    };
    let stroke = swim(model, gait, &Tolerance::default());
    let [x, y, turned] = legs.end;
    let apart = (stroke.displacement.x - x).hypot(stroke.displacement.y - y);
    checks.push(Condition::DisplacementSteppedAgain.within(apart, again_within(x.hypot(y))));
    match asked.goal {
        Goal::Distance => checks.push(Condition::NoRotation.check(stroke.rotation.abs())),
        Goal::Rotation => checks.push(
            Condition::RotationSteppedAgain
                .within((stroke.rotation - turned).abs(), again_within(turned)),
        ),
    }
    if let Some(anchor) = asked.anchor {
        let least = file.phi.iter().map(|phi| (phi - anchor).norm());
        let off = least.fold(f64::INFINITY, f64::min);
        checks.push(Condition::PassesJoint.check(off));
    }
    checks.push(Condition::FullRate.check(legs.off_full_rate()));
    let off_heading = asked.heading.off(legs.heading());
    if let Some(off) = off_heading.filter(|_| asked.goal == Goal::Distance) {
        checks.push(Condition::Heading.check(off.abs()));
    }
    let switching = Switching::new(region, &legs, asked);
    checks.extend(switching.checks());
    let setting = Setting {
        model,
        region,
        rates: legs.rates,
        // Times are shares of the period here.
        asked: GaitRequirements {
            period: asked.period.map(|_| 1.0),
            ..asked
        },
        members,
    };
    match second_order::least(&setting, &legs) {
        // No direction keeps all constraints.
        Some(f64::INFINITY) => {}
        Some(least) if least.is_finite() => {
            checks.push(Condition::NoBetterCorners.check(least));
        }
        _ => checks.push(Condition::EnoughArcs.check(0.0)),
    }
    Certificate::new(checks)
}

/// Closure, bounds and links.
fn of_the_curve(
    model: &Model<f64>,
    region: &Region,
    file: &GaitFile,
    gait: &AnyGait,
) -> Vec<Check> {
    let gap = match (file.phi.first(), file.phi.last()) {
        (Some(first), Some(last)) => (last - first).norm(),
        _ => f64::NAN,
    };
    let mut checks = vec![Condition::Closed.check(gap)];
    if region.bounds().next().is_some() {
        let overstepped = file
            .phi
            .iter()
            .map(|phi| region.overstepped(phi))
            .fold(f64::NEG_INFINITY, worse);
        checks.push(Condition::KeepsBounds.check(overstepped));
    }
    if file.bounds.no_overlap {
        let crosses = crossing_share(&model.swimmer().links, gait);
        let folds = if crosses.folds { 1.0 } else { 0.0 };
        checks.push(Condition::NothingFolded.check(folds));
    }
    let checks = checks.into_iter();
    checks
        .map(|check| check.depends_on(Dependence::Samples))
        .collect()
}

/// Returns true if an arc lies on a bound.
pub(super) fn on_bound(leg: &Leg) -> bool {
    matches!(
        leg.kind,
        ArcKind::Upper | ArcKind::Clearance | ArcKind::Lower | ArcKind::Diagonal
    )
}
