//! Any closed curve of joint angles, symmetric or not: what it brings, what it costs, and how both change with the curve.
//!
//! A curve is a sum of [`Basis`] functions, so that closed curves and the quarters of symmetric ones are one code.
//! The cycle is cut into panels with a three-stage Gauss rule each: the heading inside a panel is that of the collocation
//! method on the same nodes, whose end values are of order 6. [`Functional`] gives displacement, rotation, energy and
//! power length with the exact derivatives of these discrete sums.

mod basis;
mod functional;
mod hessian;

pub(crate) use basis::Basis;
pub(crate) use functional::{Functional, Values, Workspace, column};
pub(crate) use hessian::Weights;

#[cfg(test)]
mod tests;
