//! What is asked of a chain: one row of residual and Jacobian for every condition on its pieces, joints and ends.

use std::f64::consts::PI;

use nalgebra::Vector2;
use swimmer_model::Model;

use super::chain::{Chain, Class, Entry, Stretch};
use crate::extremal::elimination::System;
use crate::extremal::equations::{Motion, STATE, State, shape};
use crate::extremal::flow::{Mapped, mapped};

/// Residuals and Jacobian under construction, row by row.
pub(super) struct Equations {
    pub(super) residual: Vec<f64>,
    pub(super) jacobian: System,
    size: usize,
}

impl Equations {
    fn new(size: usize) -> Self {
        Self {
            residual: Vec::with_capacity(size),
            jacobian: System::new(size),
            size,
        }
    }

    pub(super) fn norm(&self) -> f64 {
        self.residual
            .iter()
            .map(|value| value * value)
            .sum::<f64>()
            .sqrt()
    }

    /// NaN where any residual is.
    pub(super) fn largest(&self) -> f64 {
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

/// All equations of a chain with their Jacobian, its pieces integrated to a local `tolerance`; none where a piece cannot be integrated.
pub(super) fn assemble(
    model: &Model<f64>,
    class: Class,
    chain: &Chain,
    scale: f64,
    tolerance: f64,
) -> Option<Equations> {
    let count = chain.states.len();
    let lengths_from = STATE * count;
    let mut equations = Equations::new(lengths_from + chain.arcs.len());
    let mut maps = Vec::with_capacity(count);
    for (_, arc, state) in chain.pieces() {
        let share = arc.length / arc.pieces as f64;
        maps.push(mapped(model, &arc.motion, state, share, tolerance)?);
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
        let level = wall.level(&phi);
        let gradient = level.gradient;
        equations.add(
            level.value,
            [(start.column, gradient.x), (start.column + 1, gradient.y)],
        );
    }
}

/// An arc along a bound starts tangent to it.
fn tangent(equations: &mut Equations, start: &Start<'_>) {
    if let Motion::Along(wall) = &start.arc.motion {
        let phi = shape(start.state);
        let (sin, cos) = start.state[2].sin_cos();
        let level = wall.level(&phi);
        let gradient = level.gradient;
        let by_shape = level.hessian * Vector2::new(cos, sin);
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
