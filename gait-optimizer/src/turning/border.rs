//! The border of what the bounds allow round the straight shape, walked counter-clockwise, bound after bound.
//!
//! Corners are where another bound, or another piece of the curved one, takes over.

use nalgebra::Vector2;

use crate::momentum::Track;
use crate::numerics::halved;
use crate::region::{Bound, Region};

/// A point of the border with the bound that it lies on, the region on the left.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BorderPoint {
    pub(super) phi: Vector2<f64>,
    pub(super) track: Track,
}

/// The border of a region.
#[derive(Debug)]
pub(super) struct Border {
    /// Counter-clockwise; where the bound changes, two points stand at the corner, one of each.
    pub(super) points: Vec<BorderPoint>,
}

/// A curved bound turns by no more than this from point to point \[rad\].
const TURN: f64 = 0.02;
/// Points of a curved bound nearer to each other than this are left as they are \[rad\].
const NARROWEST: f64 = 1e-4;
/// A border of more points than this does not come round.
const MOST_POINTS: usize = 100_000;
/// A bound takes over where it is overstepped by more than this, in rad or over L.
const BEYOND: f64 = 1e-13;
/// A piece that ends within this step has ended \[rad\].
const AT_END: f64 = 1e-11;
/// Which piece of another bound takes over is seen this far beyond the end \[rad\].
const AHEAD: f64 = 1e-5;
/// Halvings that place a corner.
const HALVINGS: usize = 60;

impl Border {
    /// The border, with points no farther apart than `spacing` \[rad\]. None where the region has no bound on φ₁, or the walk does
    /// not come round.
    pub(super) fn new(region: &Region, spacing: f64) -> Option<Self> {
        let bounds: Vec<Bound> = region.bounds().collect();
        // Where φ₂ = 0 no other link is near, and only the bound on φ₁ binds.
        let (first, edge) = region
            .edges()
            .iter()
            .enumerate()
            .find(|(_, edge)| edge.normal.x > 0.5)?;
        let start = Vector2::new(edge.offset, 0.0);
        let mut here = BorderPoint {
            phi: start,
            track: Track::new(region, first, &start, 1.0)?,
        };
        let mut points = vec![here];
        while points.len() < MOST_POINTS {
            let next = next(region, &bounds, &here, spacing)?;
            let home = here.track.index == first && here.phi.y < 0.0 && next.phi.y >= 0.0;
            if home && next.track == here.track {
                return Some(Self { points });
            }
            points.push(next);
            here = next;
        }
        None
    }

    /// The largest |φᵢ| on the border.
    pub(super) fn reach(&self) -> f64 {
        self.points
            .iter()
            .map(|point| point.phi.amax())
            .fold(0.0, f64::max)
    }

    /// The place between two neighbours, from one (0) to the other (1).
    pub(super) fn between(from: &BorderPoint, to: &BorderPoint, share: f64) -> Vector2<f64> {
        let phi = from.phi.lerp(&to.phi, share);
        if from.track == to.track {
            from.track.wall.onto(&phi)
        } else {
            phi
        }
    }

    /// Where the border crosses φ₁ = φ₂ > 0.
    pub(super) fn on_diagonal(&self) -> Option<Vector2<f64>> {
        let off = |phi: &Vector2<f64>| phi.x - phi.y;
        let (before, after) = self
            .points
            .iter()
            .zip(self.points.iter().cycle().skip(1))
            .find(|(a, b)| off(&a.phi) > 0.0 && off(&b.phi) <= 0.0 && a.phi.sum() > 0.0)?;
        let before_it = |share| off(&Self::between(before, after, share)) > 0.0;
        let [_, share] = halved([0.0, 1.0], HALVINGS, before_it);
        Some(Self::between(before, after, share))
    }
}

/// What ends a piece.
enum End {
    /// The bound's next piece.
    Piece,
    /// Another bound, by its place.
    Bound(usize),
}

/// The next point, `spacing` ahead or nearer: on the same piece, or at its end the first point of what takes over.
fn next(
    region: &Region,
    bounds: &[Bound],
    here: &BorderPoint,
    spacing: f64,
) -> Option<BorderPoint> {
    let track = here.track;
    let along = track.direction(&here.phi);
    let ahead = |step: f64| track.wall.onto(&(here.phi + along * step));
    let mut step = spacing;
    while step > NARROWEST && along.dot(&track.direction(&ahead(step))) < TURN.cos() {
        step *= 0.5;
    }
    let end = |step: f64| {
        let phi = ahead(step);
        if track.piece_end(&phi).is_some_and(|(left, _)| left < 0.0) {
            return Some(End::Piece);
        }
        let mut others = bounds.iter().enumerate();
        others
            .find(|(index, bound)| *index != track.index && bound.margin(&phi) < -BEYOND)
            .map(|(index, _)| End::Bound(index))
    };
    if end(step).is_none() {
        let phi = ahead(step);
        return Some(BorderPoint { phi, track });
    }
    let [low, high] = halved([0.0, step], HALVINGS, |step| end(step).is_none());
    let phi = here.phi;
    if low > AT_END {
        let phi = ahead(low);
        return Some(BorderPoint { phi, track });
    }
    // It ends here.
    let track = match end(high)? {
        End::Piece => track.next_piece()?,
        End::Bound(index) => Track::new(region, index, &ahead(high + AHEAD), 1.0)?,
    };
    Some(BorderPoint { phi, track })
}
