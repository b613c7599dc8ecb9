//! Direct collocation for gaits of greatest Lighthill efficiency (paper, section V, which uses GPOPS-II). It is the second method
//! next to the optimiser's shooting and shares with it only A, W and the bounds. [`efficiency()`] returns a polished and
//! certified gait; [`solve`] is the collocation alone, with or without bounds.
//!
//! The optimal control problem on a quarter gait, t = 0 … 1: states z = (φ₁, φ₂, x, θ, E), control u = Φ̇, from φ₁ = φ₂ to
//! φ₁ = −φ₂, maximise `x_f²/E_f` subject to |φᵢ| ≤ `φ_max`. Legendre–Gauss–Radau collocation on a uniform mesh discretises it
//! (`radau`, `mesh`). A result is returned only if re-integration of the states with the interpolated control agrees. A coarse
//! mesh is solved first. It usually suffices for gaits without bounds, which are smooth; with bounds it is the initial guess of
//! the fine mesh.
//!
//! # Why a solver of our own
//!
//! Since φ̇ = u, the states θ, x and E follow from the shapes in one sweep (`path`). Every iterate satisfies the state equations,
//! the merit function is the objective with its barrier (`newton`), and neither a filter nor a restoration phase is needed. The
//! Newton system is small enough for conjugate gradients. Of the published crates, `clarabel` is limited to convex problems,
//! `argmin` has no constraints, `ipopt` binds to C, and `interiors` reallocates its matrices in every call; `ripopt` and
//! `pounce-rs`, ports of Ipopt to Rust, are under the EPL and depend on a second linear algebra library.

mod efficiency;
mod error;
mod guess;
mod mesh;
mod newton;
mod path;
mod problem;
mod radau;
mod solution;
mod solve;
#[cfg(test)]
mod tests;

pub use efficiency::efficiency;
pub use error::CollocationError;
pub use problem::CollocationProblem;
pub use solution::CollocationSolution;
pub use solve::solve;
