//! Conditions of the shooting: one row of residual and Jacobian per condition on pieces, joints and ends.

use std::f64::consts::PI;
use std::ops::Range;

use nalgebra::{DMatrix, Vector2};
use swimmer_model::Model;

use super::chain::{Chain, Class, Entry, Stretch};
use crate::extremal::equations::{Motion, STATE, State, shape};
use crate::extremal::flow::{Mapped, mapped};
use crate::numerics::worse;

/// Residuals and Jacobian under construction, row by row.
pub(super) struct Equations {
    pub(super) residual: Vec<f64>,
    pub(super) jacobian: DMatrix<f64>,
    /// Scale of the momenta.
    scale: f64,
}

/// End of a piece with its derivatives.
struct Ending<'a> {
    map: &'a Mapped,
    /// First column of the piece's start.
    column: usize,
    /// Column of the arc's length, and the share of the piece in it.
    length: (usize, f64),
}

/// Start of an arc.
struct Start<'a> {
    arc: &'a Stretch,
    state: &'a State,
    /// First column of the state.
    column: usize,
}

impl Ending<'_> {
    /// Derivatives of row `row` of the end (`STATE` for the change of q), times a factor.
    fn slopes(&self, row: usize, factor: f64) -> impl Iterator<Item = (usize, f64)> {
        let column = self.column;
        self.map.by_start[row]
            .iter()
            .enumerate()
            .map(move |(i, slope)| (column + i, factor * slope))
            .chain([(self.length.0, factor * self.map.rate[row] * self.length.1)])
    }
}

/// Assembles all equations of a chain with their Jacobian; pieces are integrated to a local `tolerance`. Returns `None` if a piece
/// cannot be integrated.
pub(super) fn assemble(
    model: &Model<f64>,
    chain: &Chain,
    scale: f64,
    tolerance: f64,
) -> Option<Equations> {
    let count = chain.states.len();
    let lengths_from = STATE * count;
    let size = lengths_from + chain.arcs.len();
    let mut equations = Equations {
        residual: Vec::with_capacity(size),
        jacobian: DMatrix::zeros(size, size),
        scale,
    };
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
            let (ending, leaves) = (endings.get(before)?, chain.arcs.get(index.checked_sub(1)?)?);
            equations.meets(ending, leaves, &start, 0.0);
            equations.continued(ending, start.state, start.column, 3..STATE);
            equations.along_its_bound(&start);
        } else {
            match chain.class {
                Class::Quarter => equations.quarter_ends(&start, last),
                Class::Closed { turn, line } => {
                    equations.meets(last, chain.arcs.last()?, &start, turn);
                    equations.along_its_bound(&start);
                    equations.momentum_closes(last, start.state);
                    if let Some((point, across)) = line {
                        let off = (shape(start.state) - point).dot(&across);
                        equations.add(off, [(0, across.x), (1, across.y)]);
                    }
                }
            }
        }
        for piece in first_piece + 1..first_piece + arc.pieces {
            let (ending, next) = (endings.get(piece - 1)?, chain.states.get(piece)?);
            equations.continued(ending, next, STATE * piece, 0..STATE);
        }
        first_piece += arc.pieces;
    }
    equations.scale_condition(chain, &endings, lengths_from);
    (equations.residual.len() == size).then_some(equations)
}

impl Equations {
    pub(super) fn norm(&self) -> f64 {
        let squares = self.residual.iter().map(|value| value * value);
        squares.sum::<f64>().sqrt()
    }

    /// Largest residual; NaN if any residual is NaN.
    pub(super) fn largest(&self) -> f64 {
        self.residual.iter().map(|one| one.abs()).fold(0.0, worse)
    }

    fn add(&mut self, value: f64, slopes: impl IntoIterator<Item = (usize, f64)>) {
        let row = self.residual.len();
        self.residual.push(value);
        for (column, slope) in slopes {
            if let Some(entry) = self.jacobian.get_mut((row, column)) {
                *entry += slope;
            }
        }
    }

    /// Continuity of these rows of the state from one piece to the next.
    fn continued(&mut self, ending: &Ending<'_>, next: &State, column: usize, rows: Range<usize>) {
        for row in rows {
            let weight = if row < 3 { 1.0 } else { 1.0 / self.scale };
            let off = weight * (ending.map.end[row] - next[row]);
            let own = (column + row, -weight);
            self.add(off, ending.slopes(row, weight).chain([own]));
        }
    }

    /// Continuity from one arc to the next: smooth, with the direction turned by `turn`, or with a kink at a corner. An arc along a bound
    /// that ends at a corner is on its line already.
    fn meets(&mut self, ending: &Ending<'_>, leaves: &Stretch, start: &Start<'_>, turn: f64) {
        let end = &ending.map.end;
        match (start.arc.entry, leaves.motion) {
            (Entry::Smooth, _) => {
                for (row, shift) in [(0, 0.0), (1, 0.0), (2, turn)] {
                    let own = (start.column + row, -1.0);
                    let off = end[row] - start.state[row] - shift;
                    self.add(off, ending.slopes(row, 1.0).chain([own]));
                }
            }
            (Entry::Corner(corner), Motion::Free) => {
                for row in 0..2 {
                    self.add(end[row] - corner[row], ending.slopes(row, 1.0));
                }
                self.starts_at(start, &corner);
            }
            (Entry::Corner(corner), Motion::Along(_)) => {
                let (sin, cos) = end[2].sin_cos();
                let off = (end[0] - corner.x) * cos + (end[1] - corner.y) * sin;
                self.add(off, ending.slopes(0, cos).chain(ending.slopes(1, sin)));
                self.starts_at(start, &corner);
            }
        }
    }

    fn starts_at(&mut self, start: &Start<'_>, corner: &Vector2<f64>) {
        for row in 0..2 {
            self.add(start.state[row] - corner[row], [(start.column + row, 1.0)]);
        }
    }

    /// An arc along a bound starts on it and tangent to it.
    fn along_its_bound(&mut self, start: &Start<'_>) {
        if matches!(start.arc.entry, Entry::Smooth) {
            self.on_wall(start);
        }
        self.tangent(start);
    }

    fn on_wall(&mut self, start: &Start<'_>) {
        if let Motion::Along(wall) = &start.arc.motion {
            let level = wall.level(&shape(start.state));
            let (column, gradient) = (start.column, level.gradient);
            self.add(
                level.value,
                [(column, gradient.x), (column + 1, gradient.y)],
            );
        }
    }

    fn tangent(&mut self, start: &Start<'_>) {
        if let Motion::Along(wall) = &start.arc.motion {
            let (sin, cos) = start.state[2].sin_cos();
            let level = wall.level(&shape(start.state));
            let (column, gradient) = (start.column, level.gradient);
            let by_shape = level.hessian * Vector2::new(cos, sin);
            self.add(
                gradient.x * cos + gradient.y * sin,
                [
                    (column, by_shape.x),
                    (column + 1, by_shape.y),
                    (column + 2, gradient.y * cos - gradient.x * sin),
                ],
            );
        }
    }

    /// ∮q' = S: normalisation of the momentum for the objective |d|/S.
    fn scale_condition(&mut self, chain: &Chain, endings: &[Ending<'_>], lengths_from: usize) {
        let length = chain.length();
        let gain: f64 = endings.iter().map(|ending| ending.map.gain).sum();
        // Relative to the present length; the derivative of the factor vanishes at a solution.
        let weight = 1.0 / length;
        let gains = endings
            .iter()
            .flat_map(|ending| ending.slopes(STATE, weight));
        let lengths = (0..chain.arcs.len()).map(|arc| (lengths_from + arc, -weight));
        self.add(weight * (gain - length), gains.chain(lengths));
    }

    fn quarter_ends(&mut self, start: &Start<'_>, last: &Ending<'_>) {
        let (first, end, scale) = (start.state, &last.map.end, self.scale);
        match start.arc.entry {
            Entry::Smooth => {
                self.add(first[0] - first[1], [(0, 1.0), (1, -1.0)]);
                self.add(first[2] - 0.75 * PI, [(2, 1.0)]);
                // A bound perpendicular to φ₁ = φ₂ implies tangency.
                self.on_wall(start);
            }
            Entry::Corner(corner) => {
                self.starts_at(start, &corner);
                self.tangent(start);
            }
        }
        self.add(first[4] / scale, [(4, 1.0 / scale)]);
        let sum = last.slopes(0, 1.0).chain(last.slopes(1, 1.0));
        self.add(end[0] + end[1], sum);
        self.add(end[2] - 1.25 * PI, last.slopes(2, 1.0));
        self.add(end[5] / scale, last.slopes(5, 1.0 / scale));
    }

    /// Closure of the momentum in its direction and in its last row; its length is conserved by the flow.
    fn momentum_closes(&mut self, last: &Ending<'_>, first: &State) {
        let end = &last.map.end;
        let weight = 1.0 / (self.scale * self.scale);
        self.add(
            weight * (first[3] * end[4] - first[4] * end[3]),
            last.slopes(4, weight * first[3])
                .chain(last.slopes(3, -weight * first[4]))
                .chain([(3, weight * end[4]), (4, -weight * end[3])]),
        );
        self.continued(last, first, 0, 5..STATE);
    }
}
