//! A closed loop traced once more from any of its points: sampled at constant power, with the evidence.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitArc};
use swimmer_model::{Model, Stroke};

use super::flow::{ClosedOrbit, Leg};
use super::shooting::Closed;
use crate::certificate::{again_within, simple_and_turning_once};
use crate::cycle::Cycle;
use crate::momentum::{Flow, Momentum, Motion, State, pose, shape};
use crate::region::{Bound, Region};
use crate::runge_kutta::{Point, StepControl, System, advance, locate};
use crate::{Arc, Check};

/// Numbers gathered along the loop. Heights are over L, with p of length 1.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct LoopEvidence {
    /// Largest distance of a singular arc from the zero of the height \[rad\].
    pub(crate) off_zero: f64,
    /// Smallest height on a bound; none without such arcs.
    pub(crate) multiplier: Option<f64>,
    /// Smallest slope of the height to the left of a singular arc.
    pub(crate) legendre_clebsch: Option<f64>,
    /// Largest overstepping of a bound.
    pub(crate) overstepped: f64,
    /// |Φ(end) − Φ(start)| \[rad\].
    pub(crate) closure: f64,
    /// Net rotation \[rad\].
    pub(crate) rotation: f64,
    /// Part of the displacement across the momentum, over L.
    pub(crate) across: f64,
    /// Displacement along the momentum, over L.
    pub(crate) along: f64,
}

/// A loop, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoopTrace {
    pub(crate) cycle: Cycle,
    /// Of the cycle, in order.
    pub(crate) arcs: Vec<Arc>,
    pub(crate) evidence: LoopEvidence,
}

const CONTROL: StepControl = StepControl {
    tolerance: 1e-13,
    longest: f64::INFINITY,
};
/// Fewest samples of an arc: the interpolation takes five on the same side of a corner, and needs more where the arc is
/// curved.
const FEWEST: usize = 8;
const FEWEST_CURVED: usize = 24;
/// Arcs below this share of the cycle are crossings of a corner, not arcs.
const LASTING: f64 = 1e-9;

/// The same dynamics over the power length.
struct ByPower<'a>(Flow<'a>);

impl System<6> for ByPower<'_> {
    fn rate(&self, z: &State) -> State {
        let rate = self.0.rate(z);
        rate.map(|part| part / rate[5])
    }
}

impl LoopTrace {
    /// Traces a loop with about this many samples, from where it crosses φ₁ = φ₂ > 0 farthest out, or from its own start.
    pub(crate) fn new(
        model: &Model<f64>,
        region: &Region,
        closed: &Closed,
        samples: usize,
    ) -> Option<Self> {
        let total = closed.orbit.end[5];
        let legs = lasting(&closed.orbit);
        let home = Self::home(model, closed, &legs);
        let (first, state) = home.unwrap_or((0, legs.first()?.from));
        let momentum = closed.momentum.seen_from(&pose(&state));
        let mut route: Vec<(Motion, f64)> = Vec::with_capacity(legs.len() + 1);
        let leg = legs.get(first)?;
        route.push((leg.motion, leg.to[5] - state[5]));
        for leg in legs.iter().skip(first + 1).chain(legs.iter().take(first)) {
            route.push((leg.motion, leg.to[5] - leg.from[5]));
        }
        route.push((leg.motion, state[5] - leg.from[5]));
        // The first and the last leg may be parts of one.
        route.retain(|(_, length)| *length > LASTING * total);
        let start = [state[0], state[1], 0.0, 0.0, 0.0, 0.0];
        Self::along(model, region, momentum, start, &route, total, samples)
    }

    /// Traces an orbit from its own start.
    pub(crate) fn from_start(
        model: &Model<f64>,
        region: &Region,
        momentum: Momentum,
        orbit: &ClosedOrbit,
        samples: usize,
    ) -> Option<Self> {
        let legs = lasting(orbit);
        let start = legs.first()?.from;
        let route: Vec<(Motion, f64)> = legs
            .iter()
            .map(|leg| (leg.motion, leg.to[5] - leg.from[5]))
            .collect();
        Self::along(
            model,
            region,
            momentum,
            start,
            &route,
            orbit.end[5],
            samples,
        )
    }

    /// Where the loop crosses φ₁ = φ₂ > 0: the leg, and the state there.
    fn home(model: &Model<f64>, closed: &Closed, legs: &[Leg]) -> Option<(usize, State)> {
        const LOOKS: usize = 48;
        let mut best: Option<(usize, State)> = None;
        for (index, leg) in legs.iter().enumerate() {
            let system = ByPower(Flow {
                model,
                momentum: closed.momentum,
                motion: leg.motion,
            });
            let step = (leg.to[5] - leg.from[5]) / LOOKS as f64;
            let mut here = Point::new(&system, leg.from);
            for _ in 0..LOOKS {
                let there = advance(&system, here, step, CONTROL)?;
                let off = |z: &State| z[0] - z[1];
                if off(&here.z) * off(&there.z) <= 0.0 && here.z[0] + here.z[1] > 0.0 {
                    let at = Self::crossing(&system, &here, step)?;
                    if best.is_none_or(|(_, state)| at[0] > state[0]) {
                        best = Some((index, at));
                    }
                }
                here = there;
            }
        }
        best
    }

    fn crossing(system: &ByPower<'_>, from: &Point<6>, step: f64) -> Option<State> {
        let side = if from.z[0] < from.z[1] { -1.0 } else { 1.0 };
        let off = |at: &Point<6>| (side * (at.z[0] - at.z[1]), side * (at.rate[0] - at.rate[1]));
        let at = |length| advance(system, *from, length, CONTROL);
        locate([0.5 * step, step], 1e-15, at, off).map(|(there, _)| there.z)
    }

    /// The arcs of the first quarter: all there is to say of a loop with the paper's two symmetries.
    pub(crate) fn quarter_arcs(&self) -> Vec<Arc> {
        let end = self
            .cycle
            .u
            .iter()
            .position(|&u| (u - 0.25).abs() < 1e-9)
            .and_then(|index| self.cycle.phi.get(index));
        let arcs = self.arcs.iter().zip(&self.cycle.arcs);
        arcs.filter(|(_, place)| place.from < 0.25 - 1e-9)
            .map(|(arc, place)| match end {
                Some(end) if place.to > 0.25 + 1e-9 => Arc {
                    to: [end.x, end.y],
                    ..*arc
                },
                _ => *arc,
            })
            .collect()
    }

    /// The conditions that the loop was held against, and the numbers swum again by the model's own integration of the
    /// samples.
    pub(crate) fn checks(&self, region: &Region, stroke: &Stroke<f64>) -> Vec<Check> {
        let evidence = &self.evidence;
        let mut checks = self.conditions(region);
        let (x, y) = (stroke.displacement.x, stroke.displacement.y);
        checks.extend([
            Check::at_most("displacement_across_momentum", evidence.across.abs(), 1e-9),
            Check::at_most(
                "displacement_swum_again",
                (x.hypot(y) - evidence.along).abs(),
                again_within(evidence.along.abs()),
            ),
            Check::at_most("net_rotation_rad", stroke.rotation.abs(), 1e-8),
        ]);
        checks
    }

    /// The conditions on the arcs alone, whatever the displacement is sought for.
    pub(crate) fn conditions(&self, region: &Region) -> Vec<Check> {
        let evidence = &self.evidence;
        let mut checks = vec![
            Check::at_most("closure_rad", evidence.closure, 1e-9),
            Check::at_most("off_singular_condition_rad", evidence.off_zero, 1e-8),
        ];
        checks.extend(
            evidence
                .legendre_clebsch
                .map(|least| Check::at_least("legendre_clebsch_least", least, 1e-6)),
        );
        checks.extend(
            evidence
                .multiplier
                .map(|least| Check::at_least("bound_multiplier_least", least, -1e-9)),
        );
        if region.bounds().next().is_some() {
            let overstepped = evidence.overstepped;
            checks.push(Check::at_most("bound_overstepped_rad", overstepped, 1e-10));
        }
        checks.extend(simple_and_turning_once(&self.cycle.phi, &self.cycle.phi));
        checks
    }

    fn along(
        model: &Model<f64>,
        region: &Region,
        momentum: Momentum,
        start: State,
        route: &[(Motion, f64)],
        total: f64,
        samples: usize,
    ) -> Option<Self> {
        let mut evidence = LoopEvidence {
            off_zero: 0.0,
            multiplier: None,
            legendre_clebsch: None,
            overstepped: f64::NEG_INFINITY,
            closure: f64::NAN,
            rotation: f64::NAN,
            across: f64::NAN,
            along: f64::NAN,
        };
        let mut cycle = Cycle {
            u: vec![0.0],
            phi: vec![shape(&start)],
            corners: Vec::new(),
            arcs: Vec::new(),
        };
        let mut arcs: Vec<Arc> = Vec::new();
        let mut here = start;
        let mut done = 0.0;
        let mut directions: Vec<(Vector2<f64>, Vector2<f64>)> = Vec::new();
        for &(motion, length) in route {
            let system = ByPower(Flow {
                model,
                momentum,
                motion,
            });
            let from = (done / total, shape(&here));
            let set_out = system.0.direction(&here);
            // Samples fall on the quarters of the cycle, where a symmetric loop has its images meet.
            for (from, to) in between_quarters(done / total, (done + length) / total) {
                let fewest = match motion {
                    Motion::Along(track) if matches!(track.bound, Bound::Straight(_)) => FEWEST,
                    _ => FEWEST_CURVED,
                };
                let intervals = (fewest..samples)
                    .find(|&count| count as f64 >= samples as f64 * (to - from))
                    .unwrap_or(samples.max(fewest));
                for interval in 0..intervals {
                    evidence.evaluate(&system, region, &here);
                    let step = (to - from) * total / intervals as f64;
                    here = advance(&system, Point::new(&system, here), step, CONTROL)?.z;
                    // Exactly `to` in the end: corners are named by their sample's fraction.
                    let share = (interval + 1) as f64 / intervals as f64;
                    cycle.u.push(if interval + 1 == intervals {
                        to
                    } else {
                        from + (to - from) * share
                    });
                    cycle.phi.push(shape(&here));
                }
            }
            evidence.evaluate(&system, region, &here);
            directions.push((set_out, system.0.direction(&here)));
            done += length;
            let kind = kind(motion);
            cycle.arcs.push(GaitArc {
                kind,
                from: from.0,
                to: done / total,
            });
            let to = shape(&here);
            arcs.push(Arc {
                kind,
                from: from.1.into(),
                to: to.into(),
            });
        }
        let ends = directions.iter().map(|(_, end)| *end);
        let mut before = ends.clone().next_back()?;
        for (arc, ((set_out, _), end)) in cycle.arcs.iter().zip(directions.iter().zip(ends)) {
            if (set_out - before).norm() > 1e-7 {
                cycle.corners.push(arc.from);
            }
            before = end;
        }
        if let (Some(u), Some(phi)) = (cycle.u.last_mut(), cycle.phi.last_mut()) {
            *u = 1.0;
            evidence.closure = (*phi - shape(&start)).norm();
            *phi = shape(&start);
        }
        if let Some(arc) = cycle.arcs.last_mut() {
            arc.to = 1.0;
        }
        let moved = Vector2::new(here[2], here[3]);
        evidence.rotation = here[4];
        evidence.along = momentum.p.dot(&moved);
        evidence.across = momentum.p.perp(&moved);
        Some(Self {
            cycle,
            arcs,
            evidence,
        })
    }
}

impl LoopEvidence {
    fn evaluate(&mut self, system: &ByPower<'_>, region: &Region, z: &State) {
        let height = system.0.height(z);
        let slope = height.gradient.norm();
        self.overstepped = self.overstepped.max(region.overstepped(&shape(z)));
        if system.0.motion == Motion::Singular {
            self.off_zero = self.off_zero.max(height.value.abs() / slope);
            let direction = system.0.direction(z);
            let left = height
                .gradient
                .dot(&Vector2::new(-direction.y, direction.x));
            self.legendre_clebsch = Some(self.legendre_clebsch.map_or(left, |l| l.min(left)));
        } else {
            self.multiplier = Some(
                self.multiplier
                    .map_or(height.value, |m| m.min(height.value)),
            );
        }
    }
}

/// Arcs that last.
fn lasting(orbit: &ClosedOrbit) -> Vec<Leg> {
    let total = orbit.end[5];
    let legs = orbit.legs.iter();
    legs.filter(|leg| leg.to[5] - leg.from[5] > LASTING * total)
        .copied()
        .collect()
}

/// An interval of the cycle, cut at the quarters inside it.
fn between_quarters(from: f64, to: f64) -> impl Iterator<Item = (f64, f64)> {
    let inner = [0.25, 0.5, 0.75]
        .into_iter()
        .filter(move |cut| *cut > from + 1e-6 && *cut < to - 1e-6);
    let starts = std::iter::once(from).chain(inner.clone());
    starts.zip(inner.chain(std::iter::once(to)))
}

fn kind(motion: Motion) -> ArcKind {
    match motion {
        Motion::Singular => ArcKind::Singular,
        Motion::Along(track) => track.bound.kind(),
    }
}
