//! Unknowns of the shooting: arcs in order, with the state at the start of every piece.

use nalgebra::Vector2;

use crate::extremal::equations::{Motion, State};

/// Start of an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Entry {
    /// Smooth; tangent to a bound.
    Smooth,
    /// Kink at this corner of the forbidden shapes.
    Corner(Vector2<f64>),
}

/// Arc of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Stretch {
    pub(crate) motion: Motion,
    pub(crate) entry: Entry,
    /// Number of pieces.
    pub(crate) pieces: usize,
    /// Power length.
    pub(crate) length: f64,
}

/// Chain of arcs with the state at the start of every piece.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Chain {
    pub(crate) class: Class,
    pub(crate) arcs: Vec<Stretch>,
    pub(crate) states: Vec<State>,
}

/// Boundary conditions of a chain.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Class {
    /// Quarter of a doubly symmetric gait: perpendicular to φ₁ = φ₂ with θ = 0, perpendicular to φ₁ = −φ₂ with λ₄ = 0.
    Quarter,
    /// Closed curve whose direction turns by `turn` \[rad\].
    Closed {
        turn: f64,
        /// Line on which the first shape is held, as a point and its normal; for curves without a bound arc.
        line: Option<(Vector2<f64>, Vector2<f64>)>,
    },
}

impl Class {
    /// Number of such chains per cycle.
    pub(crate) fn parts(self) -> u8 {
        match self {
            Self::Quarter => 4,
            Self::Closed { .. } => 1,
        }
    }
}

impl Chain {
    /// Power length of the whole chain.
    pub(crate) fn length(&self) -> f64 {
        self.arcs.iter().map(|arc| arc.length).sum()
    }

    /// Iterates over all pieces: index of the arc, arc, and state at the start.
    pub(crate) fn pieces(&self) -> impl Iterator<Item = (usize, &Stretch, &State)> {
        self.arcs
            .iter()
            .enumerate()
            .flat_map(|(index, arc)| std::iter::repeat_n((index, arc), arc.pieces))
            .zip(&self.states)
            .map(|((index, arc), state)| (index, arc, state))
    }

    pub(super) fn is_whole(&self) -> bool {
        !self.states.is_empty()
            && self.states.len() == self.arcs.iter().map(|arc| arc.pieces).sum::<usize>()
            && self.arcs.iter().all(|arc| arc.pieces > 0)
    }

    pub(super) fn moved(&self, step: &[f64], factor: f64) -> Self {
        let mut chain = self.clone();
        let mut changes = step.iter().map(|change| factor * change);
        for state in &mut chain.states {
            for value in state.iter_mut() {
                *value += changes.next().unwrap_or(0.0);
            }
        }
        for arc in &mut chain.arcs {
            arc.length += changes.next().unwrap_or(0.0);
        }
        chain
    }
}
