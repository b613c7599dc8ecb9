//! Errors of the turning search.

use nalgebra::Vector2;

use crate::problem::InvalidProblem;

/// Error of the turning search.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum TurningError {
    /// It makes no sense.
    #[error(transparent)]
    Problem(#[from] InvalidProblem),
    /// The border of the region does not come round.
    #[error(
        "the border of the shapes that these bounds allow could not be followed round the straight shape; give a tighter upper bound"
    )]
    Border,
    /// A region of the curvature could not be gone round.
    #[error(
        "cannot go round a region of the curvature: near ({}, {}) rad {what}; change the bound a little",
        near[0],
        near[1]
    )]
    Lost {
        /// Joint angles \[rad\].
        near: [f64; 2],
        /// Obstacle.
        what: &'static str,
    },
    /// The curvature is nowhere positive.
    #[error("the curvature of the heading is nowhere positive within these bounds: no gait turns")]
    NoRegion,
    /// A gait was found, but it fails its certificate.
    #[error("the best loop found (it turns {rotation} rad) is no optimum: it fails {failed}")]
    NotCertified {
        /// Its net rotation \[rad\].
        rotation: f64,
        /// The checks that it fails, with their values.
        failed: String,
    },
}

impl TurningError {
    /// A trace that could not continue, with the place and the reason.
    pub(super) fn lost(near: Vector2<f64>, what: &'static str) -> Self {
        Self::Lost {
            near: near.into(),
            what,
        }
    }
}
