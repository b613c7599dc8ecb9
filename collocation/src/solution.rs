//! What direct collocation returns: the quarter gait, and what it was checked against.

use nalgebra::{Matrix2xX, Vector2};
use swimmer_files::AnyGait;

use super::error::CollocationError;
use super::mesh::Mesh;

/// Samples of a quarter as a gait.
const SAMPLES: usize = 256;

/// A collocated optimum.
#[derive(Debug, Clone)]
pub struct CollocationSolution {
    /// Lighthill's efficiency ξ.
    pub efficiency: f64,
    /// ξ of the whole quarter integrated again with the interpolated control.
    pub efficiency_again: f64,
    /// Largest overstepping of a bound between nodes, in rad, or over L for the distance of links.
    pub overstepped: f64,
    pub(crate) phi: Matrix2xX<f64>,
    pub(crate) mesh: Mesh,
}

impl CollocationSolution {
    /// Joint angles at a time 0 … 1, on the solution's own polynomials.
    pub fn phi(&self, t: f64) -> Vector2<f64> {
        self.mesh.shape(&self.phi, t)
    }

    /// The whole cycle, by the paper's two symmetries, smooth throughout: of a solution that keeps off the corners of its bounds.
    ///
    /// # Errors
    /// [`CollocationError::Guess`]: its samples make no closed curve; never for a solution that this crate made.
    pub fn gait(&self) -> Result<AnyGait, CollocationError> {
        let quarters = |i: usize| i as f64 / SAMPLES as f64;
        let phi = |i: usize| {
            let (half, step) = (i / (2 * SAMPLES), i % (2 * SAMPLES));
            let phi = self.phi(quarters(step.min(2 * SAMPLES - step)));
            // On φ₁ = −φ₂ the way back is the way there, mirrored; the second half is the first turned by half a turn.
            let phi = if step > SAMPLES { -phi.yx() } else { phi };
            if half > 0 { -phi } else { phi }
        };
        let phi: Vec<_> = (0..4 * SAMPLES).map(phi).collect();
        let u: Vec<_> = (0..4 * SAMPLES).map(|i| 0.25 * quarters(i)).collect();
        AnyGait::from_samples(&u, &phi, &[]).map_err(|_| CollocationError::Guess {
            problem: "its samples make no closed curve",
        })
    }
}
