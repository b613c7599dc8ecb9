//! Contacts of a curve with bounds, and the chain of arcs that follows from them.

use crate::extremal::equations::{Motion, State, shape};
use crate::extremal::shooting::{Chain, Class, Entry, Stretch};
use crate::region::{Bound, Piece, Region};

/// Contact with a bound. A free span is listed only if it begins at a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) motion: Motion,
    pub(crate) entry: Entry,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// Least number of pieces of a full cycle.
const PIECES: f64 = 24.0;
/// Share of a curve below which a contact with the tips' bound is only a bend around the corner.
const HELD: f64 = 0.005;
/// Share of the chain below which an arc is discarded.
pub(super) const SHORTEST: f64 = 1e-7;

/// Converts violations of bounds to arcs along the bound, narrower than the violation, or (on both sides of the tips' corner) to a
/// bend around it. `edges` are the ends of the violating arc, with a mark if they are corners already.
pub(super) fn contacts(
    walls: &Region,
    class: Class,
    over: Vec<Run>,
    edges: [(bool, f64); 2],
    at: impl Fn(f64) -> State,
) -> Vec<Span> {
    let least = SHORTEST * (edges[1].1 - edges[0].1);
    let mut spans: Vec<Span> = Vec::new();
    let mut over = over.into_iter().peekable();
    while let Some(run) = over.next() {
        let next = over.next_if(|next| round_tip(&run) && round_tip(next) && next.from <= run.to);
        let from_start = starts_quarter(class, &run);
        let place = next.map_or(run.from, |next| next.from);
        if (next.is_some() || (from_start && !edges[0].0))
            && let Some(corner) = walls.corner(&shape(&at(place)))
        {
            spans.push(Span::bend(Entry::Corner(corner), place));
            continue;
        }
        let (middle, half) = (0.5 * (run.from + run.to), 0.25 * (run.to - run.from));
        let hugs = |edge: (bool, f64), end: f64| edge.0 && (edge.1 - end).abs() < least;
        spans.push(Span {
            motion: Motion::Along(run.wall),
            entry: Entry::Smooth,
            from: if hugs(edges[0], run.from) || from_start {
                run.from
            } else {
                middle - half
            },
            to: if hugs(edges[1], run.to) {
                run.to
            } else {
                middle + half
            },
        });
    }
    spans
}

/// Converts parts of a sampled curve near bounds to arcs along them, with a bend between two arcs at the tips' corner. Short parts
/// near the corner become the bend alone.
pub(super) fn held(
    walls: &Region,
    class: Class,
    near: &[Run],
    total: f64,
    at: impl Fn(f64) -> State,
) -> Vec<Span> {
    let mut spans: Vec<Span> = Vec::new();
    for group in near.chunk_by(|a, b| round_tip(a) && round_tip(b) && b.from <= a.to) {
        let (Some(first), Some(last)) = (group.first(), group.last()) else {
            continue;
        };
        let lasts = |run: &Run| run.to - run.from > HELD * total || !round_tip(run);
        let along = |run: &Run, entry| Span {
            motion: Motion::Along(run.wall),
            entry,
            from: run.from,
            to: run.to,
        };
        // The bound tip to tip is between the two sides; if there is a corner, it is the corner itself.
        let corner = walls
            .corner(&shape(&at(last.from)))
            .filter(|_| group.len() > 1 || starts_quarter(class, first) || is_tips(first));
        let Some(corner) = corner else {
            spans.extend(
                group
                    .iter()
                    .filter(|run| lasts(run))
                    .map(|run| along(run, Entry::Smooth)),
            );
            continue;
        };
        let comes_along = group.len() > 1 && !is_tips(first) && lasts(first);
        if comes_along {
            spans.push(along(first, Entry::Smooth));
        }
        if !is_tips(last) && lasts(last) {
            // No gap to the previous contact.
            let from = if comes_along { first.to } else { last.from };
            spans.push(Span {
                from,
                ..along(last, Entry::Corner(corner))
            });
        } else {
            let place = if comes_along { first.to } else { last.from };
            spans.push(Span::bend(Entry::Corner(corner), place));
        }
    }
    spans
}

fn round_tip(run: &Run) -> bool {
    matches!(run.wall, Bound::Clearance(_))
}

/// Returns `true` for the bound on the distance from tip to tip.
fn is_tips(run: &Run) -> bool {
    matches!(&run.wall, Bound::Clearance(clearance) if clearance.held == Some(Piece::Tips))
}

/// Returns `true` if a quarter begins beyond the bound of the tips, where it bends against its mirror image.
fn starts_quarter(class: Class, run: &Run) -> bool {
    class == Class::Quarter && run.from <= 0.0 && round_tip(run)
}

impl Span {
    /// Free arc that begins with a bend around a corner.
    pub(super) fn bend(entry: Entry, place: f64) -> Self {
        Self {
            motion: Motion::Free,
            entry,
            from: place,
            to: place,
        }
    }
}

/// Merges adjacent spans along the same bound.
pub(super) fn joined(spans: Vec<Span>, least: f64) -> Vec<Span> {
    let mut joined: Vec<Span> = Vec::with_capacity(spans.len());
    for span in spans {
        match joined.last_mut() {
            Some(last)
                if last.motion == span.motion
                    && span.motion != Motion::Free
                    && span.entry == Entry::Smooth
                    && span.from - last.to < least =>
            {
                last.to = span.to;
            }
            _ => joined.push(span),
        }
    }
    joined
}

/// Run of samples that are on or beyond one bound.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Run {
    pub(super) wall: Bound,
    pub(super) from: f64,
    pub(super) to: f64,
}

/// Splits a curve into runs of equal marks. A run ends halfway to the next sample.
pub(super) fn runs(rows: impl Iterator<Item = (f64, Option<Bound>)>) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut before: Option<(f64, Option<Bound>)> = None;
    for (at, mark) in rows {
        let boundary = before.map_or(at, |(last, _)| 0.5 * (last + at));
        let last = before.and_then(|(_, last)| last);
        match (runs.last_mut(), mark) {
            (Some(run), Some(_)) if mark == last => run.to = at,
            (Some(run), _) if last.is_some() => run.to = boundary,
            _ => {}
        }
        if let Some(wall) = mark.filter(|_| mark != last) {
            runs.push(Run {
                wall,
                from: boundary,
                to: at,
            });
        }
        before = Some((at, mark));
    }
    runs
}

/// Builds a chain from the spans along bounds, with free arcs between them; `at` returns the states.
pub(crate) fn rebuilt(
    class: Class,
    bound_spans: &[Span],
    total: f64,
    at: impl Fn(f64) -> State,
) -> Chain {
    let mut class = class;
    let mut begin = 0.0;
    if let Class::Closed { line, .. } = &mut class {
        if let Some(span) = bound_spans.first() {
            begin = span.from;
            *line = None;
        } else {
            let state = at(0.0);
            *line = Some((
                shape(&state),
                nalgebra::Vector2::new(state[2].cos(), state[2].sin()),
            ));
        }
    }
    let mut chain = Chain {
        class,
        arcs: Vec::new(),
        states: Vec::new(),
    };
    let mut here = begin;
    let mut entry = Entry::Smooth;
    let end = begin + total;
    for span in bound_spans {
        if span.from > here {
            free_arc(&mut chain, entry, [here, span.from], total, &at);
            entry = Entry::Smooth;
        }
        if let Entry::Corner(_) = span.entry {
            entry = span.entry;
        }
        if let Motion::Along(wall) = &span.motion {
            let mut state = at(span.from);
            let phi = wall.onto(&shape(&state));
            state[0] = phi.x;
            state[1] = phi.y;
            state[2] = wall.direction_near(&phi, state[2]);
            chain.arcs.push(Stretch {
                motion: span.motion,
                entry,
                pieces: 1,
                length: span.to - span.from,
            });
            chain.states.push(state);
            entry = Entry::Smooth;
        }
        here = span.to;
    }
    if end > here {
        free_arc(&mut chain, entry, [here, end], total, &at);
    }
    chain
}

fn free_arc(
    chain: &mut Chain,
    entry: Entry,
    [from, to]: [f64; 2],
    total: f64,
    at: &impl Fn(f64) -> State,
) {
    let share = (to - from) / total / f64::from(chain.class.parts());
    let pieces = (1..200_usize)
        .find(|&count| count as f64 >= share * PIECES)
        .unwrap_or(200);
    for piece in 0..pieces {
        let mut state = at(from + (to - from) * piece as f64 / pieces as f64);
        if let (0, Entry::Corner(corner)) = (piece, entry) {
            // Just after the kink.
            state = at(from + 1e-3 * (to - from));
            state[0] = corner.x;
            state[1] = corner.y;
        }
        chain.states.push(state);
    }
    chain.arcs.push(Stretch {
        motion: Motion::Free,
        entry,
        pieces,
        length: to - from,
    });
}
