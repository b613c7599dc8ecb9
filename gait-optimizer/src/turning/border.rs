//! The border of what the bounds allow, seen from the straight shape: one point in every direction.
//!
//! The straight shape keeps every bound, and from it each ray meets the border first at one place. Corners are the
//! directions where another bound, or another piece of the curved one, takes over.

use nalgebra::Vector2;
use swimmer_files::ArcKind;

use crate::region::{Bound, Piece, Region};

/// A point of the border.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct BorderPoint {
    /// Its direction from Φ = 0 \[rad\], 0 to 2π.
    pub(super) direction: f64,
    pub(super) phi: Vector2<f64>,
    pub(super) bound: Bounding,
}

/// What bounds in a direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Bounding {
    index: usize,
    piece: Option<Piece>,
    pub(super) kind: ArcKind,
}

/// The border of a region.
#[derive(Debug)]
pub(super) struct Border<'a> {
    region: &'a Region,
    /// Between directions \[rad\].
    spacing: f64,
    /// Counter-clockwise; where the bound changes, two points stand at the corner, one of each.
    pub(super) points: Vec<BorderPoint>,
}

/// Neighbouring points farther apart than a tenth of a radian plus this many times the turn between them tell of a jump:
/// the border hides behind itself there.
const JUMP: f64 = 8.0;
/// Neighbours farther apart than this many of the spacing get points between them.
const WIDEST_GAP: f64 = 2.0;
/// Nor do neighbours on a curved bound that leave the middle between them this far off their chord, in its length: a fiftieth
/// of a radian apart. Round the tips the bound is as sharp as the clearance is small.
const MOST_BULGE: f64 = 0.0025;
/// Neighbours nearer than this are left as they are \[rad\].
const NARROWEST_GAP: f64 = 1e-4;

impl<'a> Border<'a> {
    /// The border in `count` directions and all corners. None where it is not bounded in every direction, or hides behind
    /// itself.
    pub(super) fn new(region: &'a Region, count: usize) -> Option<Self> {
        let mut border = Self {
            region,
            spacing: std::f64::consts::TAU / count as f64,
            points: Vec::with_capacity(count + 16),
        };
        let step = border.spacing;
        // Not at a corner of the square nor on an axis of symmetry.
        let mut before = border.at(step / 3.0)?;
        border.points.push(before);
        for k in 1..=count {
            let direction = step * (k as f64 + 1.0 / 3.0);
            let next = border.at(direction)?;
            border.corners_between(&before, &next, 0);
            let last = border.points.last().copied().unwrap_or(before);
            border.fill_between(&last, &next, 0);
            if k < count {
                border.points.push(next);
            }
            before = next;
        }
        let jumps = border.points.windows(2).any(|pair| match pair {
            [a, b] => {
                let turn = (b.direction - a.direction).abs();
                (b.phi - a.phi).norm() > 0.1 + JUMP * turn
            }
            _ => false,
        });
        (!jumps).then_some(border)
    }

    /// The largest |φᵢ| on the border.
    pub(super) fn reach(&self) -> f64 {
        self.points
            .iter()
            .map(|point| point.phi.amax())
            .fold(0.0, f64::max)
    }

    /// The border in one direction.
    pub(super) fn at(&self, direction: f64) -> Option<BorderPoint> {
        let (sin, cos) = direction.sin_cos();
        let ray = Vector2::new(cos, sin);
        let mut nearest: Option<(f64, usize)> = None;
        for (index, bound) in self.region.bounds().enumerate() {
            let way = match bound {
                Bound::Straight(edge) => {
                    let along = edge.normal.dot(&ray);
                    (along > 0.0).then(|| edge.offset / along)
                }
                Bound::Clearance(_) => {
                    let limit = nearest.map_or(f64::INFINITY, |(way, _)| way);
                    first_met(&bound, &ray, limit)
                }
            };
            if let Some(way) = way
                && nearest.is_none_or(|(nearest, _)| way < nearest)
            {
                nearest = Some((way, index));
            }
        }
        let (way, index) = nearest?;
        let phi = ray * way;
        let bound = self.region.bound(index)?;
        Some(BorderPoint {
            direction,
            phi,
            bound: Bounding {
                index,
                piece: bound.piece(&phi),
                kind: bound.kind(),
            },
        })
    }

    /// Adds points where two with the same bound are far apart: the border runs away from the straight shape.
    fn fill_between(&mut self, before: &BorderPoint, after: &BorderPoint, depth: usize) {
        let chord = after.phi - before.phi;
        let apart = chord.norm();
        let near = apart < WIDEST_GAP * self.spacing * after.phi.norm();
        let straight = before.bound.kind != ArcKind::Clearance;
        if depth > 14 || apart < NARROWEST_GAP || (near && straight) {
            return;
        }
        let Some(middle) = self.at(f64::midpoint(before.direction, after.direction)) else {
            return;
        };
        if middle.bound != before.bound || middle.bound != after.bound {
            return;
        }
        let bulge = (middle.phi - before.phi).perp(&chord).abs() / apart;
        if near && bulge < MOST_BULGE * apart {
            return;
        }
        self.fill_between(before, &middle, depth + 1);
        self.points.push(middle);
        self.fill_between(&middle, after, depth + 1);
    }

    /// Adds the corners between two points with different bounds, by bisection; there may be two close together.
    fn corners_between(&mut self, before: &BorderPoint, after: &BorderPoint, depth: usize) {
        if before.bound == after.bound || depth > 4 {
            return;
        }
        let (mut low, mut high) = (*before, *after);
        for _ in 0..60 {
            let Some(middle) = self.at(f64::midpoint(low.direction, high.direction)) else {
                return;
            };
            if middle.direction <= low.direction || middle.direction >= high.direction {
                break;
            }
            if middle.bound == before.bound {
                low = middle;
            } else {
                high = middle;
            }
        }
        let corner = low.phi;
        self.fill_between(before, &low, 0);
        self.points.push(low);
        self.points.push(BorderPoint {
            phi: corner,
            bound: high.bound,
            ..high
        });
        self.corners_between(&high, after, depth + 1);
    }
}

/// How far along a ray a curved bound is first met, before `limit`. The margin is a distance between links over their
/// total length, so it changes by at most √2 per radian: steps of half the margin cannot jump over the bound.
fn first_met(bound: &Bound, ray: &Vector2<f64>, limit: f64) -> Option<f64> {
    let (mut last, mut way) = (0.0, 0.0);
    for _ in 0..100_000 {
        let margin = bound.margin(&(ray * way));
        if margin <= 0.0 {
            break;
        }
        if way >= limit {
            return None;
        }
        last = way;
        way = (way + (0.5 * margin).max(1e-7)).min(limit);
    }
    let (mut low, mut high) = (last, way);
    if bound.margin(&(ray * high)) > 0.0 {
        return None;
    }
    for _ in 0..60 {
        let middle = f64::midpoint(low, high);
        if bound.margin(&(ray * middle)) > 0.0 {
            low = middle;
        } else {
            high = middle;
        }
    }
    (low < limit).then_some(low)
}
