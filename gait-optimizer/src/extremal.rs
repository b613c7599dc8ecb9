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
use shooting::{Chain, Class, Solved, Unsolved, solve};
use structure::{next_structure, of_curve};
pub(crate) use wall::walls;

/// How often a structure may be changed.
const MOST_STRUCTURES: usize = 12;
/// Samples of a cycle that is asked for its ascents.
const ASCENTS_OF: usize = 256;

/// An extremal: arcs that satisfy every first-order condition.
#[derive(Debug, Clone)]
pub(crate) struct Extremal {
    pub(crate) solved: Solved,
    pub(crate) class: Class,
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
    let (chain, class) = of_curve(&swum, walls, quarter);
    polish_chain(model, walls, class, chain)
}

/// Solves a chain, structure after structure.
pub(crate) fn polish_chain(
    model: &Model<f64>,
    walls: &Region,
    class: Class,
    guess: Chain,
) -> Result<Extremal, Unpolished> {
    let (mut chain, mut class) = (guess, class);
    for _ in 0..MOST_STRUCTURES {
        let arcs = chain.arcs.len();
        let solved = match solve(model, class, chain.clone()) {
            Ok(solved) => solved,
            Err(reason) => {
                let (shorter, same) = structure::simpler(model, class, &chain)
                    .ok_or(Unpolished::Shooting { arcs, reason })?;
                class = same;
                solve(model, class, shorter).map_err(|_| Unpolished::Shooting { arcs, reason })?
            }
        };
        match next_structure(model, walls, class, &solved.chain) {
            None => {
                return Ok(Extremal { solved, class });
            }
            Some(next) => (chain, class) = next,
        }
    }
    Err(Unpolished::Structure)
}

/// The free quarter near a guess, without a look at bounds; none where Newton's method finds none.
pub(crate) fn free_quarter(model: &Model<f64>, guess: Chain) -> Option<Extremal> {
    let class = Class::Quarter;
    let solved = solve(model, class, guess).ok()?;
    Some(Extremal { solved, class })
}

impl Extremal {
    /// Along how many directions the efficiency grows to second order, of a quarter those that keep its symmetries; none where an arc
    /// cannot be followed.
    pub(crate) fn ascents(&self, model: &Model<f64>) -> Option<usize> {
        let cycle = self.cycle(model, ASCENTS_OF)?;
        let symmetric = self.class == Class::Quarter;
        Some(ascents_of_efficiency(model, &cycle, symmetric))
    }

    /// Lighthill's efficiency ξ = `c_t/|p|²` of a swimmer with L = 1.
    pub(crate) fn efficiency(&self, model: &Model<f64>) -> f64 {
        let first = self.solved.chain.states.first();
        first.map_or(f64::NAN, |z| {
            model.side_drag() / (z[3] * z[3] + z[4] * z[4])
        })
    }

    /// The full cycle in about so many samples; none where an arc cannot be followed.
    pub(crate) fn cycle(&self, model: &Model<f64>, samples: usize) -> Option<Cycle> {
        let parts = if self.class == Class::Quarter { 4 } else { 1 };
        sampled::sampled(model, self.class, &self.solved.chain, samples / parts)
    }

    /// Net displacement of the cycle over L in the frame of its first shape: p S/|p|².
    pub(crate) fn displacement(&self) -> Vector2<f64> {
        let Chain { arcs, states } = &self.solved.chain;
        let parts = if self.class == Class::Quarter {
            4.0
        } else {
            1.0
        };
        let length: f64 = arcs.iter().map(|arc| arc.length).sum();
        let p = states.first().map(|z| Vector2::new(z[3], z[4]));
        p.map_or(Vector2::repeat(f64::NAN), |p| {
            p * (parts * length / p.norm_squared())
        })
    }

    /// λ₃ = p·x̂ in the frame of the first shape: the sign of X for a quarter.
    pub(crate) fn heading(&self) -> f64 {
        self.solved.chain.states.first().map_or(f64::NAN, |z| z[3])
    }

    /// The first shape.
    pub(crate) fn start(&self) -> Vector2<f64> {
        self.solved
            .chain
            .states
            .first()
            .map(shape)
            .unwrap_or_default()
    }
}

#[cfg(test)]
mod tests;
