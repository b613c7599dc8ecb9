//! The primal–dual interior-point iteration on the shapes.
//!
//! Iterates stay strictly inside the walls and on the state equations, so the barrier function itself is the merit function
//! and a Newton step with a positive definite matrix always descends.

mod step;

use nalgebra::Vector2;
use swimmer_model::Model;

use super::CollocationError;
use super::block::{Block, Prices};
use super::elimination::{factor, solve};
use super::mesh::Mesh;
use super::path::Path;
use super::walls::{Wall, wall_term};
use step::Step;

/// Where the barrier begins and ends; both count against an objective, ln E − 2 ln x, of order one.
pub(crate) const FIRST_BARRIER: f64 = 1e-3;
pub(crate) const LAST_BARRIER: f64 = 1e-12;
const MOST_ITERATIONS: usize = 200;
/// Steps below this \[rad\] end the iteration; convergence is quadratic there.
const SMALL_STEP: f64 = 1e-8;
/// Longest step of any angle \[rad\], so that the iteration stays with the gait it was started from.
const LONG_STEP: f64 = 0.4;

/// One discretised problem.
#[derive(Debug)]
pub(crate) struct Newton<'a> {
    pub(crate) model: &'a Model<f64>,
    pub(crate) mesh: &'a Mesh,
    pub(crate) walls: &'a [Wall],
    /// Of the wanted x.
    pub(crate) sign: f64,
    /// No angle leaves this \[rad\].
    pub(crate) horizon: f64,
    blocks: Vec<Block>,
    /// Quadrature weight of each point; its walls count that much.
    weights: Vec<f64>,
    path: Path,
    trial: Path,
    /// Multiplier density of each wall at each point.
    multipliers: Vec<f64>,
    lambda_theta: Vec<f64>,
}

/// What the iteration ended with.
#[derive(Debug)]
pub(crate) struct Optimum {
    pub(crate) path: Path,
    pub(crate) multipliers: Vec<f64>,
    /// Costate of θ at each node for `x_f` alone; the first entry is at t = 0.
    pub(crate) lambda_theta: Vec<f64>,
    pub(crate) iterations: usize,
    /// Largest last step \[rad\].
    pub(crate) last_step: f64,
}

impl<'a> Newton<'a> {
    pub(crate) fn new(
        model: &'a Model<f64>,
        mesh: &'a Mesh,
        walls: &'a [Wall],
        sign: f64,
        horizon: f64,
        phi: Vec<Vector2<f64>>,
    ) -> Self {
        let path = Path::new(model, mesh, phi);
        let mut weights = vec![0.0; mesh.len()];
        for element in &mesh.elements {
            for (weight, share) in weights[element.first + 1..]
                .iter_mut()
                .zip(element.rule.weights())
            {
                *weight = element.length * share;
            }
        }
        // The first point is no node; it counts as much as the last one, which is as near to an end.
        weights[0] = weights.last().copied().unwrap_or(1.0);
        Self {
            model,
            mesh,
            walls,
            sign,
            horizon,
            blocks: mesh
                .elements
                .iter()
                .map(|element| Block::new(element.rule.degree))
                .collect(),
            weights,
            trial: path.clone(),
            multipliers: vec![0.0; walls.len() * mesh.len()],
            lambda_theta: vec![0.0; mesh.len()],
            path,
        }
    }

    /// Iterates to an optimum, the barrier beginning at `barrier`.
    pub(crate) fn run(mut self, barrier: f64) -> Result<Optimum, CollocationError> {
        let mut barrier = if self.walls.is_empty() { 0.0 } else { barrier };
        self.reset_multipliers(barrier);
        let mut here = self
            .merit(&self.path, barrier)
            .ok_or(CollocationError::WrongWay {
                x: self.path.final_x,
                wanted: self.sign,
            })?;
        let mut shift = 0.0;
        for iteration in 1..=MOST_ITERATIONS {
            let Some(step) = self.step(barrier, &mut shift) else {
                return Err(self.stalled(iteration));
            };
            let largest = step.shapes.iter().map(Vector2::amax).fold(0.0, f64::max);
            let settled = -step.slope <= 1e-18 || largest <= SMALL_STEP;
            let longest = self.longest(&step.shapes).min(LONG_STEP / largest);
            let taken = self.search(&step, barrier, here, longest.min(1.0), settled);
            let Some((length, value)) = taken else {
                if -step.slope <= 1e-11 {
                    // As flat as rounding lets the objective be.
                    if barrier <= LAST_BARRIER {
                        return Ok(self.done(iteration, largest));
                    }
                    (barrier, here) = self.lower(barrier);
                    continue;
                }
                if !step.convex && shift > 1e6 {
                    return Err(self.stalled(iteration));
                }
                shift = (shift * 10.0).max(1e-2);
                continue;
            };
            self.move_multipliers(&step.shapes, barrier, length);
            std::mem::swap(&mut self.path, &mut self.trial);
            here = value;
            if settled && step.convex && length >= 1.0 {
                if barrier <= LAST_BARRIER {
                    return Ok(self.done(iteration, largest));
                }
                (barrier, here) = self.lower(barrier);
            } else if -step.slope <= barrier && length >= 0.9 && step.convex {
                (barrier, here) = self.lower(barrier);
            }
        }
        Err(self.stalled(MOST_ITERATIONS))
    }

    fn stalled(&self, iterations: usize) -> CollocationError {
        CollocationError::Stalled {
            iterations,
            efficiency: super::lighthill(self.model, &self.path),
        }
    }

    fn done(mut self, iterations: usize, last_step: f64) -> Optimum {
        // The costates belong to the last path.
        self.assemble(0.0);
        Optimum {
            path: self.path,
            multipliers: self.multipliers,
            lambda_theta: self.lambda_theta,
            iterations,
            last_step,
        }
    }

    fn lower(&self, barrier: f64) -> (f64, f64) {
        let lower = (barrier * 0.1).min(barrier.powf(1.5)).max(LAST_BARRIER);
        let value = self.merit(&self.path, lower).unwrap_or(f64::INFINITY);
        (lower, value)
    }

    /// The barrier function; none where the path leaves the walls or the horizon, or x has the wrong sign.
    fn merit(&self, path: &Path, barrier: f64) -> Option<f64> {
        let mut value = path.objective(self.sign)?;
        let far = |phi: &Vector2<f64>| {
            phi.iter()
                .any(|angle| angle.is_nan() || angle.abs() > self.horizon)
        };
        if path.phi.iter().any(far) {
            return None;
        }
        for (phi, weight) in path.phi.iter().zip(&self.weights) {
            for wall in self.walls {
                let margin = wall.value(phi);
                if margin <= 0.0 || margin.is_nan() {
                    return None;
                }
                value -= barrier * weight * margin.ln();
            }
        }
        value.is_finite().then_some(value)
    }

    /// Multipliers on the central path.
    fn reset_multipliers(&mut self, barrier: f64) {
        let walls = self.walls.len();
        for (phi, multipliers) in self
            .path
            .phi
            .iter()
            .zip(self.multipliers.chunks_exact_mut(walls.max(1)))
        {
            for (multiplier, wall) in multipliers.iter_mut().zip(self.walls) {
                *multiplier = barrier / wall.value(phi);
            }
        }
    }

    /// Gradient and Hessian at the path.
    fn assemble(&mut self, barrier: f64) {
        let prices = Prices {
            x: -2.0 / self.path.final_x,
            energy: 1.0 / self.path.final_energy,
        };
        let walls = self.walls.len();
        let mut later = 0.0;
        for (k, (block, element)) in self
            .blocks
            .iter_mut()
            .zip(&self.mesh.elements)
            .enumerate()
            .rev()
        {
            later = block.assemble(
                self.model,
                element,
                &self.path,
                prices,
                later,
                &mut self.lambda_theta,
            );
            if walls == 0 {
                continue;
            }
            for j in usize::from(k > 0)..=element.rule.degree {
                let point = element.first + j;
                let term = wall_term(
                    self.walls,
                    &self.multipliers[point * walls..(point + 1) * walls],
                    &self.path.phi[point],
                    barrier,
                    self.weights[point],
                );
                block.add_walls(j, &term);
            }
        }
        self.lambda_theta[0] = later;
    }

    /// The Newton step of the barrier problem; none where no shift makes its matrix positive definite.
    fn step(&mut self, barrier: f64, shift: &mut f64) -> Option<Step> {
        self.assemble(barrier);
        // A shift that was needed before is likely to be needed still, but smaller.
        let mut trial = if *shift > 1e-3 { *shift / 5.0 } else { 0.0 };
        let mut attempts = 0;
        while !factor(&mut self.blocks, self.mesh, &self.path, trial) {
            attempts += 1;
            if attempts > 40 {
                return None;
            }
            trial = if trial == 0.0 { 1e-2 } else { trial * 4.0 };
        }
        *shift = trial;
        let solutions = solve(&self.blocks, self.mesh);
        let step = self.combine(&solutions, trial == 0.0);
        (step.slope <= 0.0 && step.shapes.iter().flatten().all(|angle| angle.is_finite()))
            .then_some(step)
    }

    /// How much of the step the walls let pass.
    fn longest(&self, shapes: &[Vector2<f64>]) -> f64 {
        let mut longest = f64::INFINITY;
        for (phi, change) in self.path.phi.iter().zip(shapes) {
            for wall in self.walls {
                let margin = wall.margin(phi);
                let towards = -margin.gradient.dot(change);
                if towards > 0.0 {
                    longest = longest.min(0.99 * margin.value / towards);
                }
            }
        }
        longest
    }

    /// Backtracks until the barrier function falls as it should; leaves the new path in `trial`.
    fn search(
        &mut self,
        step: &Step,
        barrier: f64,
        here: f64,
        longest: f64,
        settled: bool,
    ) -> Option<(f64, f64)> {
        let mut length = longest;
        let rounding = 1e-14 * (1.0 + here.abs());
        for _ in 0..if settled { 3 } else { 30 } {
            for ((phi, old), change) in self
                .trial
                .phi
                .iter_mut()
                .zip(&self.path.phi)
                .zip(&step.shapes)
            {
                *phi = old + change * length;
            }
            self.trial.follow(self.model, self.mesh);
            if let Some(value) = self.merit(&self.trial, barrier)
                && value <= here + 1e-4 * length * step.slope + rounding
            {
                return Some((length, value));
            }
            length *= 0.5;
        }
        None
    }

    /// The dual step, no farther than keeps every multiplier positive, and back near the central path of the new shapes.
    fn move_multipliers(&mut self, shapes: &[Vector2<f64>], barrier: f64, length: f64) {
        let walls = self.walls.len();
        if walls == 0 {
            return;
        }
        for (point, multipliers) in self.multipliers.chunks_exact_mut(walls).enumerate() {
            let (phi, next) = (&self.path.phi[point], &self.trial.phi[point]);
            for (multiplier, wall) in multipliers.iter_mut().zip(self.walls) {
                let margin = wall.margin(phi);
                let opening = margin.gradient.dot(&shapes[point]);
                let change =
                    barrier / margin.value - *multiplier - *multiplier / margin.value * opening;
                let central = barrier / wall.value(next);
                *multiplier = (*multiplier + length * change)
                    .max(0.01 * *multiplier)
                    .clamp(central * 1e-6, central * 1e6);
            }
        }
    }
}

#[cfg(test)]
mod tests;
