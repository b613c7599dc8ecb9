//! Closed curves of most displacement, of any symmetry: loops of singular arcs and arcs along bounds that come back to where
//! they began with no net rotation.
//!
//! With p the momentum dual to the displacement and c the multiplier of rotation, the free arcs lie on the zero of the
//! height h = μ·F (μ the body momentum, F the curvature of the connection) and a bound is followed while h > 0 on its
//! inside. A start (a place on a bound, or on a line across the curve) and the direction of p fix the whole loop, because c
//! follows from h = 0; two conditions remain: the place must be met again, and the heading. Then p is parallel to the
//! displacement by itself.

mod flow;
mod shooting;
mod trace;

pub(crate) use flow::{ClosedOrbit, Launch, ReturnCondition};
pub(crate) use shooting::{Guess, Section, close};
pub(crate) use trace::{traced, traced_from};
