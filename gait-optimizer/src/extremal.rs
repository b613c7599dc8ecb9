//! Extremals of Lighthill's efficiency as curves in the plane of joint angles, by multiple shooting over free arcs and bound arcs.
//!
//! | module | contents |
//! |---|---|
//! | `equations` | the reduced flow, free of position and heading, with its linearisation |
//! | `flow` | flow maps with exact Jacobians |
//! | `wall` | bounds of the joint angles as curves that an arc can follow |
//! | `shooting` | multiple shooting over arcs: a quarter, or a closed curve without symmetry |
//! | `guess` | initial states and momenta from any closed curve |
//! | `structure` | active set: the arcs of a curve, detected and updated |
//! | `continuation` | homotopy in the bounds |
//! | `sampled` | an extremal as a sampled cycle |
//! | `gait` | the gait with its certificate |
//!
//! The entry point is [`polish`], which takes bounds and any closed curve near an optimum.

pub(crate) mod continuation;
mod equations;
mod flow;
pub(crate) mod gait;
pub(crate) mod guess;
mod sampled;
pub(crate) mod shooting;
mod structure;
pub(crate) mod wall;

use nalgebra::Vector2;
use swimmer_model::{Gait, Model};

use crate::certify::ascents_of_efficiency;
use crate::cycle::Cycle;
use crate::region::Region;
use equations::shape;
use guess::Trajectory;
use shooting::{Chain, Class, Unsolved, solve};
use structure::{next_structure, of_curve};
pub(crate) use wall::walls;

/// Largest number of changes of the active set.
const MOST_STRUCTURES: usize = 12;
/// Number of samples of a cycle for its second variation.
const ASCENTS_OF: usize = 256;

/// Chain of arcs that satisfies every first-order condition.
#[derive(Debug, Clone)]
pub(crate) struct Extremal {
    pub(crate) chain: Chain,
    /// Largest residual: angles \[rad\], momenta over |p|, scale condition over the length.
    pub(crate) residual: f64,
    /// Sign of the Jacobian's determinant, which changes at a fold of the branch.
    pub(crate) orientation: f64,
}

/// Failure to polish a curve.
#[derive(Debug, Clone, thiserror::Error)]
pub(crate) enum Unpolished {
    #[error("the curve to polish goes nowhere")]
    NoGuess,
    #[error("shooting over {arcs} arcs did not converge: {reason}")]
    Shooting { arcs: usize, reason: Unsolved },
    #[error("the arcs found cannot be followed again")]
    Trace,
    #[error("{MOST_STRUCTURES} arc structures were tried and each led to another one")]
    Structure,
}

/// Polishes a closed curve to an extremal that satisfies Pontryagin's principle for Lighthill's efficiency to rounding. For a gait
/// with the paper's two symmetries that starts on φ₁ = φ₂, only the quarter is solved. The active set is detected on the curve and
/// updated after each solution until it is consistent. Curves with several turns or self-crossings are accepted. The caller
/// compares the extremal with the curve, since it may be another gait or a saddle.
pub(crate) fn polish<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    walls: &Region,
    gait: &G,
    quarter: bool,
) -> Result<Extremal, Unpolished> {
    let inside = |phi: &Vector2<f64>| {
        walls
            .nearest(phi)
            .is_none_or(|(_, depth)| depth < -structure::NEAR)
    };
    let swum = Trajectory::new(model, gait, inside).ok_or(Unpolished::NoGuess)?;
    polish_chain(model, walls, of_curve(&swum, walls, quarter))
}

/// Solves a chain and updates its active set until it is consistent.
pub(crate) fn polish_chain(
    model: &Model<f64>,
    walls: &Region,
    guess: Chain,
) -> Result<Extremal, Unpolished> {
    let mut chain = guess;
    for _ in 0..MOST_STRUCTURES {
        let arcs = chain.arcs.len();
        let extremal = solve(model, chain.clone()).or_else(|reason| {
            let shorter = structure::simpler(model, &chain);
            let solved = shorter.and_then(|shorter| solve(model, shorter).ok());
            solved.ok_or(Unpolished::Shooting { arcs, reason })
        })?;
        match next_structure(model, walls, &extremal.chain) {
            None => return Ok(extremal),
            Some(next) => chain = next,
        }
    }
    Err(Unpolished::Structure)
}

impl Extremal {
    /// Number of independent directions in which the efficiency grows to second order; for a quarter, those that keep its symmetries.
    /// Returns `None` if an arc cannot be integrated.
    pub(crate) fn ascents(&self, model: &Model<f64>) -> Option<usize> {
        let cycle = self.cycle(model, ASCENTS_OF)?;
        Some(ascents_of_efficiency(model, &cycle, self.is_quarter()))
    }

    /// Returns `true` for a quarter of a gait with the paper's two symmetries.
    pub(crate) fn is_quarter(&self) -> bool {
        self.chain.class == Class::Quarter
    }

    /// Lighthill's efficiency ξ = `c_t/|p|²` of a swimmer with L = 1.
    pub(crate) fn efficiency(&self, model: &Model<f64>) -> f64 {
        let first = self.chain.states.first();
        first.map_or(f64::NAN, |z| {
            model.side_drag() / (z[3] * z[3] + z[4] * z[4])
        })
    }

    /// Samples the full cycle with about `samples` samples. Returns `None` if an arc cannot be integrated.
    pub(crate) fn cycle(&self, model: &Model<f64>, samples: usize) -> Option<Cycle> {
        let parts = usize::from(self.chain.class.parts());
        sampled::sampled(model, &self.chain, samples / parts)
    }

    /// Net displacement of the cycle over L in the frame of its first shape: p S/|p|².
    pub(crate) fn displacement(&self) -> Vector2<f64> {
        let length = f64::from(self.chain.class.parts()) * self.chain.length();
        let p = self.chain.states.first().map(|z| Vector2::new(z[3], z[4]));
        p.map_or(Vector2::repeat(f64::NAN), |p| {
            p * (length / p.norm_squared())
        })
    }

    /// λ₃ = p·x̂ in the frame of the first shape; its sign is that of X for a quarter.
    pub(crate) fn heading(&self) -> f64 {
        self.chain.states.first().map_or(f64::NAN, |z| z[3])
    }

    /// First shape.
    pub(crate) fn start(&self) -> Vector2<f64> {
        let first = self.chain.states.first();
        first.map(shape).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
