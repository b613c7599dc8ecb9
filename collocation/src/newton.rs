//! Primal–dual interior-point method on the shapes, with a line search and an inexact Newton step.
//!
//! Iterates stay strictly inside the bounds and satisfy the state equations, so the barrier function is the merit function. The
//! multipliers of the bounds are dual variables of their own; without them Newton's method takes many more steps along active
//! bounds. Conjugate gradients solve the Newton system. They need the Hessian only as products with one direction at a time
//! (finite difference of the gradient) and detect negative curvature. Two terms make the system stiff: the energy of the steps
//! between points, and the bounds. Both are in the preconditioner (`preconditioner`), so a few products suffice.

mod preconditioner;

use gait_optimizer::region::{Bound, Level};
use nalgebra::{Matrix2, Matrix2xX};

use super::error::CollocationError;
use super::guess::bind_ends;
use super::mesh::Mesh;
use super::path::{Path, levels};
use super::problem::CollocationProblem;
use preconditioner::Preconditioner;

const MOST_ITERATIONS: usize = 200;
const MOST_PRODUCTS: usize = 200;
/// Relative residual at which conjugate gradients stop; a more exact step costs more than it saves.
const INEXACT: f64 = 0.05;
/// Step length below which the iteration has converged \[rad\].
const SMALL_STEP: f64 = 1e-7;
/// Largest change of an angle in one step \[rad\], so that the iteration stays near the gait from which it was started.
const LONG_STEP: f64 = 0.4;
/// Largest factor between a multiplier and barrier over margin, its value on the central path.
const OFF_CENTRE: f64 = 1e4;
/// Step of the finite difference of the gradient \[rad\].
const DIFFERENCE: f64 = 1e-6;
/// Limit of the angles if there is no bound: two turns \[rad\].
const HORIZON: f64 = 2.0 * std::f64::consts::TAU;

/// Interior-point iteration of one discretised problem.
#[derive(Debug)]
pub(crate) struct Newton<'a> {
    problem: &'a CollocationProblem<'a>,
    mesh: &'a Mesh,
    walls: &'a [Bound],
    path: Path,
    /// Barrier parameter.
    barrier: f64,
    /// Density of each bound's multiplier at each point, in the order of [`levels`].
    multipliers: Vec<f64>,
}

impl<'a> Newton<'a> {
    /// Starts from shapes strictly inside the bounds, with the initial barrier parameter.
    pub(crate) fn new(
        problem: &'a CollocationProblem<'a>,
        mesh: &'a Mesh,
        walls: &'a [Bound],
        phi: Matrix2xX<f64>,
        barrier: f64,
    ) -> Self {
        let central = levels(walls, &phi).map(|(_, level)| barrier / level.value);
        Self {
            problem,
            mesh,
            walls,
            barrier: if walls.is_empty() { 0.0 } else { barrier },
            multipliers: central.collect(),
            path: Path::new(problem.model, mesh, phi),
        }
    }

    /// Iterates until convergence while the barrier parameter decreases to `last_barrier`.
    pub(crate) fn run(mut self, last_barrier: f64) -> Result<Path, CollocationError> {
        let (x, wanted) = (self.path.final_x, self.problem.sign);
        let wrong_way = CollocationError::WrongWay { x, wanted };
        let mut here = self.merit(&self.path).ok_or(wrong_way)?;
        let mut iterations = 0;
        while iterations < MOST_ITERATIONS {
            iterations += 1;
            let (slope, step, convex) = self.step(INEXACT);
            let settled = step.amax() <= SMALL_STEP;
            let next = match self.search(&step, slope, here) {
                Some((length, path, value)) => {
                    self.move_multipliers(&step, length, &path);
                    (self.path, here) = (path, value);
                    convex && length >= 0.9 && (settled || -slope <= self.barrier)
                }
                // Stationary to rounding.
                None if -slope <= 1e-11 => true,
                None => break,
            };
            if next && self.barrier <= last_barrier {
                return Ok(self.path);
            } else if next {
                let lower = (self.barrier * 0.1).min(self.barrier.powf(1.5));
                self.barrier = lower.max(last_barrier);
                here = self.merit(&self.path).unwrap_or(f64::INFINITY);
            }
        }
        Err(CollocationError::Stalled {
            iterations,
            efficiency: self.path.efficiency(self.problem.model),
        })
    }

    /// Barrier function. Returns `None` if the path leaves the bounds or the horizon, or if x has the wrong sign.
    fn merit(&self, path: &Path) -> Option<f64> {
        let mut value = path.objective(self.problem.sign)?;
        if path.phi.amax() > HORIZON {
            return None;
        }
        for (point, Level { value: margin, .. }) in levels(self.walls, &path.phi) {
            // The logarithm of a negative margin is NaN.
            value -= self.barrier * self.mesh.weights[point] * margin.ln();
        }
        value.is_finite().then_some(value)
    }

    /// Gradient of the barrier function with respect to each shape, with both ends restricted to their symmetry lines; `slope` is
    /// the gradient of the objective.
    fn gradient(&self, slope: &Matrix2xX<f64>) -> Matrix2xX<f64> {
        let mut gradient = slope.clone();
        for (point, level) in levels(self.walls, &self.path.phi) {
            let mut pushed = gradient.column_mut(point);
            pushed -= level.gradient * (self.mesh.weights[point] * self.barrier / level.value);
        }
        bind_ends(&mut gradient);
        gradient
    }

    /// Newton step of the barrier problem by truncated conjugate gradients. Returns the directional derivative of the barrier
    /// function, the change of the shapes, and `true` if no direction of negative curvature was met.
    fn step(&self, inexact: f64) -> (f64, Matrix2xX<f64>, bool) {
        let slope = self.path.slope(self.mesh);
        let gradient = self.gradient(&slope);
        let mut pushes = vec![Matrix2::zeros(); self.mesh.len()];
        let mut curvature = pushes.clone();
        let walls = levels(self.walls, &self.path.phi);
        for ((point, level), multiplier) in walls.zip(&self.multipliers) {
            let push = self.mesh.weights[point] * multiplier;
            let stiff = level.gradient * level.gradient.transpose() * (push / level.value);
            pushes[point] += stiff;
            curvature[point] += stiff - level.hessian * push;
        }
        let preconditioner = Preconditioner::new(&self.path, self.mesh, &pushes);
        let product = |along: &Matrix2xX<f64>| {
            let size = DIFFERENCE / along.amax();
            let moved = Path::new(self.problem.model, self.mesh, &self.path.phi + along * size);
            let mut changed = (moved.slope(self.mesh) - &slope) / size;
            for (point, curvature) in curvature.iter().enumerate() {
                let mut column = changed.column_mut(point);
                column += curvature * along.column(point);
            }
            bind_ends(&mut changed);
            changed
        };
        let mut shapes = Matrix2xX::zeros(self.mesh.len());
        let mut direction = shapes.clone();
        let mut residual = -&gradient;
        let (mut first, mut before, mut convex) = (0.0, f64::INFINITY, true);
        for _ in 0..MOST_PRODUCTS {
            let towards = preconditioner.solve(&residual);
            let left = residual.dot(&towards);
            first = left.max(first);
            if left <= inexact * inexact * first {
                break;
            }
            direction = towards + direction * (left / before);
            before = left;
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
        }
        (gradient.dot(&shapes), shapes, convex)
    }

    /// Backtracking line search with the Armijo condition. Returns step length, path and barrier function.
    fn search(&self, step: &Matrix2xX<f64>, slope: f64, here: f64) -> Option<(f64, Path, f64)> {
        let rounding = 1e-14 * (1.0 + here.abs());
        let mut length = (LONG_STEP / step.amax()).min(1.0);
        for _ in 0..30 {
            let phi = &self.path.phi + step * length;
            // Reject shapes outside the bounds before the states are integrated.
            let inside = levels(self.walls, &phi).all(|(_, level)| level.value > 0.0);
            let path = inside.then(|| Path::new(self.problem.model, self.mesh, phi));
            if let Some(path) = path
                && let Some(value) = self.merit(&path)
                && value <= here + 1e-4 * length * slope + rounding
            {
                return Some((length, path, value));
            }
            length *= 0.5;
        }
        None
    }

    /// Updates the multipliers by the dual step, then limits their distance from the central path of the new shapes.
    fn move_multipliers(&mut self, step: &Matrix2xX<f64>, length: f64, next: &Path) {
        let walls = levels(self.walls, &self.path.phi).zip(levels(self.walls, &next.phi));
        for (((point, level), (_, there)), multiplier) in walls.zip(&mut self.multipliers) {
            let opening = level.gradient.dot(&step.column(point));
            let wanted = (self.barrier - *multiplier * opening) / level.value;
            let central = self.barrier / there.value;
            *multiplier = (*multiplier + (wanted - *multiplier) * length)
                .clamp(central / OFF_CENTRE, central * OFF_CENTRE);
        }
    }
}

#[cfg(test)]
mod tests;
