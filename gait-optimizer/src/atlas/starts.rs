//! Random closed curves as starts: Fourier series of order 1 to 4, of several sizes, centres and aspects, with and without the
//! paper's two symmetries. Each start has its own stream of the generator and is independent of the others.

use nalgebra::{DMatrix, Vector2};
use rand::{RngExt, SeedableRng};
use rand_chacha::ChaCha8Rng;

use swimmer_model::Gait;

use super::barrier::Barrier;
use crate::closed_curve::Basis;
use crate::optimal_gait::OptimalGait;

/// Highest order of a start.
const MOST_HARMONICS: usize = 4;
/// Scale of a start relative to the distance of the bounds.
const INSIDE: f64 = 0.97;

/// Returns the coefficients of a start in a Fourier basis, inside the barrier.
pub(crate) fn start(basis: &Basis, barrier: &Barrier, seed: u64, index: usize) -> DMatrix<f64> {
    let mut rng = ChaCha8Rng::seed_from_u64(seed);
    rng.set_stream(index as u64);
    let functions = basis.functions();
    let reach = barrier.max_angle();
    let size = reach * rng.random_range(0.12..1.0);
    let highest = rng.random_range(1..=MOST_HARMONICS).min(functions / 2);
    let mut curve = DMatrix::zeros(2, functions);
    // Along the diagonals φ₁ = φ₂ and φ₁ = −φ₂.
    let mut set = |function: usize, along: f64, across: f64| {
        if function < functions {
            let half = std::f64::consts::FRAC_1_SQRT_2;
            curve[(0, function)] = (along - across) * half;
            curve[(1, function)] = (along + across) * half;
        }
    };
    let symmetric = index.is_multiple_of(3);
    if symmetric {
        for k in (1..=highest).step_by(2) {
            let part = size / (k * k) as f64;
            let (a, b) = if k == 1 {
                (1.0, rng.random_range(0.3..1.5))
            } else {
                (rng.random_range(-1.0..1.0), rng.random_range(-1.0..1.0))
            };
            set(2 * k - 1, part * a, 0.0);
            set(2 * k, 0.0, part * b);
        }
    } else {
        let free = (reach - size).max(0.1 * reach);
        let mut draw = |largest: f64| rng.random_range(-largest..largest);
        set(0, draw(free), draw(free));
        let (turn, aspect) = (draw(std::f64::consts::PI), 0.65 + draw(0.5));
        let (sin, cos) = turn.sin_cos();
        set(1, size * cos, size * sin);
        set(2, -size * aspect * sin, size * aspect * cos);
        for k in 2..=highest {
            let part = 1.2 * size / (k * k) as f64;
            set(2 * k - 1, draw(part), draw(part));
            set(2 * k, draw(part), draw(part));
        }
    }
    shrink_into(&mut curve, basis, barrier);
    curve
}

/// Circle around a shape with φ₁ = −φ₂, half way to the bound, on either side and in two sizes.
pub(crate) fn off_centre(basis: &Basis, barrier: &Barrier, index: usize) -> DMatrix<f64> {
    let reach = barrier.max_angle().min(std::f64::consts::PI);
    let side = if index.is_multiple_of(2) { 1.0 } else { -1.0 };
    let radius = if index < 2 { 0.35 } else { 0.2 } * reach;
    let mut curve = DMatrix::zeros(2, basis.functions());
    curve[(0, 0)] = -0.6 * side * reach;
    curve[(1, 0)] = 0.6 * side * reach;
    curve[(0, 1)] = radius;
    curve[(1, 2)] = radius;
    shrink_into(&mut curve, basis, barrier);
    curve
}

/// Fits a series of the basis's order to a gait's cycle and scales it into the barrier.
pub(crate) fn fitted(gait: &OptimalGait, basis: &Basis, barrier: &Barrier) -> DMatrix<f64> {
    const SAMPLES: usize = 512;
    let u = (0..=SAMPLES).map(|k| k as f64 / SAMPLES as f64);
    let points: Vec<_> = match gait.gait() {
        Ok(gait) => u.map(|u| (u, gait.at(u).phi)).collect(),
        Err(_) => Vec::new(),
    };
    through(&points, basis, barrier)
}

/// Fits a series of the basis's order to shapes with their u from 0 to 1 and scales it into the barrier.
pub(crate) fn through(
    points: &[(f64, Vector2<f64>)],
    basis: &Basis,
    barrier: &Barrier,
) -> DMatrix<f64> {
    let mut curve = DMatrix::zeros(2, basis.functions());
    let mut here = vec![(0.0, 0.0); basis.functions()];
    for &[(from, a), (to, b)] in points.array_windows() {
        for (u, phi) in [(from, a), (to, b)] {
            basis.at(u, &mut here);
            for (j, (value, _)) in here.iter().enumerate() {
                let weight = if j == 0 { 0.5 } else { 1.0 } * (to - from);
                curve[(0, j)] += weight * value * phi.x;
                curve[(1, j)] += weight * value * phi.y;
            }
        }
    }
    shrink_into(&mut curve, basis, barrier);
    curve
}

/// Scales a curve about the straight swimmer until it is inside the barrier.
pub(crate) fn shrink_into(curve: &mut DMatrix<f64>, basis: &Basis, barrier: &Barrier) {
    for _ in 0..200 {
        let inside = (0..basis.nodes()).all(|node| {
            let shape = curve as &DMatrix<f64> * basis.values.column(node);
            barrier.least(&Vector2::new(shape[0], shape[1])) > (1.0 - INSIDE) * 0.1
        });
        if inside {
            return;
        }
        *curve *= INSIDE;
    }
}
