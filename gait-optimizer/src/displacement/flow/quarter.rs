//! What following arcs comes to: the arcs of a quarter gait, and how it ended.

use super::is_end_line;
use crate::arcs::Leg;
use crate::momentum::{Motion, State};

/// How a quarter came to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Fate {
    /// On φ₁ = −φ₂, as it should.
    Ended,
    /// Back on φ₁ = φ₂, where its mirror image would cross it.
    CameBack,
    /// Beyond the horizon.
    LeftHorizon,
    /// The singular control is not defined: no step is short enough.
    Stalled,
    /// Arc after arc without an end.
    TooManyArcs,
}

/// Most arcs of a quarter.
pub(crate) const MOST_ARCS: usize = 12;
/// A quarter gait.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Quarter {
    pub(super) legs: [Leg; MOST_ARCS],
    pub(super) count: usize,
    /// Whether it touched φ₁ = −φ₂ and went on along it.
    pub(crate) touched: bool,
    pub(crate) fate: Fate,
    pub(crate) end: State,
}

impl Quarter {
    pub(crate) fn legs(&self) -> &[Leg] {
        self.legs.get(..self.count).unwrap_or_default()
    }

    /// Whether it ends on a way along φ₁ = −φ₂, which it would go back: no loop.
    pub(crate) fn ends_in_a_spike(&self) -> bool {
        let last = self.legs().last().map(|leg| leg.motion);
        matches!(last, Some(Motion::Along(track)) if is_end_line(track.wall.edge()))
    }
}
