//! Displacement and effort of any closed curve of joint angles, with their derivatives by the coefficients of the curve.
//!
//! A curve is a sum of [`Basis`] functions, so closed curves and quarters of symmetric curves share the code. The cycle is divided
//! into panels with a three-stage Gauss rule each. The heading inside a panel is that of Gauss–Legendre collocation on the same
//! nodes, whose end values are of order 6. [`Functional`] returns displacement, rotation, energy and power length with the exact
//! derivatives of these discrete sums.

mod basis;
mod functional;
mod hessian;

pub(crate) use basis::Basis;
pub(crate) use functional::{Functional, Values, Workspace, column};
pub(crate) use hessian::Weights;

#[cfg(test)]
mod tests;
