//! Active set of an extremal: arcs detected on a curve and updated from every solution.
//!
//! A solution can be inconsistent in three ways, each of which determines the next active set: an arc of length zero is removed; a
//! free arc that violates a bound receives an arc along it; an arc along a bound with a multiplier of the wrong sign is released.

mod samples;
mod spans;

use swimmer_model::Model;

use super::equations::{Motion, State, Turning, momentum, shape};
use super::guess::Trajectory;
use super::shooting::{Chain, Class, Entry};
use crate::region::{Bound, Region};
use samples::Samples;
use spans::{SHORTEST, Span, contacts, held, joined, rebuilt, runs};

/// Largest violation of a bound by a free arc \[rad\], and largest negative multiplier.
pub(crate) const OVERSTEP: f64 = 1e-9;
const PULL: f64 = -1e-8;
/// Distance from a bound \[rad\] below which an initial guess counts as an arc along it.
pub(super) const NEAR: f64 = 5e-3;
/// Share of the chain below which an arc may be removed if the shooting fails.
const SHORT: f64 = 0.05;

/// Multiplier of a bound (KKT): ψ' of the free extremal minus ψ' along the bound; positive if the bound is active.
pub(crate) fn multiplier(model: &Model<f64>, wall: &Bound, state: &State) -> f64 {
    let phi = shape(state);
    let (sin, cos) = state[2].sin_cos();
    let local = Turning::at(model, &phi, state[2]);
    let free = local.plain + local.gain * momentum(state).dot(&local.curvature);
    let e = nalgebra::Vector2::new(cos, sin);
    let bound = wall.turning(&phi, &e) / local.speed;
    // The feasible region is on the left of the motion if the margin grows to the left.
    let left = nalgebra::Vector2::new(-sin, cos);
    let side = if wall.level(&phi).gradient.dot(&left) > 0.0 {
        1.0
    } else {
        -1.0
    };
    side * (free - bound)
}

/// Returns the next active set, or `None` if the present one is consistent.
pub(crate) fn next_structure(model: &Model<f64>, walls: &Region, chain: &Chain) -> Option<Chain> {
    let (total, class) = (chain.length(), chain.class);
    let samples = Samples::new(model, chain)?;
    let least = SHORTEST * total;
    let mut spans: Vec<Span> = Vec::new();
    let mut changed = false;
    let mut from = 0.0;
    for (index, arc) in chain.arcs.iter().enumerate() {
        let to = from + arc.length.max(0.0);
        let mut entry = arc.entry;
        if matches!(entry, Entry::Corner(_)) && !samples.bends_round(chain, index) {
            entry = Entry::Smooth;
            changed = true;
        }
        if arc.length < least {
            changed = true;
            // The corner belongs to the following arc.
            if let Entry::Corner(_) = entry {
                spans.push(Span::bend(entry, from));
            }
            from = to;
            continue;
        }
        let rows = || samples.of_arc(index);
        match &arc.motion {
            Motion::Along(wall) => {
                let pushed = runs(rows().map(|(at, state)| {
                    let push = multiplier(model, wall, state);
                    (at, (push >= PULL).then_some(*wall))
                }));
                changed |= pushed.len() != 1
                    || pushed
                        .iter()
                        .any(|run| run.to - run.from < (to - from) * (1.0 - 1e-9));
                for run in pushed.into_iter().filter(|run| run.to - run.from > least) {
                    let at_start = run.from - from < least;
                    spans.push(Span {
                        motion: arc.motion,
                        entry: if at_start { entry } else { Entry::Smooth },
                        from: run.from,
                        to: run.to,
                    });
                }
            }
            Motion::Free => {
                let over = runs(rows().map(|(at, state)| {
                    let beyond = walls
                        .nearest(&shape(state))
                        .filter(|(_, depth)| *depth > OVERSTEP);
                    (at, beyond.map(|(wall, _)| wall))
                }));
                changed |= !over.is_empty();
                let next = chain.arcs.get(index + 1).or(match class {
                    Class::Closed { .. } => chain.arcs.first(),
                    Class::Quarter => None,
                });
                let to_corner = next.is_some_and(|next| matches!(next.entry, Entry::Corner(_)));
                let edges = [(matches!(entry, Entry::Corner(_)), from), (to_corner, to)];
                let mut contacts = contacts(walls, class, over, edges, |at| samples.swum.at(at));
                match contacts.first_mut() {
                    // A bound that begins at the corner.
                    Some(first) if edges[0].0 && first.from - from < least => first.entry = entry,
                    _ if edges[0].0 => contacts.insert(0, Span::bend(entry, from)),
                    _ => {}
                }
                spans.extend(contacts);
            }
        }
        from = to;
    }
    let round = |length: f64| samples.swum.at(length);
    changed.then(|| rebuilt(class, &joined(spans, least), total, round))
}

/// Returns the chain without its shortest arc, if that is a free arc between two arcs along the same bound or an arc along a bound.
/// Near such a change of the active set the shooting of the longer chain is singular.
pub(crate) fn simpler(model: &Model<f64>, chain: &Chain) -> Option<Chain> {
    let total = chain.length();
    let samples = Samples::new(model, chain)?;
    let motion = |index: usize| chain.arcs.get(index).map(|arc| arc.motion);
    let (out, _) = chain
        .arcs
        .iter()
        .enumerate()
        .filter(|(index, arc)| {
            arc.length < SHORT * total
                && match arc.motion {
                    Motion::Along(_) => true,
                    Motion::Free => {
                        let before = index.checked_sub(1).and_then(motion);
                        before.is_some() && before == motion(index + 1)
                    }
                }
        })
        .min_by(|a, b| a.1.length.total_cmp(&b.1.length))?;
    let mut spans: Vec<Span> = Vec::new();
    let mut from = 0.0;
    for (index, arc) in chain.arcs.iter().enumerate() {
        let to = from + arc.length.max(0.0);
        let span = Span {
            motion: arc.motion,
            entry: arc.entry,
            from,
            to,
        };
        from = to;
        let merges = index == out + 1 && matches!(chain.arcs.get(out)?.motion, Motion::Free);
        match (arc.motion, spans.last_mut()) {
            (Motion::Along(_), Some(last)) if merges => last.to = to,
            (Motion::Along(_), _) if index != out => spans.push(span),
            _ if matches!(arc.entry, Entry::Corner(_)) => {
                spans.push(Span::bend(arc.entry, span.from));
            }
            _ => {}
        }
    }
    let round = |length: f64| samples.swum.at(length);
    Some(rebuilt(chain.class, &spans, total, round))
}

/// Detects the arcs of a sampled curve: parts near a bound become arcs along it.
pub(crate) fn of_curve(swum: &Trajectory, walls: &Region, quarter: bool) -> Chain {
    let near = |state: &State| {
        let nearest = walls.nearest(&shape(state));
        nearest
            .filter(|(_, depth)| *depth > -NEAR)
            .map(|(wall, _)| wall)
    };
    if quarter {
        let total = 0.25 * swum.total();
        let rows = swum.rows().take_while(|(at, _)| *at <= total);
        let runs = runs(rows.map(|(at, state)| (at, near(state))));
        let spans = held(walls, Class::Quarter, &runs, total, |at| swum.at(at));
        return rebuilt(Class::Quarter, &spans, total, |length| swum.at(length));
    }
    // Start at the shape farthest inside, so that no contact is split.
    let depth = |state: &State| walls.nearest(&shape(state)).map_or(0.0, |(_, depth)| depth);
    let begin = swum
        .rows()
        .min_by(|a, b| depth(a.1).total_cmp(&depth(b.1)))
        .map_or(0.0, |(at, _)| at);
    let total = swum.total();
    let later = swum.rows().filter(|(at, _)| *at >= begin);
    let earlier = swum.rows().filter(|(at, _)| *at < begin);
    let round = later
        .map(|(at, state)| (at - begin, near(state)))
        .chain(earlier.map(|(at, state)| (at - begin + total, near(state))));
    let class = Class::Closed {
        turn: swum.turn,
        line: None,
    };
    let at = |length: f64| swum.at(begin + length);
    let spans = held(walls, class, &runs(round), total, at);
    rebuilt(class, &spans, total, at)
}
