//! Walls as an extremal runs along them, and all walls of a full cycle.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, Bounds};
use swimmer_model::Links;

pub(crate) use crate::region::Wall;
use crate::region::{Bound, Clearance, Edge, Level, Piece, Region};

impl Wall {
    /// dψ over the arc length of a curve that keeps tangent to the bound.
    pub(crate) fn turning(&self, phi: &Vector2<f64>, e: &Vector2<f64>) -> f64 {
        match self {
            Self::Straight(_) => 0.0,
            Self::Curved(..) => {
                let level = self.level(phi);
                -e.dot(&(level.hessian * e)) / level.gradient.dot(&Vector2::new(-e.y, e.x))
            }
        }
    }

    /// [`Wall::turning`] and its derivatives with respect to φ₁, φ₂, ψ.
    ///
    /// Those of the Hessian are central differences: they steer Newton's iteration, and what it converges to does not
    /// depend on them.
    pub(crate) fn turning_and_slopes(
        &self,
        phi: &Vector2<f64>,
        e: &Vector2<f64>,
    ) -> (f64, [f64; 3]) {
        const STEP: f64 = 1e-4;
        if let Self::Straight(_) = self {
            return (0.0, [0.0; 3]);
        }
        let n = Vector2::new(-e.y, e.x);
        let Level {
            gradient, hessian, ..
        } = self.level(phi);
        let (bend, across) = (e.dot(&(hessian * e)), gradient.dot(&n));
        let turning = -bend / across;
        let by_joint = |axis: Vector2<f64>| {
            let ahead = self.level(&(phi + axis * STEP)).hessian;
            let behind = self.level(&(phi - axis * STEP)).hessian;
            let bend_by = e.dot(&((ahead - behind) * e)) / (2.0 * STEP);
            let across_by = (hessian * n).dot(&axis);
            -(bend_by + turning * across_by) / across
        };
        // dn/dψ = −e.
        let by_direction = -(2.0 * n.dot(&(hessian * e)) - turning * gradient.dot(e)) / across;
        (
            turning,
            [by_joint(Vector2::x()), by_joint(Vector2::y()), by_direction],
        )
    }

    /// Whether both are the same bound, perhaps at another place.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        match (self, other) {
            (Self::Straight(a), Self::Straight(b)) => a.normal == b.normal,
            (Self::Curved(_, a), Self::Curved(_, b)) => a == b,
            _ => false,
        }
    }

    /// The tangent's direction nearest to ψ.
    pub(crate) fn tangent(&self, phi: &Vector2<f64>, psi: f64) -> f64 {
        let gradient = self.level(phi).gradient;
        let along = gradient.y.atan2(gradient.x) + std::f64::consts::FRAC_PI_2;
        let halves: f64 = (psi - along) / std::f64::consts::PI;
        along + halves.round() * std::f64::consts::PI
    }
}

/// Links that may touch are kept this share of the side links apart, so that samples along the bound do not cross by
/// rounding.
const HAIR: f64 = 1e-8;

/// All bounds of a full cycle.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Walls {
    edges: Vec<Edge>,
    clearance: Option<Clearance>,
    /// Where the tips meet at φ₁, φ₂ > 0, where that is a corner; the other corner is its negative.
    corner: Option<Vector2<f64>>,
}

/// The corner of the forbidden shapes at φ₁, φ₂ > 0 where the tips of the side links meet: the three links are the sides
/// of a triangle.
fn tips_meet(links: &Links<f64>) -> Option<Vector2<f64>> {
    let outer = |own: f64, other: f64| {
        let middle = links.middle;
        ((other * other - middle * middle - own * own) / (2.0 * middle * own)).acos()
    };
    let corner = Vector2::new(
        outer(links.front, links.back),
        outer(links.back, links.front),
    );
    corner
        .iter()
        .all(|angle| angle.is_finite())
        .then_some(corner)
}

impl Walls {
    /// The bounds for a swimmer with these links \[m\]. Those that only make sense for quarters (a lower bound, the sector)
    /// are not among them.
    pub(crate) fn new(bounds: &Bounds, links: &Links<f64>) -> Self {
        let wider = |length: f64| length * (1.0 + if bounds.clearance > 0.0 { 0.0 } else { HAIR });
        let links = &Links {
            middle: links.middle,
            front: wider(links.front),
            back: wider(links.back),
        };
        let region = Region::new(bounds, links);
        let clearance = region.bounds().find_map(|bound| match bound {
            Bound::Clearance(clearance) => Some(clearance),
            Bound::Straight(_) => None,
        });
        let both_ways = |edge: &&Edge| matches!(edge.kind, ArcKind::Upper | ArcKind::Clearance);
        Self {
            edges: region.edges().iter().filter(both_ways).copied().collect(),
            corner: clearance
                .filter(Clearance::has_corner)
                .and_then(|_| tips_meet(links)),
            clearance,
        }
    }

    /// The bound that a shape is farthest beyond, or nearest to, with how far; none without bounds.
    pub(crate) fn nearest(&self, phi: &Vector2<f64>) -> Option<(Wall, f64)> {
        let straight = self
            .edges
            .iter()
            .map(|edge| (Wall::Straight(*edge), -edge.margin(phi)));
        // A tip over the other side link's joint is bounded by its angle alone, which is a straight bound.
        let curved = self.clearance.iter().filter_map(|clearance| {
            let piece = clearance.piece(phi);
            let at_joint = matches!(piece, Piece::TipToJoint(_));
            (!at_joint).then(|| (Wall::Curved(*clearance, piece), -clearance.margin(phi)))
        });
        straight.chain(curved).max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// The corner of the forbidden shapes on the same side as a shape.
    pub(crate) fn corner(&self, phi: &Vector2<f64>) -> Option<Vector2<f64>> {
        let side = if phi.x + phi.y < 0.0 { -1.0 } else { 1.0 };
        self.corner.map(|corner| corner * side)
    }

    /// This region's wall that is like another's.
    pub(crate) fn like(&self, wall: &Wall) -> Option<Wall> {
        match wall {
            Wall::Straight(_) => self
                .edges
                .iter()
                .map(|edge| Wall::Straight(*edge))
                .find(|own| own.is_like(wall)),
            Wall::Curved(_, piece) => self.clearance.map(|own| Wall::Curved(own, *piece)),
        }
    }
}
