//! Kind of an arc: singular, or along a piece of a bound in either direction.

use nalgebra::Vector2;
use swimmer_files::ArcKind;

use crate::region::{Bound, Piece, Region};

/// Kind of an arc.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// Singular arc.
    Singular,
    /// Arc along a bound of the region.
    Along(Track),
}

impl Motion {
    /// Active bound. Returns `None` for a singular arc.
    pub(crate) fn track(&self) -> Option<&Track> {
        match self {
            Self::Singular => None,
            Self::Along(track) => Some(track),
        }
    }

    /// Kind of the arc in a gait file.
    pub(crate) fn kind(&self) -> ArcKind {
        self.track()
            .map_or(ArcKind::Singular, |track| track.wall.kind())
    }

    /// Index of the active bound. Returns `None` for a singular arc.
    pub(crate) fn bound(&self) -> Option<usize> {
        self.track().map(|track| track.index)
    }

    /// Remaining length of the bound's piece, with its gradient by Φ. Returns `None` if the piece does not end.
    pub(crate) fn piece_end(&self, phi: &Vector2<f64>) -> Option<(f64, Vector2<f64>)> {
        match self.track()?.wall {
            Bound::Clearance(clearance) => clearance.piece_end(clearance.piece(phi), phi),
            Bound::Straight(_) => None,
        }
    }

    /// Motion along the next piece of the bound. Returns `None` on the last piece.
    pub(crate) fn next_piece(&self) -> Option<Self> {
        self.track()?.next_piece().map(Self::Along)
    }
}

/// Active bound with its direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Track {
    /// Index of the bound in the region.
    pub(crate) index: usize,
    /// Bound, restricted to the active piece.
    pub(crate) wall: Bound,
    /// 1 if the region is on the left, −1 if it is on the right.
    pub(crate) way: f64,
}

impl Track {
    /// Track along the piece of a bound that contains a shape. Returns `None` if the region has no such bound.
    pub(crate) fn new(region: &Region, index: usize, phi: &Vector2<f64>, way: f64) -> Option<Self> {
        Some(Self {
            index,
            wall: region.bound(index)?.held_at(phi),
            way,
        })
    }

    /// Reverses the direction.
    pub(crate) fn back(self) -> Self {
        Self {
            way: -self.way,
            ..self
        }
    }

    /// Unit direction of motion, smooth beyond the end of the piece.
    pub(crate) fn direction(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        self.wall.tangent(phi) * self.way
    }

    /// Unit normal that points into the region.
    pub(crate) fn inwards(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        let along = self.wall.tangent(phi);
        Vector2::new(-along.y, along.x)
    }

    /// Next piece. Around a set of crossing shapes the order is front tip, tips, back tip.
    pub(crate) fn next_piece(&self) -> Option<Self> {
        let Bound::Clearance(clearance) = self.wall else {
            return None;
        };
        let forwards = self.way > 0.0;
        let next = match clearance.held? {
            Piece::Tips => Piece::Tip(usize::from(forwards)),
            Piece::Tip(tip) if forwards == (tip == 0) => clearance.after_tip(tip),
            _ => return None,
        };
        Some(Self {
            wall: Bound::Clearance(clearance.held_to(next)),
            ..*self
        })
    }
}
