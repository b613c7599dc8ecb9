//! Why there is no collocated gait.

use gait_optimizer::{Branch, EfficiencyError, InvalidProblem};
use thiserror::Error;

/// Why a collocation was given up.
#[derive(Debug, Clone, PartialEq, Error)]
pub enum CollocationError {
    /// A parameter is out of range.
    #[error("direct collocation: {name} is {value}; {problem}")]
    Problem {
        /// Which parameter.
        name: &'static str,
        /// Its value.
        value: f64,
        /// What it must be.
        problem: &'static str,
    },
    /// The guess is no quarter gait.
    #[error(
        "direct collocation cannot start from this gait: {problem}; give one whose first quarter runs from φ₁ = φ₂ > 0 to \
         φ₁ = −φ₂"
    )]
    Guess {
        /// What is wrong with it.
        problem: &'static str,
    },
    /// The guess swims to the other side, where ln x has no value.
    #[error(
        "the guess for direct collocation swims {x:.3e} a quarter, while x shall have the sign of {wanted:+}; start from a gait \
         that goes the wanted way"
    )]
    WrongWay {
        /// Its x.
        x: f64,
        /// The wanted sign.
        wanted: f64,
    },
    /// The iteration came to no optimum.
    #[error(
        "direct collocation stopped after {iterations} iterations at ξ = {efficiency:.3e} without an optimum; start nearer to \
         one, such as from the optimal Fourier gait"
    )]
    Stalled {
        /// Iterations done on the last mesh.
        iterations: usize,
        /// Lighthill's efficiency there.
        efficiency: f64,
    },
    /// No circle of any size is locally best on the branch.
    #[error(
        "direct collocation has no start: no circle is a locally best gait with the {branch} gait's sign of X"
    )]
    NoStart {
        /// Which gait.
        branch: Branch,
    },
    /// The problem makes no sense; or the collocated gait could not be polished, or is not the gait that was asked for.
    #[error(transparent)]
    Polish(#[from] EfficiencyError),
    /// An optimum of the discretisation alone: its control swims otherwise.
    #[error(
        "direct collocation found ξ = {efficiency:.3e} on {points} points, but its control makes {again:.3e} when integrated \
         again: a spurious optimum of a coarse mesh; start nearer to the wanted gait or take more elements"
    )]
    Spurious {
        /// Lighthill's efficiency as collocated.
        efficiency: f64,
        /// The same, integrated again.
        again: f64,
        /// Points of the mesh.
        points: usize,
    },
}

impl From<InvalidProblem> for CollocationError {
    fn from(error: InvalidProblem) -> Self {
        Self::Polish(error.into())
    }
}
