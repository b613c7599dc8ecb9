//! A quarter gait traced once more at equal steps of power length: its samples, and the conditions of paper section IV.

mod second_variation;

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::arcs::{Leg, SMOOTH, Trace};
use crate::certificate::{Check, Condition};
use crate::cycle::{Cycle, Samples};
use crate::momentum::{Height, Momentum, Motion, State, pose, shape};
use crate::region::Region;
use second_variation::{Push, Stretch, is_maximum_without_symmetry, least_pivot};

/// What one state of an arc tells.
struct Moment {
    motion: Motion,
    phi: Vector2<f64>,
    height: Height,
    /// What a push does to the displacement there, where pushes are free.
    push: Push,
}

/// A quarter gait, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct QuarterTrace {
    pub(crate) samples: Samples,
    /// Whether it begins and ends square to φ₁ = φ₂ and φ₁ = −φ₂.
    square: [bool; 2],
    /// What its arcs were held against.
    pub(crate) conditions: Vec<Check>,
}

impl QuarterTrace {
    /// Traces the arcs of a quarter. None where an integration fails, or there are no arcs.
    pub(crate) fn new(
        of: (&Model<f64>, Momentum),
        region: &Region,
        legs: &[Leg],
        samples: usize,
    ) -> Option<Self> {
        let z = legs.first()?.from;
        let start = [z[0], z[1], z[2], z[3], z[4], 0.0];
        let route = legs.iter().map(|leg| (leg.motion, leg.to[5] - leg.from[5]));
        let route: Vec<_> = route.collect();
        let trace = Trace::new(of, start, &route, &[], samples)?;
        let mut conditions = conditions(of, region, &trace)?;
        let ends = trace.arcs.iter().filter_map(|(_, states)| states.last());
        let gaps = ends.zip(legs).map(|(end, leg)| shape(end) - shape(&leg.to));
        let retraced = gaps.map(|gap| gap.norm()).fold(0.0, f64::max);
        conditions.push(Condition::Retraced.check(retraced));
        let [first, last] = trace.ends()?;
        // Square to φ₁ = φ₂ (φ₁ = −φ₂) is a direction without a part along it.
        let square = [first.x + first.y, last.x - last.y].map(|along| along.abs() < SMOOTH);
        Some(Self {
            samples: trace.samples(false),
            square,
            conditions,
        })
    }

    pub(crate) fn start(&self) -> Vector2<f64> {
        self.samples.phi.first().copied().unwrap_or_default()
    }

    pub(crate) fn end(&self) -> Vector2<f64> {
        self.samples.phi.last().copied().unwrap_or_default()
    }

    /// The full cycle.
    pub(crate) fn cycle(&self) -> Cycle {
        self.samples.unfolded(self.square)
    }
}

/// The conditions of paper section IV.
fn conditions(
    (model, momentum): (&Model<f64>, Momentum),
    region: &Region,
    trace: &Trace,
) -> Option<Vec<Check>> {
    let first = trace.arcs.first()?.1.first()?;
    let last = trace.arcs.last()?.1.last()?;
    let final_x = last[2];
    let moment = |motion: Motion, z: &State| {
        let (phi, pose) = (shape(z), pose(z));
        let second = model.second_derivatives(&phi);
        let height = momentum.height(&second, &pose);
        let along = height.singular_direction();
        let left = height.gradient.dot(&Vector2::new(-along.y, along.x));
        let curvature = second.first.curvature();
        let push = Push::new(momentum.p.x, &curvature, pose[2], final_x - pose[0], left);
        Moment {
            motion,
            phi,
            height,
            push,
        }
    };
    let arcs: Vec<Vec<Moment>> = trace
        .arcs
        .iter()
        .map(|(motion, states)| states.iter().map(|z| moment(*motion, z)).collect())
        .collect();
    let all = || arcs.iter().flatten();
    let is_free = |moment: &&Moment| moment.motion == Motion::Singular;
    // λ₁, λ₂ from H_u = 0 at the start. On a free arc their equations leave Ḣ_u = h (Φ̇₂, −Φ̇₁); along a bound the multiplier
    // pushes along its normal and keeps H_u as it is.
    let (mut h_u, mut largest_h_u) = (Vector2::zeros(), 0.0_f64);
    let mut free: Vec<Stretch> = Vec::new();
    for [from, to] in arcs.iter().flat_map(|arc| arc.array_windows()) {
        if is_free(&from) {
            let way = to.phi - from.phi;
            let height = 0.5 * (from.height.value + to.height.value);
            h_u += Vector2::new(way.y, -way.x) * height;
            largest_h_u = largest_h_u.max(h_u.norm());
            free.push((from.push, to.push, way.norm()));
        }
    }
    // λ₁ and λ₂ with which `H_u = 0` at a state.
    let costate = |z: &State| {
        let connection = model.local_connection(&shape(z));
        -connection.tr_mul(&momentum.at(&pose(z)))
    };
    let starts = costate(first);
    let ends = costate(last) + h_u;
    let off_lines = (first[0] - first[1]).abs().max((last[0] + last[1]).abs());
    let steepness = |moment: &Moment| moment.height.gradient.norm();
    let off_zero = all().filter(is_free);
    let off_zero = off_zero.map(|moment| moment.height.value.abs() / steepness(moment));
    let mut checks = vec![
        Condition::OnSymmetryLines.check(off_lines),
        Condition::FinalLambda4.check(momentum.at(&pose(last)).z.abs()),
        Condition::StartTransversality.check(starts.sum().abs()),
        Condition::EndTransversality.check((ends.x - ends.y).abs()),
        Condition::StationaryQuarter.check(largest_h_u),
        Condition::OnZeroHeight.check(off_zero.fold(0.0, f64::max)),
    ];
    let steepest = all().map(steepness).fold(0.0, f64::max);
    let clebsch = all().filter(is_free).map(|moment| moment.push.slope);
    let clebsch = clebsch.reduce(f64::min).map(|least| least / steepest);
    checks.extend(clebsch.map(|least| Condition::GrowsInwardsSteeply.check(least)));
    let multipliers = all().filter_map(|moment| match moment.motion {
        Motion::Along(track) => Some(track.way * moment.height.value),
        Motion::Singular => None,
    });
    let least = multipliers.reduce(f64::min);
    checks.extend(least.map(|least| Condition::HeightOnBound.check(least)));
    if !free.is_empty() {
        let least = least_pivot(&free);
        checks.push(Condition::NoConjugatePoint.check(least));
        // Bounds that are told of a quarter mean something for gaits with its symmetries only.
        if !region.is_of_quarters() {
            let best = is_maximum_without_symmetry(&free, 4.0 * final_x);
            let ascents = if best { 0.0 } else { 1.0 };
            checks.push(Condition::NoAscentWithoutSymmetry.check(ascents));
        }
    }
    if region.bounds().next().is_some() {
        let overstepped = all().map(|moment| region.overstepped(&moment.phi));
        let most = overstepped.fold(f64::NEG_INFINITY, f64::max);
        checks.push(Condition::KeepsBounds.check(most));
    }
    Some(checks)
}
