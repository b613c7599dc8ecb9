//! The arcs that a walk round a region is made of.

use nalgebra::Vector2;
use swimmer_files::ArcKind;

use super::border::BorderPoint;
use crate::momentum::Track;

/// One arc of a walk.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Piece {
    pub(super) kind: ArcKind,
    pub(super) points: Vec<Vector2<f64>>,
}

pub(super) fn singular(points: Vec<Vector2<f64>>) -> Piece {
    Piece {
        kind: ArcKind::Singular,
        points,
    }
}

/// Ends a polyline at a point, without a last vertex too near to it.
pub(super) fn close_up(points: &mut Vec<Vector2<f64>>, end: Vector2<f64>, gap: f64) {
    while points.len() > 1 && points.last().is_some_and(|last| (last - end).norm() < gap) {
        points.pop();
    }
    points.push(end);
}

/// A stretch of the border, cut where its bound changes; `track` is that at its beginning.
pub(super) fn pieces_of(
    begin: Vector2<f64>,
    track: Track,
    border: &[BorderPoint],
    end: Vector2<f64>,
    gap: f64,
) -> Vec<Piece> {
    let mut pieces: Vec<Piece> = Vec::new();
    let mut points = vec![begin];
    let mut track = track;
    for point in border {
        if track != point.track {
            // Both points of a corner stand at one place: it ends one piece and begins the next.
            ended(&mut pieces, track.wall.kind(), &mut points, point.phi, gap);
            track = point.track;
        } else if points
            .last()
            .is_none_or(|last| (last - point.phi).norm() >= gap)
        {
            points.push(point.phi);
        }
    }
    ended(&mut pieces, track.wall.kind(), &mut points, end, gap);
    pieces
}

/// Ends a piece at a corner and begins the next there; a piece without length is none.
fn ended(
    pieces: &mut Vec<Piece>,
    kind: ArcKind,
    points: &mut Vec<Vector2<f64>>,
    end: Vector2<f64>,
    gap: f64,
) {
    close_up(points, end, gap);
    let piece = std::mem::replace(points, vec![end]);
    let sides = piece.array_windows().map(|[a, b]| (b - a).norm());
    if sides.sum::<f64>() > 1e-9 {
        pieces.push(Piece {
            kind,
            points: piece,
        });
    }
}
