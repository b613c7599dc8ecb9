//! Errors of direct collocation.

use gait_optimizer::{Branch, EfficiencyError, InvalidProblem};
use thiserror::Error;

/// Failure of a direct collocation.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CollocationError {
    /// A parameter is out of range.
    #[error("direct collocation: {name} is {value}; {problem}")]
    Problem {
        /// Name of the parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// Requirement that the value violates.
        problem: &'static str,
    },
    /// The initial guess is not a quarter of a symmetric gait.
    #[error(
        "direct collocation cannot start from this gait: {problem}; give one whose first quarter runs from φ₁ = φ₂ > 0 to \
         φ₁ = −φ₂"
    )]
    Guess {
        /// Property that the guess lacks.
        problem: &'static str,
    },
    /// The initial guess has the wrong sign of x, so that the objective ln(±x) is undefined.
    #[error(
        "the guess for direct collocation swims {x:.3e} a quarter, while x shall have the sign of {wanted:+}; start from a gait \
         that goes the wanted way"
    )]
    WrongWay {
        /// Displacement x of the guess's quarter, in the model's unit of length.
        x: f64,
        /// Required sign, +1 or −1.
        wanted: f64,
    },
    /// The iteration did not converge.
    #[error(
        "direct collocation stopped after {iterations} iterations at ξ = {efficiency:.3e} without an optimum; start nearer to \
         one, such as from the optimal Fourier gait"
    )]
    Stalled {
        /// Number of iterations on the last mesh.
        iterations: usize,
        /// Lighthill efficiency of the last iterate.
        efficiency: f64,
    },
    /// No circle has a locally greatest efficiency on the branch.
    #[error(
        "direct collocation has no start: no circle is a locally best gait with the {branch} gait's sign of X"
    )]
    NoStart {
        /// Requested branch.
        branch: Branch,
    },
    /// The problem is invalid, the polish failed, or the polished gait is not on the requested branch.
    #[error(transparent)]
    Polish(#[from] EfficiencyError),
    /// A spurious optimum of the discretisation: re-integration of its control gives another efficiency.
    #[error(
        "direct collocation found ξ = {efficiency:.3e} on {points} points, but its control makes {again:.3e} when integrated \
         again: a spurious optimum of a coarse mesh; start nearer to the wanted gait or take more elements"
    )]
    Spurious {
        /// Lighthill efficiency of the collocation.
        efficiency: f64,
        /// Lighthill efficiency after re-integration.
        again: f64,
        /// Number of mesh points.
        points: usize,
    },
}

impl From<InvalidProblem> for CollocationError {
    fn from(error: InvalidProblem) -> Self {
        Self::Polish(error.into())
    }
}
