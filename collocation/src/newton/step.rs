//! From the solutions of the blocks to the Newton step: the part of the Hessian that couples all shapes has rank two.

use nalgebra::Vector2;

use super::Newton;
use crate::elimination::Solutions;

/// A Newton step.
#[derive(Debug)]
pub(super) struct Step {
    /// Change of the shape at every point.
    pub(super) shapes: Vec<Vector2<f64>>,
    /// Derivative of the barrier function along it; negative.
    pub(super) slope: f64,
    /// Whether the Hessian was positive definite as it was.
    pub(super) convex: bool,
}

impl Newton<'_> {
    /// Adds the curvature of ln E − 2 ln x itself, 2 a aᵀ − b bᵀ with a = ∇x/x and b = ∇E/E, to the blocks' matrix
    /// (Sherman, Morrison, Woodbury). If that makes it indefinite, as much of −b bᵀ as it can bear.
    pub(super) fn combine(&self, solutions: &Solutions, unshifted: bool) -> Step {
        let Solutions([walls, distance, energy]) = solutions;
        let (of_x, of_energy) = (1.0 / self.path.final_x, 1.0 / self.path.final_energy);
        // Products of −M⁻¹ with the right-hand sides.
        let product = |side: usize, solution: &[Vector2<f64>]| {
            -self.against(side, solution) * [1.0, of_x, of_energy][side]
        };
        let aa = product(1, distance) * of_x;
        let ab = product(1, energy) * of_energy;
        let bb = product(2, energy) * of_energy;
        // −M⁻¹ g, g = walls − 2 a + b.
        let mut shapes: Vec<Vector2<f64>> = walls
            .iter()
            .zip(distance)
            .zip(energy)
            .map(|((w, x), e)| w - x * (2.0 * of_x) + e * of_energy)
            .collect();
        let along_x = -product(1, &shapes);
        let along_energy = -product(2, &shapes);
        // (½ + aa, ab; ab, −1/κ + bb) must keep one negative eigenvalue: κ = 1 if it does, less if not.
        let pivot = 0.5 + aa;
        let rest = bb - ab * ab / pivot;
        let whole = rest < 1.0;
        let corner = bb - if whole { 1.0 } else { 2.0 * rest };
        let det = pivot * corner - ab * ab;
        let (by_a, by_b) = (
            (corner * along_x - ab * along_energy) / det,
            (pivot * along_energy - ab * along_x) / det,
        );
        for ((shape, x), e) in shapes.iter_mut().zip(distance).zip(energy) {
            *shape += x * (by_a * of_x) + e * (by_b * of_energy);
        }
        Step {
            slope: self.slope(&shapes),
            shapes,
            convex: unshifted && whole,
        }
    }

    /// Derivative of the barrier function along a change of the shapes.
    pub(super) fn slope(&self, shapes: &[Vector2<f64>]) -> f64 {
        self.against(0, shapes) - 2.0 / self.path.final_x * self.against(1, shapes)
            + self.against(2, shapes) / self.path.final_energy
    }

    /// A right-hand side times a change of the shapes.
    fn against(&self, side: usize, shapes: &[Vector2<f64>]) -> f64 {
        self.blocks
            .iter()
            .zip(&self.mesh.elements)
            .map(|(block, element)| block.against(side, &shapes[element.points()]))
            .sum()
    }
}
