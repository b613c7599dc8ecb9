//! Extremals of Lighthill's efficiency as curves in the plane of joint angles: flow, arcs, and shooting over arcs.
//!
//! | module | what lives there |
//! |---|---|
//! | `equations` | the reduced flow, free of position and heading, with its linearisation |
//! | `flow` | flow maps with exact Jacobians |
//! | `wall` | bounds of the joint angles as curves to run along |
//! | `shooting` | multiple shooting over arcs: a quarter, or a closed curve without symmetry |
//! | `elimination` | the linear systems of the shooting, without their zeros |
//! | `guess` | states and momenta from any closed curve |
//! | `structure` | which arcs a curve is made of, and what a solution says of that |
//! | `continuation` | a gait followed as its bounds tighten |
//! | `sampled` | an extremal as a sampled cycle |
//! | `evidence` | the arcs followed again in the plain form of the maximum principle |
//! | `second_variation` | along how many directions the efficiency grows to second order |
//! | `gait` | the gait with its certificate |
//!
//! [`polish`] is the way in: any closed curve near an optimum, and bounds.

pub(crate) mod continuation;
mod elimination;
mod equations;
mod evidence;
mod flow;
pub(crate) mod gait;
pub(crate) mod guess;
mod sampled;
mod second_variation;
pub(crate) mod shooting;
mod structure;
pub(crate) mod wall;

use std::sync::OnceLock;

use swimmer_model::{Gait, Model};

use equations::shape;
use guess::Trajectory;
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
    /// Looked at more than once, and dear.
    ascents: OnceLock<Option<usize>>,
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
    walls: &Walls,
    gait: &G,
    quarter: bool,
) -> Result<Extremal, Unpolished> {
    let inside = |phi: &nalgebra::Vector2<f64>| {
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
    walls: &Walls,
    class: Class,
    guess: shooting::Chain,
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
                return Ok(Extremal::new(solved, class));
            }
            Some(next) => (chain, class) = next,
        }
    }
    Err(Unpolished::Structure)
}

/// The free quarter near a guess, without a look at bounds; none where Newton's method finds none.
pub(crate) fn free_quarter(model: &Model<f64>, guess: shooting::Chain) -> Option<Extremal> {
    let class = Class::Quarter;
    let solved = solve(model, class, guess).ok()?;
    Some(Extremal::new(solved, class))
}

impl Extremal {
    fn new(solved: Solved, class: Class) -> Self {
        Self {
            solved,
            class,
            ascents: OnceLock::new(),
        }
    }

    /// Along how many directions the efficiency grows to second order; none where that cannot be told.
    pub(crate) fn ascents(&self, model: &Model<f64>) -> Option<usize> {
        let count = || second_variation::ascent_directions(model, self.class, &self.solved.chain);
        *self.ascents.get_or_init(count)
    }

    /// The same of a quarter's cycle among closed curves of any symmetry.
    pub(crate) fn ascents_without_symmetry(&self, model: &Model<f64>) -> Option<usize> {
        second_variation::ascents_without_symmetry(model, &self.solved.chain)
    }

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
        let cycle = sampled::sampled(model, self.class, &self.solved.chain, samples / parts);
        Some(cycle?.phi)
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
