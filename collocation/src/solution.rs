//! Result of direct collocation: the quarter gait with the figures of its check.

use nalgebra::{Matrix2xX, Vector2};
use swimmer_files::AnyGait;

use super::error::CollocationError;
use super::mesh::Mesh;

/// Number of samples per quarter when the solution is converted to a gait.
const SAMPLES: usize = 256;

/// A collocated optimum.
#[derive(Debug, Clone)]
pub struct CollocationSolution {
    /// Lighthill efficiency ξ.
    pub efficiency: f64,
    /// ξ after re-integration of the quarter with the interpolated control.
    pub efficiency_again: f64,
    /// Largest violation of a bound between nodes \[rad; over L for the clearance of the links\].
    pub overstepped: f64,
    pub(crate) phi: Matrix2xX<f64>,
    pub(crate) mesh: Mesh,
}

impl CollocationSolution {
    /// Joint angles at time `t` in 0 … 1, on the polynomials of the solution.
    pub fn phi(&self, t: f64) -> Vector2<f64> {
        self.mesh.shape(&self.phi, t)
    }

    /// Returns the whole cycle by the paper's two symmetries. It is smooth if the solution does not touch a corner of the bounds.
    ///
    /// # Errors
    /// [`CollocationError::Guess`] if the samples are not a closed curve, which does not occur for a solution of [`crate::solve`].
    pub fn gait(&self) -> Result<AnyGait, CollocationError> {
        let quarters = |i: usize| i as f64 / SAMPLES as f64;
        let phi = |i: usize| {
            let (half, step) = (i / (2 * SAMPLES), i % (2 * SAMPLES));
            let phi = self.phi(quarters(step.min(2 * SAMPLES - step)));
            // The second quarter is the first, mirrored at φ₁ = −φ₂; the second half is the first half rotated by π.
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
