//! Extremals of Lighthill's efficiency as curves in the plane of joint angles: flow, arcs, and shooting over arcs.
//!
//! | module | what lives there |
//! |---|---|
//! | `equations` | the reduced flow, free of position and heading, with its linearisation |
//! | `flow` | flow maps with exact Jacobians |
//! | `wall` | bounds of the joint angles as curves to run along |
//! | `shooting` | multiple shooting over arcs: a quarter, or a closed curve without symmetry |
//! | `guess` | states and momenta from any closed curve |
//! | `structure` | which arcs a curve is made of, and what a solution says of that |

pub(crate) mod continuation;
mod equations;
mod evidence;
mod flow;
pub(crate) mod gait;
mod guess;
mod sampled;
mod second_variation;
mod shooting;
mod structure;
pub(crate) mod wall;

use swimmer_model::{Gait, Model};

use equations::shape;
use guess::Swum;
use shooting::{Class, Solved, Unsolved, solve};
use structure::{next_structure, of_curve};
pub(crate) use wall::Walls;

/// How often a structure may be changed.
const MOST_STRUCTURES: usize = 12;

/// An extremal: arcs that satisfy every first-order condition.
#[derive(Debug, Clone)]
pub(crate) struct Extremal {
    pub(crate) solved: Solved,
    pub(crate) class: Class,
    /// How many structures were tried.
    pub(crate) structures: usize,
}

/// Why a curve could not be polished.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub(crate) enum Unpolished {
    /// The curve goes nowhere, or cannot be swum.
    #[error("the curve to polish goes nowhere")]
    NoGuess,
    /// The shooting did not converge.
    #[error("shooting over {arcs} arcs did not converge: {reason}")]
    Shooting { arcs: usize, reason: Unsolved },
    /// The finished arcs cannot be followed again.
    #[error("the arcs found cannot be followed again")]
    Trace,
    /// Structure after structure.
    #[error("{structures} arc structures were tried and each asked for another one")]
    Structure { structures: usize },
}

/// Polishes a closed curve (or, for a gait with the paper's two symmetries that starts on φ₁ = φ₂, its quarter) to an
/// extremal of the efficiency.
pub(crate) fn polish<G: Gait<f64> + ?Sized>(
    model: &Model<f64>,
    walls: &Walls,
    gait: &G,
    quarter: bool,
) -> Result<Extremal, Unpolished> {
    let inside = |phi: &nalgebra::Vector2<f64>| {
        walls
            .nearest(phi)
            .is_none_or(|(_, depth)| depth < -structure::NEAR)
    };
    let swum = Swum::new(model, gait, inside).ok_or(Unpolished::NoGuess)?;
    let (chain, class) = of_curve(&swum, walls, quarter);
    polish_chain(model, walls, class, chain)
}

/// Solves a chain, structure after structure.
pub(crate) fn polish_chain(
    model: &Model<f64>,
    walls: &Walls,
    class: Class,
    guess: shooting::Chain,
) -> Result<Extremal, Unpolished> {
    let (mut chain, mut class) = (guess, class);
    for structures in 1..=MOST_STRUCTURES {
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
                return Ok(Extremal {
                    solved,
                    class,
                    structures,
                });
            }
            Some(next) => (chain, class) = next,
        }
    }
    Err(Unpolished::Structure {
        structures: MOST_STRUCTURES,
    })
}

impl Extremal {
    /// Lighthill's efficiency ξ = `c_t/|p|²` of a swimmer with L = 1.
    pub(crate) fn efficiency(&self, model: &Model<f64>) -> f64 {
        let first = self.solved.chain.states.first();
        first.map_or(f64::NAN, |z| {
            model.side_drag() / (z[3] * z[3] + z[4] * z[4])
        })
    }

    /// The shapes of the full cycle; none where an arc cannot be followed.
    pub(crate) fn curve(
        &self,
        model: &Model<f64>,
        samples: usize,
    ) -> Option<Vec<nalgebra::Vector2<f64>>> {
        let parts = if self.class == Class::Quarter { 4 } else { 1 };
        let sampled = sampled::Sampled::new(model, &self.solved.chain, samples / parts)?;
        Some(sampled.cycle(self.class).phi)
    }

    /// λ₃ = p·x̂ in the frame of the first shape: the sign of X for a quarter.
    pub(crate) fn heading(&self) -> f64 {
        self.solved.chain.states.first().map_or(f64::NAN, |z| z[3])
    }

    /// The first shape.
    pub(crate) fn start(&self) -> nalgebra::Vector2<f64> {
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
