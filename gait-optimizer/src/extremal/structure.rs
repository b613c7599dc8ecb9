//! Which arcs an extremal is made of: read off a curve, and read again from every solution.
//!
//! A solution's structure is wrong in one of three ways, and each tells the next one to try: an arc whose length has gone
//! to zero is left out; where a free arc is beyond a bound a new arc along it begins; where a bound would have to pull
//! instead of push the curve leaves it.

use swimmer_model::Model;

use super::equations::{Motion, STATE, State, Turning, momentum, shape};
use super::flow::flowed;
use super::guess::Swum;
use super::shooting::{Chain, Class, Entry, Stretch};
use super::wall::{Wall, Walls};

/// A stretch of a curve: what it runs along, from where to where (power length).
/// A free one is named only where it begins at a corner.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Span {
    pub(crate) motion: Motion,
    pub(crate) entry: Entry,
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
/// A stretch near the tips' bound that is shorter than this share of a curve only bends round the corner.
const HELD: f64 = 0.005;
/// Arcs shorter than this share of the chain may be left out where the shooting fails.
const SHORT: f64 = 0.05;
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

    /// Whether a curve bends round the corner where an arc begins, and not away from it. The forbidden shapes lie beyond
    /// the corner, so the bend is to that side; a quarter is bent against its mirror image.
    fn bends_round(&self, chain: &Chain, class: Class, index: usize) -> bool {
        let first = |number: usize| self.rows.iter().find(|row| row.0 == number);
        let last = |number: usize| self.rows.iter().rev().find(|row| row.0 == number);
        let Some((.., start)) = first(index) else {
            return false;
        };
        let before = match (index.checked_sub(1), class) {
            (Some(before), _) => last(before).map(|row| row.2[2]),
            (None, Class::Quarter) => Some(1.5 * std::f64::consts::PI - start[2]),
            (None, Class::Closed { turn, .. }) => {
                last(chain.arcs.len().saturating_sub(1)).map(|row| row.2[2] - turn)
            }
        };
        let Some(before) = before else {
            return false;
        };
        let mean = 0.5 * (before + start[2]);
        // Positive where the corner points to the left of the motion, away from the origin.
        let left = -start[0] * mean.sin() + start[1] * mean.cos();
        (start[2] - before) * left >= 0.0
    }

    /// The state at a power length that may go beyond the end of a closed curve.
    fn round(&self, class: Class, total: f64, length: f64) -> State {
        match class {
            Class::Closed { turn, .. } if length > total => {
                let mut state = self.at(length - total);
                state[2] += turn;
                state
            }
            _ => self.at(length),
        }
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
    let least = SHORTEST * total;
    let mut spans: Vec<Span> = Vec::new();
    let mut changed = false;
    let mut from = 0.0;
    for (index, arc) in chain.arcs.iter().enumerate() {
        let to = from + arc.length.max(0.0);
        let mut entry = arc.entry;
        if matches!(entry, Entry::Corner(_)) && !samples.bends_round(chain, class, index) {
            entry = Entry::Smooth;
            changed = true;
        }
        if arc.length < least {
            changed = true;
            // The corner stays with the arc that follows.
            if let Entry::Corner(_) = entry {
                spans.push(Span {
                    motion: Motion::Free,
                    entry,
                    from,
                    to: from,
                });
            }
            from = to;
            continue;
        }
        let rows = || samples.rows.iter().filter(move |row| row.0 == index);
        match &arc.motion {
            Motion::Along(wall) => {
                let pushed = runs(rows().map(|(_, at, state)| {
                    let push = multiplier(model, wall, state);
                    (*at, (push >= PULL).then_some(*wall))
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
                let over = runs(rows().map(|(_, at, state)| {
                    let beyond = walls
                        .nearest(&shape(state))
                        .filter(|(_, depth)| *depth > OVERSTEP);
                    (*at, beyond.map(|(wall, _)| wall))
                }));
                changed |= !over.is_empty();
                let next = chain.arcs.get(index + 1).or(match class {
                    Class::Closed { .. } => chain.arcs.first(),
                    Class::Quarter => None,
                });
                let to_corner = next.is_some_and(|next| matches!(next.entry, Entry::Corner(_)));
                let edges = [(matches!(entry, Entry::Corner(_)), from), (to_corner, to)];
                let mut contacts = contacts(walls, class, over, edges, |at| samples.at(at));
                match contacts.first_mut() {
                    // A bound that is met right at the corner.
                    Some(first) if edges[0].0 && first.from - from < least => first.entry = entry,
                    _ if edges[0].0 => contacts.insert(
                        0,
                        Span {
                            motion: Motion::Free,
                            entry,
                            from,
                            to: from,
                        },
                    ),
                    _ => {}
                }
                spans.extend(contacts);
            }
        }
        from = to;
    }
    let round = |length: f64| samples.round(class, total, length);
    changed.then(|| rebuilt(class, &joined(spans, least), total, round))
}

/// The same chain with its shortest arc left out, where that makes sense: a free arc between two along the same bound, or
/// an arc along a bound. Near such a change of structure the shooting of the longer chain is singular.
pub(crate) fn simpler(model: &Model<f64>, class: Class, chain: &Chain) -> Option<(Chain, Class)> {
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
            _ if matches!(arc.entry, Entry::Corner(_)) => spans.push(Span {
                motion: Motion::Free,
                to: span.from,
                ..span
            }),
            _ => {}
        }
    }
    let round = |length: f64| samples.round(class, total, length);
    Some(rebuilt(class, &spans, total, round))
}

/// What runs of overstepping become: arcs along the bound, narrower than the overstepping, or (past both sides of the tips'
/// corner) a bend round it. `edges` are the ends of the arc that oversteps, marked where they are corners already.
fn contacts(
    walls: &Walls,
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
            spans.push(Span::bend(corner, place));
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

/// What runs of a sampled curve near bounds become: arcs along them, with a bend between two round the tips' corner. Short
/// ones there are nothing but the bend.
fn held(
    walls: &Walls,
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
        // Tip to tip comes between the two sides, and is nothing but the corner where there is one.
        let corner = walls
            .corner(&shape(&at(last.from)))
            .filter(|_| group.len() > 1 || starts_quarter(class, first) || first.wall.is_tips());
        let Some(corner) = corner else {
            spans.extend(
                group
                    .iter()
                    .filter(|run| lasts(run))
                    .map(|run| along(run, Entry::Smooth)),
            );
            continue;
        };
        let comes_along = group.len() > 1 && !first.wall.is_tips() && lasts(first);
        if comes_along {
            spans.push(along(first, Entry::Smooth));
        }
        if !last.wall.is_tips() && lasts(last) {
            // Without a gap to what comes before.
            let from = if comes_along { first.to } else { last.from };
            spans.push(Span {
                from,
                ..along(last, Entry::Corner(corner))
            });
        } else {
            let place = if comes_along { first.to } else { last.from };
            spans.push(Span::bend(corner, place));
        }
    }
    spans
}

fn round_tip(run: &Run) -> bool {
    matches!(run.wall, Wall::Curved(..))
}

/// A quarter that begins beyond the bound of the tips is bent there against its mirror image.
fn starts_quarter(class: Class, run: &Run) -> bool {
    class == Class::Quarter && run.from <= 0.0 && round_tip(run)
}

impl Span {
    /// A free arc begins with a bend round a corner.
    fn bend(corner: nalgebra::Vector2<f64>, place: f64) -> Self {
        Self {
            motion: Motion::Free,
            entry: Entry::Corner(corner),
            from: place,
            to: place,
        }
    }
}

/// Spans along the same bound with nothing between them made one.
fn joined(spans: Vec<Span>, least: f64) -> Vec<Span> {
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
        let runs = runs(rows.map(|(at, state)| (at, near(state))));
        let spans = held(walls, Class::Quarter, &runs, total, |at| swum.at(at));
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
    let class = Class::Closed {
        turn: swum.turn,
        line: None,
    };
    let at = |length: f64| swum.at(begin + length);
    let spans = held(walls, class, &runs(round), total, at);
    rebuilt(class, &spans, total, at)
}

/// A stretch of samples that are all beyond, or on, one bound.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Run {
    wall: Wall,
    from: f64,
    to: f64,
}

/// Runs of equal marks along a curve. A run ends halfway to the next sample.
fn runs(rows: impl Iterator<Item = (f64, Option<Wall>)>) -> Vec<Run> {
    let mut runs: Vec<Run> = Vec::new();
    let mut before: Option<(f64, Option<Wall>)> = None;
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
    let mut entry = Entry::Smooth;
    let end = begin + total;
    for span in bound_spans {
        if span.from > here {
            free_arc(&mut chain, entry, [here, span.from], total, class, &at);
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
            state[2] = wall.tangent(&phi, state[2]);
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
        free_arc(&mut chain, entry, [here, end], total, class, &at);
    }
    (chain, class)
}

fn free_arc(
    chain: &mut Chain,
    entry: Entry,
    [from, to]: [f64; 2],
    total: f64,
    class: Class,
    at: &impl Fn(f64) -> State,
) {
    let cycles = match class {
        Class::Quarter => 0.25,
        Class::Closed { .. } => 1.0,
    };
    let share = (to - from) / total * cycles;
    let pieces = (1..200_usize)
        .find(|&count| count as f64 >= share * PIECES)
        .unwrap_or(200);
    for piece in 0..pieces {
        let mut state = at(from + (to - from) * piece as f64 / pieces as f64);
        if let (0, Entry::Corner(corner)) = (piece, entry) {
            // Past the kink.
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
