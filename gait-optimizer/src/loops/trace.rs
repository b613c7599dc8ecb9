//! Sampling of a closed loop from any of its points at constant power.

use swimmer_model::Model;

use super::flow::ClosedOrbit;
use crate::arcs::{ByPower, Leg, sampled};
use crate::cycle::Cycle;
use crate::momentum::{Flow, Motion, State, pose};
use crate::numerics::locate;
use crate::runge_kutta::{Point, StepControl, advance};

const CONTROL: StepControl = StepControl::to(1e-13);
/// Quarters of the cycle, which are sample points, since the images of a symmetric loop meet there.
const QUARTERS: [f64; 3] = [0.25, 0.5, 0.75];
/// Share of the cycle below which an arc is only a crossing of a corner.
const LASTING: f64 = 1e-9;

/// Samples a loop with about this number of samples, from its outermost crossing of φ₁ = φ₂ > 0, or from its own start.
pub(crate) fn traced(model: &Model<f64>, orbit: &ClosedOrbit, samples: usize) -> Option<Cycle> {
    let home = home(model, orbit, &nonempty_legs(orbit));
    traced_from(model, orbit, home, samples)
}

/// Samples a loop from a state on one of its arcs of finite length, or from its own start.
pub(crate) fn traced_from(
    model: &Model<f64>,
    orbit: &ClosedOrbit,
    start: Option<(usize, State)>,
    samples: usize,
) -> Option<Cycle> {
    let total = orbit.end[5];
    let legs = nonempty_legs(orbit);
    let (first, state) = start.unwrap_or((0, legs.first()?.from));
    let momentum = orbit.momentum.in_frame_of(&pose(&state));
    let mut route: Vec<(Motion, f64)> = Vec::with_capacity(legs.len() + 1);
    let leg = legs.get(first)?;
    route.push((leg.motion, leg.to[5] - state[5]));
    for leg in legs.iter().skip(first + 1).chain(legs.iter().take(first)) {
        route.push((leg.motion, leg.to[5] - leg.from[5]));
    }
    route.push((leg.motion, state[5] - leg.from[5]));
    // The first and the last arc may be parts of one arc.
    route.retain(|(_, length)| *length > LASTING * total);
    // Merge an arc that the start of the orbit splits.
    route.dedup_by(|next, leg| {
        let whole = next.0 == Motion::Singular && leg.0 == Motion::Singular;
        leg.1 += if whole { next.1 } else { 0.0 };
        whole
    });
    let start = [state[0], state[1], 0.0, 0.0, 0.0, 0.0];
    let how = (QUARTERS.as_slice(), samples);
    let (samples, _) = sampled((model, momentum), start, &route, how, true)?;
    Some(samples.closed())
}

/// Crossing of φ₁ = φ₂ > 0: index of the arc, and state.
fn home(model: &Model<f64>, orbit: &ClosedOrbit, legs: &[Leg]) -> Option<(usize, State)> {
    const LOOKS: usize = 48;
    let mut best: Option<(usize, State)> = None;
    for (index, leg) in legs.iter().enumerate() {
        let system = ByPower(Flow {
            model,
            momentum: orbit.momentum,
            motion: leg.motion,
        });
        let step = (leg.to[5] - leg.from[5]) / LOOKS as f64;
        let mut here = Point::new(&system, leg.from);
        for _ in 0..LOOKS {
            let there = advance(&system, here, step, CONTROL)?;
            let off = |z: &State| z[0] - z[1];
            if off(&here.z) * off(&there.z) <= 0.0 && here.z[0] + here.z[1] > 0.0 {
                let at = crossing(&system, &here, step)?;
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

/// Arcs of finite length.
fn nonempty_legs(orbit: &ClosedOrbit) -> Vec<Leg> {
    let total = orbit.end[5];
    let legs = orbit.legs.iter();
    legs.filter(|leg| leg.to[5] - leg.from[5] > LASTING * total)
        .copied()
        .collect()
}
