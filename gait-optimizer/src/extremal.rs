//! Extremals of Lighthill's efficiency as curves in the plane of joint angles: flow, arcs, and shooting over arcs.
//!
//! | module | what lives there |
//! |---|---|
//! | `equations` | the reduced flow, free of position and heading, with its linearisation |
//! | `flow` | flow maps with exact Jacobians |
//! | `wall` | bounds of the joint angles, as curves to run along |
//! | `shooting` | multiple shooting over arcs: a quarter, or a closed curve without symmetry |
//! | `guess` | states and momenta from any closed curve |
//! | `structure` | which arcs a curve is made of, and what a solution says of that |
//! | `continuation` | a gait followed as its bounds tighten |
//! | `sampled` | an extremal as a sampled cycle |
//! | `gait` | the gait with its certificate |
//!
//! [`polish`] is the way in: any closed curve near an optimum, and bounds.

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

/// How often a structure may be changed.
const MOST_STRUCTURES: usize = 12;
/// Samples of a cycle that is asked for its ascents.
const ASCENTS_OF: usize = 256;

/// An extremal: arcs that satisfy every first-order condition.
#[derive(Debug, Clone)]
pub(crate) struct Extremal {
    pub(crate) chain: Chain,
    /// Largest residual: angles in radians, momenta over |p|, the scale condition over the length.
    pub(crate) residual: f64,
    /// Sign of the Jacobian's determinant; it changes at a fold of the family of solutions.
    pub(crate) orientation: f64,
}

/// Why a curve could not be polished.
#[derive(Debug, Clone, thiserror::Error)]
pub(crate) enum Unpolished {
    #[error("the curve to polish goes nowhere")]
    NoGuess,
    #[error("shooting over {arcs} arcs did not converge: {reason}")]
    Shooting { arcs: usize, reason: Unsolved },
    #[error("the arcs found cannot be followed again")]
    Trace,
    #[error("{MOST_STRUCTURES} arc structures were tried and each asked for another one")]
    Structure,
}

/// Polishes a closed curve (or, for a gait with the paper's two symmetries that starts on φ₁ = φ₂, its quarter) to an extremal that
/// satisfies the maximum principle for Lighthill's efficiency to rounding: the arcs are read off the curve, shot, and changed until
/// they are right. Curves that turn more than once or cross themselves are gaits too; whether the one found is still the one that was
/// meant is for the caller to compare. It may be a saddle.
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

/// Solves a chain, structure after structure.
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
    /// Along how many directions the efficiency grows to second order, of a quarter those that keep its symmetries; none where an arc
    /// cannot be followed.
    pub(crate) fn ascents(&self, model: &Model<f64>) -> Option<usize> {
        let cycle = self.cycle(model, ASCENTS_OF)?;
        Some(ascents_of_efficiency(model, &cycle, self.is_quarter()))
    }

    /// Whether it is a quarter of a gait with the paper's two symmetries.
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

    /// The full cycle in about so many samples; none where an arc cannot be followed.
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

    /// λ₃ = p·x̂ in the frame of the first shape: the sign of X for a quarter.
    pub(crate) fn heading(&self) -> f64 {
        self.chain.states.first().map_or(f64::NAN, |z| z[3])
    }

    /// The first shape.
    pub(crate) fn start(&self) -> Vector2<f64> {
        let first = self.chain.states.first();
        first.map(shape).unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
