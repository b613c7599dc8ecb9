//! What an arc runs along: free, or along a bound one way or the other, piece by piece.

use nalgebra::Vector2;
use swimmer_files::ArcKind;

use crate::region::{Bound, Piece, Region};

/// What an arc runs along.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Motion {
    /// The singular control.
    Singular,
    /// A bound of the region.
    Along(Track),
}

impl Motion {
    /// The bound that is run along; none for the singular control.
    pub(crate) fn track(&self) -> Option<&Track> {
        match self {
            Self::Singular => None,
            Self::Along(track) => Some(track),
        }
    }

    /// What an arc of it is called.
    pub(crate) fn kind(&self) -> ArcKind {
        self.track()
            .map_or(ArcKind::Singular, |track| track.wall.kind())
    }

    /// Place of the bound that is run along; none for the singular control.
    pub(crate) fn bound(&self) -> Option<usize> {
        self.track().map(|track| track.index)
    }

    /// What is left of the bound's piece, with its slope in Φ; none where it does not end.
    pub(crate) fn piece_end(&self, phi: &Vector2<f64>) -> Option<(f64, Vector2<f64>)> {
        match self.track()?.wall {
            Bound::Clearance(clearance) => clearance.piece_end(clearance.piece(phi), phi),
            Bound::Straight(_) => None,
        }
    }

    /// Along the bound's next piece, where there is one.
    pub(crate) fn next_piece(&self) -> Option<Self> {
        self.track()?.next_piece().map(Self::Along)
    }
}

/// A bound with the way that it is run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Track {
    /// Place of the bound in the region.
    pub(crate) index: usize,
    /// Held to the piece that is run along.
    pub(crate) wall: Bound,
    /// 1 with the region on the left, −1 with the region on the right.
    pub(crate) way: f64,
}

impl Track {
    /// Along the piece of a bound that a shape lies on; none where the region has no such bound.
    pub(crate) fn new(region: &Region, index: usize, phi: &Vector2<f64>, way: f64) -> Option<Self> {
        Some(Self {
            index,
            wall: region.bound(index)?.held_at(phi),
            way,
        })
    }

    /// The other way.
    pub(crate) fn back(self) -> Self {
        Self {
            way: -self.way,
            ..self
        }
    }

    /// Unit direction of motion; smooth also beyond the piece's end.
    pub(crate) fn direction(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        self.wall.tangent(phi) * self.way
    }

    /// Unit normal that points into the region.
    pub(crate) fn inwards(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        let along = self.wall.tangent(phi);
        Vector2::new(-along.y, along.x)
    }

    /// The piece after this one. Round a forbidden zone they follow each other as front tip, tips, back tip.
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
