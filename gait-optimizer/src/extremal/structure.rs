//! Which arcs an extremal is made of: read off a curve, and read again from every solution.
//!
//! A solution's structure is wrong in one of three ways, and each tells the next one to try: an arc whose length has gone
//! to zero is left out; where a free arc is beyond a bound a new arc along it begins; where a bound would have to pull
//! instead of push the curve leaves it.

use swimmer_model::Model;

use super::equations::{Motion, STATE, State, Turning, momentum, shape};
use super::flow::flowed;
use super::guess::Swum;
use super::shooting::{Chain, Class, Stretch};
use super::wall::{Wall, Walls};

/// A stretch of a curve: what it runs along, from where to where (power length).
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) motion: Motion,
    pub(crate) from: f64,
    pub(crate) to: f64,
}

/// How many pieces a full cycle is shot in at least.
const PIECES: f64 = 24.0;
/// Samples of a piece when it is examined.
const LOOKS: usize = 24;
/// How far beyond a bound a free arc may be \[rad\], and how far a multiplier below zero.
pub(crate) const OVERSTEP: f64 = 1e-9;
const PULL: f64 = -1e-8;
/// How near to a bound \[rad\] a guess is taken to run along it.
pub(super) const NEAR: f64 = 5e-3;
/// Arcs shorter than this share of the chain are none.
const SHORTEST: f64 = 1e-7;

/// What a bound pushes: ψ' of the free extremal less ψ' along the bound, positive where it pushes inwards. (The length S is
/// the string here: where the field would bulge it beyond the bound, ψ' stays behind.)
pub(crate) fn multiplier(model: &Model<f64>, wall: &Wall, state: &State) -> f64 {
    let phi = shape(state);
    let (sin, cos) = state[2].sin_cos();
    let local = Turning::at(model, &phi, state[2]);
    let free = local.plain + local.gain * momentum(state).dot(&local.curvature);
    let e = nalgebra::Vector2::new(cos, sin);
    let bound = wall.turning(&phi, &e) / local.speed;
    // On the left of the motion lies the region where the outward gradient points right.
    let left = nalgebra::Vector2::new(-sin, cos);
    let side = if wall.gradient(&phi).dot(&left) < 0.0 {
        1.0
    } else {
        -1.0
    };
    side * (free - bound)
}

/// A solved chain, looked at closely.
struct Samples {
    /// Number of the arc, power length from the chain's start, state.
    rows: Vec<(usize, f64, State)>,
}

impl Samples {
    fn new(model: &Model<f64>, chain: &Chain) -> Option<Self> {
        let mut rows = Vec::new();
        let mut from = 0.0;
        for (index, arc, state) in chain.pieces() {
            let share = (arc.length / arc.pieces as f64).max(0.0);
            let mut here = *state;
            rows.push((index, from, here));
            for look in 1..=LOOKS {
                here = flowed(model, &arc.motion, &here, share / LOOKS as f64)?.0;
                rows.push((index, from + share * look as f64 / LOOKS as f64, here));
            }
            from += share;
        }
        Some(Self { rows })
    }

    /// The state at a power length, from the sample before by linear interpolation.
    fn at(&self, length: f64) -> State {
        let after = self
            .rows
            .partition_point(|row| row.1 <= length)
            .clamp(1, self.rows.len().saturating_sub(1).max(1));
        let pick = |i: usize| {
            self.rows
                .get(i)
                .map_or((0.0, [0.0; STATE]), |row| (row.1, row.2))
        };
        let ((from, low), (to, high)) = (pick(after - 1), pick(after));
        let share = if to > from {
            (length - from) / (to - from)
        } else {
            0.0
        };
        std::array::from_fn(|i| low[i] + share * (high[i] - low[i]))
    }
}

/// The structure that a solution asks for next; none where it is right as it is.
pub(crate) fn next_structure(
    model: &Model<f64>,
    walls: &Walls,
    class: Class,
    chain: &Chain,
) -> Option<(Chain, Class)> {
    let total = chain.length();
    let samples = Samples::new(model, chain)?;
    let mut spans: Vec<Span> = Vec::new();
    let mut changed = false;
    let mut from = 0.0;
    for (index, arc) in chain.arcs.iter().enumerate() {
        let to = from + arc.length.max(0.0);
        if arc.length < SHORTEST * total {
            changed = true;
            from = to;
            continue;
        }
        let rows = || samples.rows.iter().filter(move |row| row.0 == index);
        match &arc.motion {
            Motion::Along(wall) => {
                let pushed = runs(rows().map(|(_, at, state)| {
                    let push = multiplier(model, wall, state);
                    (*at, (push >= PULL).then_some(()))
                }));
                changed |= pushed.len() != 1
                    || pushed
                        .iter()
                        .any(|(_, a, b)| b - a < (to - from) * (1.0 - 1e-9));
                spans.extend(
                    pushed
                        .into_iter()
                        .filter(|(_, a, b)| b - a > SHORTEST * total)
                        .map(|((), from, to)| Span {
                            motion: arc.motion,
                            from,
                            to,
                        }),
                );
            }
            Motion::Free => {
                let over = runs(rows().map(|(_, at, state)| {
                    let beyond = walls
                        .nearest(&shape(state))
                        .filter(|(_, depth)| *depth > OVERSTEP);
                    (*at, beyond.map(|(wall, _)| wall))
                }));
                changed |= !over.is_empty();
                for (wall, start, end) in over {
                    // The overstepping is wider than the contact that it becomes.
                    let (middle, half) = (0.5 * (start + end), 0.25 * (end - start));
                    let half = half.max(2.0 * SHORTEST * total);
                    spans.push(Span {
                        motion: Motion::Along(wall),
                        from: middle - half,
                        to: middle + half,
                    });
                }
            }
        }
        from = to;
    }
    let round = |length: f64| match class {
        Class::Closed { turn, .. } if length > total => {
            let mut state = samples.at(length - total);
            state[2] += turn;
            state
        }
        _ => samples.at(length),
    };
    changed.then(|| rebuilt(class, &joined(spans, total), total, round))
}

/// Spans along the same bound with nothing between them made one.
fn joined(spans: Vec<Span>, total: f64) -> Vec<Span> {
    let mut joined: Vec<Span> = Vec::with_capacity(spans.len());
    for span in spans {
        match joined.last_mut() {
            Some(last) if last.motion == span.motion && span.from - last.to < SHORTEST * total => {
                last.to = span.to;
            }
            _ => joined.push(span),
        }
    }
    joined
}

/// The structure of a sampled curve: it runs along a bound where it comes near it.
pub(crate) fn of_curve(swum: &Swum, walls: &Walls, quarter: bool) -> (Chain, Class) {
    let near = |state: &State| {
        let nearest = walls.nearest(&shape(state));
        nearest
            .filter(|(_, depth)| *depth > -NEAR)
            .map(|(wall, _)| wall)
    };
    if quarter {
        let total = 0.25 * swum.total();
        let rows = swum.rows().take_while(|(at, _)| *at <= total);
        let spans = along(runs(rows.map(|(at, state)| (at, near(state)))));
        return rebuilt(Class::Quarter, &spans, total, |length| swum.at(length));
    }
    // From the shape that lies farthest inside, so that no contact is cut in two.
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
    let spans = along(runs(round));
    let class = Class::Closed {
        turn: swum.turn,
        line: None,
    };
    rebuilt(class, &spans, total, |length| swum.at(begin + length))
}

fn along(runs: Vec<(Wall, f64, f64)>) -> Vec<Span> {
    let spans = runs.into_iter().map(|(wall, from, to)| Span {
        motion: Motion::Along(wall),
        from,
        to,
    });
    spans.collect()
}

/// Runs of equal marks along a curve: the mark, from, to. A run ends halfway to the next sample.
fn runs<M: PartialEq + Copy>(rows: impl Iterator<Item = (f64, Option<M>)>) -> Vec<(M, f64, f64)> {
    let mut runs: Vec<(M, f64, f64)> = Vec::new();
    let mut before: Option<(f64, Option<M>)> = None;
    for (at, mark) in rows {
        let boundary = before.map_or(at, |(last, _)| 0.5 * (last + at));
        let same = before.is_some_and(|(_, last)| last == mark);
        if let Some(mark) = mark {
            match runs.last_mut() {
                Some(run) if same && run.0 == mark => run.2 = at,
                _ => runs.push((mark, boundary, at)),
            }
        } else if let (Some(run), Some((_, Some(_)))) = (runs.last_mut(), before) {
            run.2 = boundary;
        }
        before = Some((at, mark));
    }
    runs
}

/// A chain from the spans along bounds, with free arcs between them; states come from `at`.
pub(crate) fn rebuilt(
    class: Class,
    bound_spans: &[Span],
    total: f64,
    at: impl Fn(f64) -> State,
) -> (Chain, Class) {
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
        arcs: Vec::new(),
        states: Vec::new(),
    };
    let mut here = begin;
    let end = begin + total;
    for span in bound_spans {
        if span.from > here {
            free_arc(&mut chain, here, span.from, total, class, &at);
        }
        if let Motion::Along(wall) = &span.motion {
            let mut state = at(span.from);
            let phi = wall.onto(&shape(&state));
            state[0] = phi.x;
            state[1] = phi.y;
            state[2] = wall.tangent(&phi, state[2]);
            chain.arcs.push(Stretch {
                motion: span.motion,
                pieces: 1,
                length: span.to - span.from,
            });
            chain.states.push(state);
        }
        here = span.to;
    }
    if end > here {
        free_arc(&mut chain, here, end, total, class, &at);
    }
    (chain, class)
}

fn free_arc(
    chain: &mut Chain,
    from: f64,
    to: f64,
    total: f64,
    class: Class,
    at: &impl Fn(f64) -> State,
) {
    let cycles = match class {
        Class::Quarter => 0.25,
        Class::Closed { .. } => 1.0,
    };
    let share = (to - from) / total * cycles;
    // At least one, at most a few hundred: shares are between 0 and 1.
    let pieces = (1..200)
        .find(|&count| f64::from(count) >= share * PIECES)
        .map_or(200, |count| count as usize);
    for piece in 0..pieces {
        chain
            .states
            .push(at(from + (to - from) * piece as f64 / pieces as f64));
    }
    chain.arcs.push(Stretch {
        motion: Motion::Free,
        pieces,
        length: to - from,
    });
}
