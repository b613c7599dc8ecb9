//! A closed loop traced once more from any of its points, sampled at constant power.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitArc};
use swimmer_model::Model;

use super::flow::{ClosedOrbit, Leg};
use super::shooting::Closed;
use crate::Arc;
use crate::cycle::Cycle;
use crate::momentum::{Flow, Momentum, Motion, State, pose, shape};
use crate::region::Bound;
use crate::runge_kutta::{Point, StepControl, System, advance, locate};

/// A loop, sampled.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct LoopTrace {
    pub(crate) cycle: Cycle,
    /// Of the cycle, in order.
    pub(crate) arcs: Vec<Arc>,
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
    pub(crate) fn new(model: &Model<f64>, closed: &Closed, samples: usize) -> Option<Self> {
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
        // An arc that was cut where the orbit began is whole.
        route.dedup_by(|next, leg| {
            let whole = next.0 == Motion::Singular && leg.0 == Motion::Singular;
            leg.1 += if whole { next.1 } else { 0.0 };
            whole
        });
        let start = [state[0], state[1], 0.0, 0.0, 0.0, 0.0];
        Self::along(model, momentum, start, &route, total, samples)
    }

    /// Traces an orbit from its own start.
    pub(crate) fn from_start(
        model: &Model<f64>,
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
        Self::along(model, momentum, start, &route, orbit.end[5], samples)
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

    fn along(
        model: &Model<f64>,
        momentum: Momentum,
        start: State,
        route: &[(Motion, f64)],
        total: f64,
        samples: usize,
    ) -> Option<Self> {
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
            *phi = shape(&start);
        }
        if let Some(arc) = cycle.arcs.last_mut() {
            arc.to = 1.0;
        }
        Some(Self { cycle, arcs })
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
