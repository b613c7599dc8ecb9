//! Gaits of most Lighthill efficiency by direct collocation (paper, section V, where GPOPS-II does this): the second method, which
//! shares with the optimiser only A and W and where the bounds are. [`efficiency()`] has a gait polished and certified;
//! [`solve`] is collocation alone, with bounds as well.
//!
//! The problem on a quarter gait, t = 0 … 1: states z = (φ₁, φ₂, x, θ, E), control u = Φ̇, from φ₁ = φ₂ to φ₁ = −φ₂, make
//! `x_f²/E_f` greatest, |φᵢ| ≤ `φ_max`. It is discretised by Legendre–Gauss–Radau collocation on an even mesh (`radau`, `mesh`),
//! fine enough that the states, integrated again with the interpolated control, agree; else there is no answer. A coarse mesh
//! comes first: free gaits are so smooth that it mostly does, and with bounds the fine one starts where it ends.
//!
//! # Why a solver of our own
//!
//! As φ̇ = u, θ, x and E can be solved for in one sweep (`path`), every iterate obeys the state equations and the merit function
//! is the objective with its barrier (`newton`), so neither filter nor restoration is needed, and Newton's equation is small
//! enough for conjugate gradients. Of the published crates `clarabel` is for convex problems only, `argmin` has no constraints,
//! `ipopt` binds to C, `interiors` builds its matrices anew at every call; `ripopt` and `pounce-rs`, ports of Ipopt in
//! Rust, are under the EPL and bring a second linear algebra.

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
