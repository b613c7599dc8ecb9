//! A quarter gait traced once more at equal steps of power length: its samples, and the conditions of paper section IV.

mod second_variation;

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::arcs::{Leg, SMOOTH, Trace};
use crate::certificate::{Check, Condition};
use crate::cycle::{Cycle, Samples};
use crate::momentum::{Momentum, Motion, State, pose, shape};
use crate::region::Region;
use second_variation::{Push, SecondVariation, Stretch, is_maximum_without_symmetry};

/// Numbers gathered along the trace, for the certificate.
struct Evidence<'a> {
    model: &'a Model<f64>,
    momentum: Momentum,
    region: &'a Region,
    /// x at the end.
    final_x: f64,
    /// Largest `|H_u|` that the costate equations leave, over L.
    h_u: f64,
    /// Largest distance of a singular arc from the zero of the height \[rad\].
    off_zero: f64,
    /// Smallest multiplier on a bound; none without such arcs.
    multiplier: Option<f64>,
    /// Smallest slope of the height across a singular arc; none without such arcs.
    legendre_clebsch: Option<f64>,
    /// Largest gradient of the height along the quarter: the scale of that slope.
    steepest: f64,
    /// Stretches of singular arcs, on which pushes are free.
    free: Vec<Stretch>,
    /// Largest overstepping of a bound \[rad\].
    overstepped: f64,
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
    let mut evidence = Evidence {
        model,
        momentum,
        region,
        final_x: last[2],
        h_u: 0.0,
        off_zero: 0.0,
        multiplier: None,
        legendre_clebsch: None,
        steepest: 0.0,
        free: Vec::new(),
        overstepped: f64::NEG_INFINITY,
    };
    // λ₁, λ₂ from H_u = 0 at the start. On a free arc their equations leave Ḣ_u = h (Φ̇₂, −Φ̇₁); along a bound the multiplier
    // pushes along its normal and keeps H_u as it is.
    let mut h_u = Vector2::zeros();
    for (motion, states) in &trace.arcs {
        let mut before: Option<(Vector2<f64>, f64, Option<Push>)> = None;
        for z in states {
            let (height, push) = evidence.evaluate(motion, z);
            let phi = shape(z);
            if let Some((from, lower, last)) = before
                && *motion == Motion::Singular
            {
                let way = phi - from;
                h_u += Vector2::new(way.y, -way.x) * (0.5 * (lower + height));
                evidence
                    .free
                    .extend(last.zip(push).map(|(last, push)| (last, push, way.norm())));
            }
            evidence.h_u = evidence.h_u.max(h_u.norm());
            before = Some((phi, height, push));
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
    let mut checks = vec![
        Condition::OnSymmetryLines.check(off_lines),
        Condition::FinalLambda4.check(momentum.at(&pose(last)).z.abs()),
        Condition::StartTransversality.check(starts.sum().abs()),
        Condition::EndTransversality.check((ends.x - ends.y).abs()),
        Condition::StationaryQuarter.check(evidence.h_u),
        Condition::OnZeroHeight.check(evidence.off_zero),
    ];
    let steepest = evidence.steepest;
    let clebsch = evidence.legendre_clebsch.map(|least| least / steepest);
    checks.extend(clebsch.map(|least| Condition::GrowsInwardsSteeply.check(least)));
    let pushes = evidence.multiplier;
    checks.extend(pushes.map(|least| Condition::HeightOnBound.check(least)));
    if !evidence.free.is_empty() {
        let least = SecondVariation::of(&evidence.free).least;
        checks.push(Condition::NoConjugatePoint.check(least));
        // Bounds that are told of a quarter mean something for gaits with its symmetries only.
        if !region.is_of_quarters() {
            let best = is_maximum_without_symmetry(&evidence.free, 4.0 * evidence.final_x);
            let ascents = if best { 0.0 } else { 1.0 };
            checks.push(Condition::NoAscentWithoutSymmetry.check(ascents));
        }
    }
    if region.bounds().next().is_some() {
        checks.push(Condition::KeepsBounds.check(evidence.overstepped));
    }
    Some(checks)
}

impl Evidence<'_> {
    /// Takes in one state of an arc; the height there, and what a push does to the displacement, where pushes are free.
    fn evaluate(&mut self, motion: &Motion, z: &State) -> (f64, Option<Push>) {
        let (phi, pose) = (shape(z), pose(z));
        let second = self.model.second_derivatives(&phi);
        let height = self.momentum.height(&second, &pose);
        self.overstepped = self.overstepped.max(self.region.overstepped(&phi));
        let slope = height.gradient.norm();
        self.steepest = self.steepest.max(slope);
        if let Motion::Along(track) = motion {
            let multiplier = track.way * height.value;
            let least = self.multiplier.unwrap_or(f64::INFINITY);
            self.multiplier = Some(least.min(multiplier));
            return (height.value, None);
        }
        self.off_zero = self.off_zero.max(height.value.abs() / slope);
        // Slope towards the left of the motion.
        let direction = height.singular_direction();
        let left = height
            .gradient
            .dot(&Vector2::new(-direction.y, direction.x));
        let least = self.legendre_clebsch.unwrap_or(f64::INFINITY);
        self.legendre_clebsch = Some(least.min(left));
        let push = Push::new(
            self.momentum.p.x,
            &second.first.curvature(),
            pose[2],
            self.final_x - pose[0],
            left,
        );
        (height.value, Some(push))
    }
}
