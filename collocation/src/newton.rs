//! The interior-point iteration on the shapes.
//!
//! Iterates stay strictly inside the walls and on the state equations, so the barrier function itself is the merit function. A
//! step solves Newton's equation by conjugate gradients, which ask for the Hessian along one direction at a time (the
//! gradient's difference along it) and notice where it is not convex. What makes the equation stiff is known: the energy of
//! the steps from point to point and the walls. Preconditioned with these two (`preconditioner`), a few dozen products do.

mod preconditioner;

use gait_optimizer::region::{Bound, Level};
use nalgebra::{Matrix2, Matrix2xX};
use swimmer_model::Model;

use super::guess::bind_ends;
use super::mesh::Mesh;
use super::path::Path;
use super::{CollocationError, HORIZON, levels, lighthill};
use preconditioner::Preconditioner;

/// Where the barrier begins and ends; both count against an objective, ln E − 2 ln x, of order one.
const FIRST_BARRIER: f64 = 1e-3;
const LAST_BARRIER: f64 = 1e-12;
const MOST_ITERATIONS: usize = 200;
const MOST_PRODUCTS: usize = 200;
/// Share of the residual that is left of Newton's equation.
const INEXACT: f64 = 1e-6;
/// Steps below this \[rad\] end the iteration.
const SMALL_STEP: f64 = 1e-8;
/// Longest step of any angle \[rad\], so that the iteration stays with the gait it was started from.
const LONG_STEP: f64 = 0.4;
/// Changes of the shapes over which the gradient's difference is taken \[rad\].
const DIFFERENCE: f64 = 1e-6;

/// One discretised problem.
#[derive(Debug)]
pub(crate) struct Newton<'a> {
    pub(crate) model: &'a Model<f64>,
    pub(crate) mesh: &'a Mesh,
    pub(crate) walls: &'a [Bound],
    /// Of the wanted x.
    pub(crate) sign: f64,
    pub(crate) path: Path,
}

/// A step towards the optimum of the barrier problem.
#[derive(Debug)]
struct Step {
    /// Change of the shape at every point.
    shapes: Matrix2xX<f64>,
    /// Derivative of the barrier function along it; negative.
    slope: f64,
    /// Whether the Hessian was positive along all that was tried.
    convex: bool,
}

impl Newton<'_> {
    /// Iterates to an optimum.
    pub(crate) fn run(mut self) -> Result<Path, CollocationError> {
        let mut barrier = if self.walls.is_empty() {
            0.0
        } else {
            FIRST_BARRIER
        };
        let wrong_way = CollocationError::WrongWay {
            x: self.path.final_x,
            wanted: self.sign,
        };
        let mut here = self.merit(&self.path, barrier).ok_or(wrong_way)?;
        for iteration in 1..=MOST_ITERATIONS {
            let step = self.step(barrier);
            let largest = step.shapes.amax();
            let settled = largest <= SMALL_STEP;
            let next = if let Some((length, path, value)) = self.search(&step, barrier, here) {
                (self.path, here) = (path, value);
                step.convex && length >= 0.9 && (settled || -step.slope <= barrier)
            } else if -step.slope <= 1e-11 {
                // As flat as rounding lets the objective be.
                true
            } else {
                return Err(self.stalled(iteration));
            };
            if next && barrier <= LAST_BARRIER {
                return Ok(self.path);
            } else if next {
                barrier = (barrier * 0.1).min(barrier.powf(1.5)).max(LAST_BARRIER);
                here = self.merit(&self.path, barrier).unwrap_or(f64::INFINITY);
            }
        }
        Err(self.stalled(MOST_ITERATIONS))
    }

    fn stalled(&self, iterations: usize) -> CollocationError {
        CollocationError::Stalled {
            iterations,
            efficiency: lighthill(self.model, self.path.final_x, self.path.final_energy),
        }
    }

    /// The barrier function; none where the path leaves the walls or the horizon, or x has the wrong sign.
    fn merit(&self, path: &Path, barrier: f64) -> Option<f64> {
        let mut value = path.objective(self.sign)?;
        if path.phi.amax() > HORIZON {
            return None;
        }
        for (point, Level { value: margin, .. }) in levels(self.walls, &path.phi) {
            if margin <= 0.0 || margin.is_nan() {
                return None;
            }
            value -= barrier * self.mesh.weights[point] * margin.ln();
        }
        value.is_finite().then_some(value)
    }

    /// Of the barrier function, per shape, the ends on their lines; from that of the objective.
    fn gradient(&self, slope: &Matrix2xX<f64>, barrier: f64) -> Matrix2xX<f64> {
        let mut gradient = slope.clone();
        for (point, level) in levels(self.walls, &self.path.phi) {
            let mut pushed = gradient.column_mut(point);
            pushed -= level.gradient * (self.mesh.weights[point] * barrier / level.value);
        }
        bind_ends(&mut gradient);
        gradient
    }

    /// Newton's step of the barrier problem, or as much of it as is convex.
    fn step(&self, barrier: f64) -> Step {
        let slope = self.path.slope(self.mesh);
        let gradient = self.gradient(&slope, barrier);
        let mut pushes = vec![Matrix2::zeros(); self.mesh.len()];
        let mut curvature = pushes.clone();
        for (point, level) in levels(self.walls, &self.path.phi) {
            let push = self.mesh.weights[point] * barrier / level.value;
            let stiff = level.gradient * level.gradient.transpose() * (push / level.value);
            pushes[point] += stiff;
            curvature[point] += stiff - level.hessian * push;
        }
        let preconditioner = Preconditioner::new(&self.path, self.mesh, &pushes);
        let product = |along: &Matrix2xX<f64>| {
            let size = DIFFERENCE / along.amax();
            let moved = Path::new(self.model, self.mesh, &self.path.phi + along * size);
            let mut changed = (moved.slope(self.mesh) - &slope) / size;
            for (point, curvature) in curvature.iter().enumerate() {
                let mut column = changed.column_mut(point);
                column += curvature * along.column(point);
            }
            bind_ends(&mut changed);
            changed
        };
        let mut shapes = Matrix2xX::zeros(self.mesh.len());
        let mut residual = -&gradient;
        let mut towards = preconditioner.solve(&residual);
        let mut direction = towards.clone();
        let first = residual.dot(&towards);
        let (mut left, mut convex) = (first, true);
        for _ in 0..MOST_PRODUCTS {
            if left <= INEXACT * INEXACT * first {
                break;
            }
            let bent = product(&direction);
            let curved = direction.dot(&bent);
            if curved.is_nan() || curved <= 0.0 {
                convex = false;
                if shapes.amax() <= 0.0 {
                    shapes = direction;
                }
                break;
            }
            shapes += &direction * (left / curved);
            residual -= bent * (left / curved);
            towards = preconditioner.solve(&residual);
            let before = left;
            left = residual.dot(&towards);
            direction = &towards + direction * (left / before);
        }
        Step {
            slope: gradient.dot(&shapes),
            shapes,
            convex,
        }
    }

    /// Backtracks until the barrier function falls as it should: how far, the path there, and its value.
    fn search(&self, step: &Step, barrier: f64, here: f64) -> Option<(f64, Path, f64)> {
        let rounding = 1e-14 * (1.0 + here.abs());
        let mut length = (LONG_STEP / step.shapes.amax()).min(1.0);
        for _ in 0..30 {
            let phi = &self.path.phi + &step.shapes * length;
            let path = Path::new(self.model, self.mesh, phi);
            if let Some(value) = self.merit(&path, barrier)
                && value <= here + 1e-4 * length * step.slope + rounding
            {
                return Some((length, path, value));
            }
            length *= 0.5;
        }
        None
    }
}

#[cfg(test)]
mod tests;
