//! Closed curves of greatest displacement of any symmetry: loops of singular arcs and bound arcs without net rotation.
//!
//! With p the momentum dual to the displacement and c the multiplier of rotation, the free arcs lie on the zero of the
//! height h = μ·F (μ the body momentum, F the curvature of the connection), and a bound is active while h > 0 on its inner side. A
//! start (a point on a bound, or on a line across the curve) and the direction of p determine the whole loop, because c follows from
//! h = 0. Two conditions remain: the loop must return to its start, with the same heading. Then p is parallel to the displacement.

mod flow;
mod shooting;
mod trace;

pub(crate) use flow::{ClosedOrbit, Launch, ReturnCondition};
pub(crate) use shooting::{Guess, Section, close};
pub(crate) use trace::{traced, traced_from};
