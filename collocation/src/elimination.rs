//! The block recursion: from the last element to the first each one eliminates its own nodes, hands a quadratic in its first
//! shape and heading to the element before, and the step is read off on the way back.
//!
//! Each elimination is a partial Cholesky factorisation. All of them succeed if and only if the Hessian, reduced to the
//! shapes, is positive definite: the second-order condition comes with the solution.

use nalgebra::Vector2;

use super::block::{Block, SIDES};
use super::mesh::Mesh;
use super::path::Path;

/// What the elimination of an element hands to the one before: a quadratic in (φ₁, φ₂, θ), with its right-hand sides.
#[derive(Debug, Clone, Copy, Default)]
struct Handed {
    matrix: [[f64; 3]; 3],
    sides: [[f64; 3]; SIDES],
}

/// The solutions for all right-hand sides, one shape per point each.
#[derive(Debug, Clone)]
pub(crate) struct Solutions(pub(crate) [Vec<Vector2<f64>>; SIDES]);

/// Turns the last shape to lie along φ₁ = −φ₂: columns (φ₂ − φ₁)/√2, which is free, and (φ₁ + φ₂)/√2, which is not.
const HALF: f64 = std::f64::consts::FRAC_1_SQRT_2;

/// Factors all blocks, the matrix shifted by `shift` times a mass at every node; false where it is not positive definite.
pub(crate) fn factor(blocks: &mut [Block], mesh: &Mesh, path: &Path, shift: f64) -> bool {
    let mut handed = Handed::default();
    let count = blocks.len();
    for (k, block) in blocks.iter_mut().enumerate().rev() {
        block.factor.copy_from_slice(&block.matrix);
        if shift > 0.0 {
            add_mass(block, mesh, path, k, shift);
        }
        if k + 1 == count {
            bind_last(block);
        } else {
            take(block, &handed);
        }
        if !eliminate(block) {
            return false;
        }
        handed = hand_on(block);
    }
    // What is left: the first shape on φ₁ = φ₂.
    start_stiffness(&handed) > 0.0
}

/// Solves for every right-hand side after [`factor`].
pub(crate) fn solve(blocks: &[Block], mesh: &Mesh) -> Solutions {
    let mut solutions = Solutions(std::array::from_fn(|_| vec![Vector2::zeros(); mesh.len()]));
    let Some(first) = blocks.first() else {
        return solutions;
    };
    let handed = hand_on(first);
    let largest = blocks.iter().map(|block| block.size).max().unwrap_or(0);
    let mut unknowns = vec![0.0; largest];
    for (side, solution) in solutions.0.iter_mut().enumerate() {
        let rhs = &handed.sides[side];
        let start = -HALF * (rhs[0] + rhs[1]) / start_stiffness(&handed) * HALF;
        solution[0] = Vector2::new(start, start);
        let mut theta = 0.0;
        for (k, (block, element)) in blocks.iter().zip(&mesh.elements).enumerate() {
            let unknowns = &mut unknowns[..block.size];
            let before = solution[element.first];
            unknowns[block.inner..].copy_from_slice(&[before.x, before.y, theta]);
            substitute_back(block, side, unknowns);
            if k + 1 == blocks.len() {
                let along = unknowns[block.inner - 2];
                unknowns[block.inner - 2] = -HALF * along;
                unknowns[block.inner - 1] = HALF * along;
            }
            for j in 1..=element.rule.degree {
                let at = block.place(j);
                solution[element.first + j] = Vector2::new(unknowns[at], unknowns[at + 1]);
            }
            theta = block
                .end_heading
                .iter()
                .zip(unknowns.iter())
                .map(|(share, value)| share * value)
                .sum();
        }
    }
    solutions
}

/// Adds a positive diagonal, of the size of the power matrix and the weight of each node.
fn add_mass(block: &mut Block, mesh: &Mesh, path: &Path, k: usize, shift: f64) {
    let n = block.size;
    let Some(element) = mesh.elements.get(k) else {
        return;
    };
    for (j, weight) in (1..=element.rule.degree).zip(element.rule.weights()) {
        let power = &path.nodes[element.first + j].power;
        let mass = shift * element.length * weight * power.trace() / path.final_energy;
        let at = block.place(j);
        block.factor[at * n + at] += mass;
        block.factor[(at + 1) * n + at + 1] += mass;
    }
    if k == 0 {
        let at = block.place(0);
        let mass = shift * element.length * path.nodes[1].power.trace() / path.final_energy;
        block.factor[at * n + at] += mass;
        block.factor[(at + 1) * n + at + 1] += mass;
    }
}

/// Fixes φ₁ + φ₂ at the last point.
fn bind_last(block: &mut Block) {
    let n = block.size;
    let at = block.inner - 2;
    let free = |a: f64, b: f64| HALF * (b - a);
    let corner = {
        let (a, b, c) = (
            block.factor[at * n + at],
            block.factor[(at + 1) * n + at],
            block.factor[(at + 1) * n + at + 1],
        );
        0.5 * (a - 2.0 * b + c)
    };
    for column in 0..at {
        let (a, b) = (
            block.factor[at * n + column],
            block.factor[(at + 1) * n + column],
        );
        block.factor[at * n + column] = free(a, b);
        block.factor[(at + 1) * n + column] = 0.0;
    }
    block.factor[at * n + at] = corner;
    block.factor[(at + 1) * n + at] = 0.0;
    block.factor[(at + 1) * n + at + 1] = 1.0;
    for row in at + 2..n + SIDES {
        let (a, b) = (block.factor[row * n + at], block.factor[row * n + at + 1]);
        block.factor[row * n + at] = free(a, b);
        block.factor[row * n + at + 1] = 0.0;
    }
}

/// Adds what the element after this one handed on; its heading is this one's at the end.
fn take(block: &mut Block, handed: &Handed) {
    let n = block.size;
    let at = block.inner - 2;
    let Block {
        factor,
        end_heading,
        ..
    } = block;
    let [[_, _, _], [_, _, _], [cross1, cross2, stiff]] = handed.matrix;
    for i in 0..2 {
        for l in 0..=i {
            factor[(at + i) * n + at + l] += handed.matrix[i][l];
        }
        let cross = [cross1, cross2][i];
        for (y, heading) in end_heading.iter().enumerate() {
            let (a, b) = (at + i, y);
            let twice = if a == b { 2.0 } else { 1.0 };
            factor[a.max(b) * n + a.min(b)] += twice * cross * heading;
        }
    }
    for (a, row) in factor.chunks_exact_mut(n).take(n).enumerate() {
        let share = stiff * end_heading[a];
        for (value, heading) in row[..=a].iter_mut().zip(end_heading.iter()) {
            *value += share * heading;
        }
    }
    for (row, side) in factor[n * n..].chunks_exact_mut(n).zip(&handed.sides) {
        row[at] += side[0];
        row[at + 1] += side[1];
        for (value, heading) in row.iter_mut().zip(end_heading.iter()) {
            *value += side[2] * heading;
        }
    }
}

/// Cholesky factorisation of the inner unknowns; the last three and the right-hand sides become their Schur complements.
/// False where the inner part is not positive definite.
fn eliminate(block: &mut Block) -> bool {
    let (n, inner) = (block.size, block.inner);
    for i in 0..n + SIDES {
        let (above, rest) = block.factor.split_at_mut(i * n);
        let row = &mut rest[..n];
        for j in 0..inner.min(i) {
            let other = &above[j * n..=j * n + j];
            row[j] = (row[j] - dot(&row[..j], other)) / other[j];
        }
        if i < inner {
            let whole = row[i];
            let pivot = whole - dot(&row[..i], &row[..i]);
            if pivot <= 1e-13 * whole.abs() || pivot.is_nan() {
                return false;
            }
            row[i] = pivot.sqrt();
        } else {
            for j in inner..n.min(i + 1) {
                let done = if j == i {
                    dot(&row[..inner], &row[..inner])
                } else {
                    dot(&row[..inner], &above[j * n..j * n + inner])
                };
                row[j] -= done;
            }
        }
    }
    true
}

fn hand_on(block: &Block) -> Handed {
    let (n, inner) = (block.size, block.inner);
    let mut handed = Handed::default();
    for i in 0..3 {
        for l in 0..=i {
            let value = block.factor[(inner + i) * n + inner + l];
            handed.matrix[i][l] = value;
            handed.matrix[l][i] = value;
        }
        for (side, values) in handed.sides.iter_mut().enumerate() {
            values[i] = block.factor[(n + side) * n + inner + i];
        }
    }
    handed
}

/// Stiffness of the first shape along φ₁ = φ₂.
fn start_stiffness(handed: &Handed) -> f64 {
    let m = &handed.matrix;
    0.5 * (m[0][0] + 2.0 * m[1][0] + m[1][1])
}

/// The inner unknowns from the last three, which are in place.
fn substitute_back(block: &Block, side: usize, unknowns: &mut [f64]) {
    let (n, inner) = (block.size, block.inner);
    let right = &block.factor[(n + side) * n..(n + side) * n + inner];
    let (inside, last) = unknowns.split_at_mut(inner);
    for (value, right) in inside.iter_mut().zip(right) {
        *value = -right;
    }
    for (i, known) in (inner..n).zip(last.iter()) {
        subtract(inside, &block.factor[i * n..i * n + inner], *known);
    }
    for k in (0..inner).rev() {
        let row = &block.factor[k * n..=k * n + k];
        let value = inside[k] / row[k];
        inside[k] = value;
        subtract(&mut inside[..k], row, value);
    }
}

fn subtract(values: &mut [f64], row: &[f64], times: f64) {
    for (value, entry) in values.iter_mut().zip(row) {
        *value -= entry * times;
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}
