//! Multiple shooting over arcs: one damped Newton iteration for quarter gaits and for closed curves.
//!
//! Unknown are the state at the start of every piece and the length of every arc. Each piece must end where the next one
//! starts; an arc along a bound must start on it, tangent to it; at a corner of the forbidden shapes the direction may jump. Both ends of the chain belong to the [`Class`]. On a closed
//! curve the length of `μ_xy` closes by itself because the flow keeps it; where no bound arc marks a start, the start is held
//! on a line across the curve instead.
//!
//! Full cycles amplify a change of their start by up to 1e12, a piece by little: that is what the pieces are for.

use std::f64::consts::PI;

use nalgebra::Vector2;
use swimmer_model::Model;

use super::elimination::System;
use super::equations::{Motion, STATE, State, shape};
use super::flow::{Mapped, mapped};

/// How an arc begins.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Entry {
    /// Smoothly; onto a bound, tangent to it.
    Smooth,
    /// At this corner of the forbidden shapes, which the curve is bent round with a kink.
    Corner(Vector2<f64>),
}

/// One arc of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) motion: Motion,
    pub(crate) entry: Entry,
    /// How many pieces it is shot in.
    pub(crate) pieces: usize,
    /// Power length.
    pub(crate) length: f64,
}

/// A chain of arcs with the state at the start of every piece.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain {
    pub(crate) arcs: Vec<Stretch>,
    pub(crate) states: Vec<State>,
}

/// What is asked of both ends of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Class {
    /// A quarter of a doubly symmetric gait: square to φ₁ = φ₂ with θ = 0, square to φ₁ = −φ₂ with λ₄ = 0.
    Quarter,
    /// A closed curve whose direction turns by `turn` \[rad\].
    Closed {
        turn: f64,
        /// A line that the first shape is held on: a point and the direction across it; for curves without a bound arc.
        line: Option<(Vector2<f64>, Vector2<f64>)>,
    },
}

/// A solved chain.
#[derive(Debug, Clone)]
pub(crate) struct Solved {
    pub(crate) chain: Chain,
    /// Largest residual: angles in radians, momenta over |p|, the scale condition over the length.
    pub(crate) residual: f64,
    /// Sign of the Jacobian's determinant; it changes at a fold of the family of solutions.
    pub(crate) orientation: f64,
}

/// Why an iteration gave up.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unsolved {
    /// An extremal could not be integrated from the guess.
    Lost,
    /// The Jacobian is singular.
    Singular,
    /// No step made the residual smaller.
    Stuck {
        /// The smallest that was reached.
        residual: f64,
    },
    /// The chain has no unknowns or does not fit together.
    Malformed,
}

impl std::fmt::Display for Unsolved {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        match self {
            Self::Lost => f.write_str("an extremal cannot be integrated from the guess"),
            Self::Singular => f.write_str("the conditions are singular"),
            Self::Stuck { residual } => {
                write!(f, "no step makes the residual of {residual:.1e} smaller")
            }
            Self::Malformed => f.write_str("the arcs do not fit together"),
        }
    }
}

/// Where the iteration is satisfied.
const TOLERANCE: f64 = 2e-12;
/// What is still accepted when rounding keeps it from getting better.
const ACCEPTED: f64 = 1e-10;
const MOST_ITERATIONS: usize = 40;
/// Largest change of an angle in one step \[rad\].
const LONGEST_TURN: f64 = 0.4;

impl Chain {
    /// Power length of the whole chain.
    pub(crate) fn length(&self) -> f64 {
        self.arcs.iter().map(|arc| arc.length).sum()
    }

    /// The arc, the length and the start of every piece.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = (usize, &Stretch, &State)> {
        self.arcs
            .iter()
            .enumerate()
            .flat_map(|(index, arc)| std::iter::repeat_n((index, arc), arc.pieces))
            .zip(&self.states)
            .map(|((index, arc), state)| (index, arc, state))
    }

    fn is_whole(&self) -> bool {
        !self.states.is_empty()
            && self.states.len() == self.arcs.iter().map(|arc| arc.pieces).sum::<usize>()
            && self.arcs.iter().all(|arc| arc.pieces > 0)
    }

    fn moved(&self, step: &[f64], factor: f64) -> Self {
        let mut chain = self.clone();
        let mut changes = step.iter().map(|change| factor * change);
        for state in &mut chain.states {
            for value in state.iter_mut() {
                *value += changes.next().unwrap_or(0.0);
            }
        }
        for arc in &mut chain.arcs {
            arc.length += changes.next().unwrap_or(0.0);
        }
        chain
    }
}

/// Residuals and Jacobian under construction, row by row.
struct Equations {
    residual: Vec<f64>,
    jacobian: System,
    size: usize,
}

impl Equations {
    fn new(size: usize, lengths_from: usize) -> Self {
        Self {
            residual: Vec::with_capacity(size),
            jacobian: System::new(size, lengths_from),
            size,
        }
    }

    fn norm(&self) -> f64 {
        self.residual
            .iter()
            .map(|value| value * value)
            .sum::<f64>()
            .sqrt()
    }

    /// NaN where any residual is.
    fn largest(&self) -> f64 {
        let worse = |a: f64, b: &f64| {
            if b.is_nan() || b.abs() > a {
                b.abs()
            } else {
                a
            }
        };
        self.residual.iter().fold(0.0, worse)
    }

    fn add(&mut self, value: f64, slopes: impl IntoIterator<Item = (usize, f64)>) {
        let row = self.residual.len();
        self.residual.push(value);
        for (column, slope) in slopes {
            self.jacobian.add(row, column, slope);
        }
    }
}

/// The end of a piece with everything that its derivatives take.
struct Ending<'a> {
    map: &'a Mapped,
    /// First column of the piece's start.
    column: usize,
    /// Column of the arc's length, and the share of it that is the piece's.
    length: (usize, f64),
}

impl Ending<'_> {
    /// Derivatives of row `row` of the end (`STATE` for the gain), times a factor.
    fn slopes(&self, row: usize, factor: f64) -> impl Iterator<Item = (usize, f64)> {
        let column = self.column;
        self.map.by_start[row]
            .iter()
            .enumerate()
            .map(move |(i, slope)| (column + i, factor * slope))
            .chain([(self.length.0, factor * self.map.rate[row] * self.length.1)])
    }
}

/// Solves a chain from a guess.
pub(crate) fn solve(model: &Model<f64>, class: Class, guess: Chain) -> Result<Solved, Unsolved> {
    if !guess.is_whole() {
        return Err(Unsolved::Malformed);
    }
    let scale = guess
        .states
        .first()
        .map_or(1.0, |z| z[3].hypot(z[4]))
        .max(f64::MIN_POSITIVE);
    let mut chain = guess;
    let mut here = assemble(model, class, &chain, scale).ok_or(Unsolved::Lost)?;
    let mut orientation = 0.0;
    for _ in 0..MOST_ITERATIONS {
        let residual = here.largest();
        if residual.is_nan() {
            return Err(Unsolved::Lost);
        }
        let right: Vec<f64> = here.residual.iter().map(|value| -value).collect();
        let newton = here.jacobian.solve(&right);
        if let Some(newton) = &newton {
            orientation = newton.orientation;
        }
        if residual <= TOLERANCE {
            return Ok(Solved {
                chain,
                residual,
                orientation,
            });
        }
        let step = newton.ok_or(Unsolved::Singular)?.solution;
        let norm = here.norm();
        let mut factor = longest_factor(&chain, &step);
        let next = loop {
            let moved = chain.moved(&step, factor);
            let trial = assemble(model, class, &moved, scale)
                .filter(|trial| trial.norm() < (1.0 - 1e-4 * factor) * norm);
            if let Some(trial) = trial {
                break Some((moved, trial));
            }
            factor *= 0.5;
            if factor < 1e-3 {
                break None;
            }
        };
        match next {
            Some(next) => (chain, here) = next,
            None if residual <= ACCEPTED => {
                return Ok(Solved {
                    chain,
                    residual,
                    orientation,
                });
            }
            None => return Err(Unsolved::Stuck { residual }),
        }
    }
    let residual = here.largest();
    if residual <= ACCEPTED {
        Ok(Solved {
            chain,
            residual,
            orientation,
        })
    } else {
        Err(Unsolved::Stuck { residual })
    }
}

/// How much of a step keeps angles from turning too far and arcs from losing too much of their length at once.
fn longest_factor(chain: &Chain, step: &[f64]) -> f64 {
    let mut factor = 1.0_f64;
    let mut changes = step.iter();
    for _ in &chain.states {
        for (i, change) in changes.by_ref().take(STATE).enumerate() {
            if i < 3 && change.abs() > LONGEST_TURN {
                factor = factor.min(LONGEST_TURN / change.abs());
            }
        }
    }
    let most = 0.3 * chain.length();
    for change in changes {
        if change.abs() > most {
            factor = factor.min(most / change.abs());
        }
    }
    factor
}

/// All equations of a chain with their Jacobian; none where a piece cannot be integrated.
fn assemble(model: &Model<f64>, class: Class, chain: &Chain, scale: f64) -> Option<Equations> {
    let count = chain.states.len();
    let lengths_from = STATE * count;
    let mut equations = Equations::new(lengths_from + chain.arcs.len(), lengths_from);
    let mut maps = Vec::with_capacity(count);
    for (_, arc, state) in chain.pieces() {
        let share = arc.length / arc.pieces as f64;
        maps.push(mapped(model, &arc.motion, state, share)?);
    }
    let endings: Vec<Ending<'_>> = chain
        .pieces()
        .zip(&maps)
        .enumerate()
        .map(|(i, ((arc_index, arc, _), map))| Ending {
            map,
            column: STATE * i,
            length: (lengths_from + arc_index, 1.0 / arc.pieces as f64),
        })
        .collect();
    let mut first_piece = 0;
    let last = endings.last()?;
    for (index, arc) in chain.arcs.iter().enumerate() {
        let start = Start {
            arc,
            state: chain.states.get(first_piece)?,
            column: STATE * first_piece,
        };
        if let Some(before) = first_piece.checked_sub(1) {
            let leaves = chain.arcs.get(index.checked_sub(1)?)?;
            joint(&mut equations, endings.get(before)?, leaves, &start, scale);
        } else {
            match class {
                Class::Quarter => quarter_ends(&mut equations, &start, last, scale),
                Class::Closed { turn, line } => {
                    let leaves = chain.arcs.last()?;
                    closed_ends(&mut equations, last, leaves, &start, scale, turn);
                    if let Some((point, across)) = line {
                        equations.add(
                            (shape(start.state) - point).dot(&across),
                            [(0, across.x), (1, across.y)],
                        );
                    }
                }
            }
        }
        for piece in first_piece + 1..first_piece + arc.pieces {
            let (ending, next) = (endings.get(piece - 1)?, chain.states.get(piece)?);
            continued(&mut equations, ending, next, STATE * piece, 0..STATE, scale);
        }
        first_piece += arc.pieces;
    }
    scale_condition(&mut equations, chain, &endings, lengths_from);
    (equations.residual.len() == equations.size).then_some(equations)
}

/// The start of an arc.
struct Start<'a> {
    arc: &'a Stretch,
    state: &'a State,
    /// First column of the state.
    column: usize,
}

/// These rows of the state go on from one piece to the next.
fn continued(
    equations: &mut Equations,
    ending: &Ending<'_>,
    next: &State,
    column: usize,
    rows: std::ops::Range<usize>,
    scale: f64,
) {
    for row in rows {
        let weight = if row < 3 { 1.0 } else { 1.0 / scale };
        let (end, start) = (ending.map.end[row], next[row]);
        let own = (column + row, -weight);
        equations.add(
            weight * (end - start),
            ending.slopes(row, weight).chain([own]),
        );
    }
}

/// From one arc to the next.
fn joint(
    equations: &mut Equations,
    ending: &Ending<'_>,
    leaves: &Stretch,
    start: &Start<'_>,
    scale: f64,
) {
    match start.arc.entry {
        Entry::Smooth => {
            continued(
                equations,
                ending,
                start.state,
                start.column,
                0..STATE,
                scale,
            );
            on_wall(equations, start);
            tangent(equations, start);
        }
        Entry::Corner(corner) => {
            ends_at(equations, ending, leaves, &corner);
            starts_at(equations, start, &corner);
            continued(
                equations,
                ending,
                start.state,
                start.column,
                3..STATE,
                scale,
            );
            tangent(equations, start);
        }
    }
}

/// An arc along a bound starts on it.
fn on_wall(equations: &mut Equations, start: &Start<'_>) {
    if let Motion::Along(wall) = &start.arc.motion {
        let phi = shape(start.state);
        let gradient = wall.gradient(&phi);
        equations.add(
            wall.value(&phi),
            [(start.column, gradient.x), (start.column + 1, gradient.y)],
        );
    }
}

/// An arc along a bound starts tangent to it.
fn tangent(equations: &mut Equations, start: &Start<'_>) {
    if let Motion::Along(wall) = &start.arc.motion {
        let phi = shape(start.state);
        let (sin, cos) = start.state[2].sin_cos();
        let gradient = wall.gradient(&phi);
        let by_shape = wall.hessian(&phi) * Vector2::new(cos, sin);
        equations.add(
            gradient.x * cos + gradient.y * sin,
            [
                (start.column, by_shape.x),
                (start.column + 1, by_shape.y),
                (start.column + 2, gradient.y * cos - gradient.x * sin),
            ],
        );
    }
}

/// An arc ends at a corner; one along a bound is on its line already.
fn ends_at(
    equations: &mut Equations,
    ending: &Ending<'_>,
    leaves: &Stretch,
    corner: &Vector2<f64>,
) {
    let end = &ending.map.end;
    match leaves.motion {
        Motion::Free => {
            for row in 0..2 {
                equations.add(end[row] - corner[row], ending.slopes(row, 1.0));
            }
        }
        Motion::Along(_) => {
            let (sin, cos) = end[2].sin_cos();
            equations.add(
                (end[0] - corner.x) * cos + (end[1] - corner.y) * sin,
                ending.slopes(0, cos).chain(ending.slopes(1, sin)),
            );
        }
    }
}

fn starts_at(equations: &mut Equations, start: &Start<'_>, corner: &Vector2<f64>) {
    for row in 0..2 {
        equations.add(start.state[row] - corner[row], [(start.column + row, 1.0)]);
    }
}

/// ∮q' = S: the momentum is the one of an optimum of |d|/S.
fn scale_condition(
    equations: &mut Equations,
    chain: &Chain,
    endings: &[Ending<'_>],
    lengths_from: usize,
) {
    let length = chain.length();
    let gain: f64 = endings.iter().map(|ending| ending.map.gain).sum();
    // Over the length as it is now; the factor's own change does not matter where the equation holds.
    let weight = 1.0 / length;
    let lengths = (0..chain.arcs.len()).map(|arc| (lengths_from + arc, -weight));
    equations.add(
        weight * (gain - length),
        endings
            .iter()
            .flat_map(|ending| ending.slopes(STATE, weight))
            .chain(lengths),
    );
}

fn quarter_ends(equations: &mut Equations, start: &Start<'_>, last: &Ending<'_>, scale: f64) {
    let first = start.state;
    match start.arc.entry {
        Entry::Smooth => {
            equations.add(first[0] - first[1], [(0, 1.0), (1, -1.0)]);
            equations.add(first[2] - 0.75 * PI, [(2, 1.0)]);
            // A bound that is square to φ₁ = φ₂ is met tangentially of itself.
            on_wall(equations, start);
        }
        Entry::Corner(corner) => {
            starts_at(equations, start, &corner);
            tangent(equations, start);
        }
    }
    equations.add(first[4] / scale, [(4, 1.0 / scale)]);
    let end = &last.map.end;
    equations.add(
        end[0] + end[1],
        last.slopes(0, 1.0).chain(last.slopes(1, 1.0)),
    );
    equations.add(end[2] - 1.25 * PI, last.slopes(2, 1.0));
    equations.add(end[5] / scale, last.slopes(5, 1.0 / scale));
}

fn closed_ends(
    equations: &mut Equations,
    last: &Ending<'_>,
    leaves: &Stretch,
    start: &Start<'_>,
    scale: f64,
    turn: f64,
) {
    let (first, end) = (start.state, &last.map.end);
    match start.arc.entry {
        Entry::Smooth => {
            for (row, shift) in [(0, 0.0), (1, 0.0), (2, turn)] {
                equations.add(
                    end[row] - first[row] - shift,
                    last.slopes(row, 1.0).chain([(row, -1.0)]),
                );
            }
            on_wall(equations, start);
            tangent(equations, start);
        }
        Entry::Corner(corner) => {
            ends_at(equations, last, leaves, &corner);
            starts_at(equations, start, &corner);
            tangent(equations, start);
        }
    }
    // The direction of μ_xy; its length closes by itself.
    let weight = 1.0 / (scale * scale);
    equations.add(
        weight * (first[3] * end[4] - first[4] * end[3]),
        last.slopes(4, weight * first[3])
            .chain(last.slopes(3, -weight * first[4]))
            .chain([(3, weight * end[4]), (4, -weight * end[3])]),
    );
    continued(equations, last, first, 0, 5..STATE, scale);
}
