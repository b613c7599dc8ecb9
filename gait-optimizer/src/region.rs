//! Admissible region of shapes: straight bounds of the joint angles in the (φ₁, φ₂) plane, and the curved bound that keeps the
//! side links apart.
//!
//! A quarter runs from φ₁ = φ₂ > 0 to φ₁ = −φ₂, φ₂ > 0, so a bound on |φᵢ| from below binds its leading angle φ₂, and the
//! sector adds the two diagonals; those three only make sense for quarters. All others hold for full cycles as well.

mod clearance;
#[cfg(test)]
mod tests;

use nalgebra::{Matrix2, Vector2};
use swimmer_files::{ArcKind, Bounds};
use swimmer_model::Links;

pub(crate) use clearance::Piece;
use clearance::tips_meet;
pub use clearance::{Clearance, Level};

/// A straight bound: `normal · Φ ≤ offset`, with a unit normal that points out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Edge {
    /// Unit normal, out of the region.
    pub normal: Vector2<f64>,
    /// Distance from the straight shape \[rad\].
    pub offset: f64,
    /// Kind of an arc along it.
    pub kind: ArcKind,
}

/// One bound of a region, or one smooth curve of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Bound {
    /// One of the angles, or both alike.
    Straight(Edge),
    /// Both zones where the side links are too near or cross, φ₁, φ₂ > 0 and φ₁, φ₂ < 0.
    Clearance(Clearance),
}

/// Intersection of all bounds. Convex but for the clearance.
#[derive(Debug, Clone, PartialEq)]
pub struct Region {
    edges: Vec<Edge>,
    clearance: Option<Clearance>,
    /// Shape at which the tips meet, φ₁, φ₂ > 0; the other corner is its negative.
    corner: Option<Vector2<f64>>,
    /// Beyond this |Φ| the search does not look \[rad\]; farther than any corner where a bound binds.
    pub(crate) horizon: f64,
}

impl Edge {
    /// Distance of a shape from the edge \[rad\], positive inside.
    pub(crate) fn margin(&self, phi: &Vector2<f64>) -> f64 {
        self.offset - self.normal.dot(phi)
    }

    /// The nearest shape on the edge.
    pub(crate) fn onto(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        phi + self.normal * self.margin(phi)
    }

    /// Unit vector along the edge with the region on its left.
    pub(crate) fn counter_clockwise(&self) -> Vector2<f64> {
        Vector2::new(-self.normal.y, self.normal.x)
    }
}

impl Bound {
    /// Kind of an arc along it.
    pub fn kind(&self) -> ArcKind {
        self.edge().map_or(ArcKind::Clearance, |edge| edge.kind)
    }

    /// The edge. Returns `None` for a curved bound.
    pub(crate) fn edge(&self) -> Option<&Edge> {
        match self {
            Self::Straight(edge) => Some(edge),
            Self::Clearance(_) => None,
        }
    }

    /// Active piece of the bound at a shape. Returns `None` for an edge, which has one piece.
    pub(crate) fn piece(&self, phi: &Vector2<f64>) -> Option<Piece> {
        match self {
            Self::Straight(_) => None,
            Self::Clearance(clearance) => Some(clearance.piece(phi)),
        }
    }

    /// The smooth curve that it is at a shape, also beyond the stretch on which that decides.
    pub(crate) fn held_at(&self, phi: &Vector2<f64>) -> Self {
        match self {
            Self::Straight(_) => *self,
            Self::Clearance(clearance) => Self::Clearance(clearance.held_to(clearance.piece(phi))),
        }
    }

    /// Margin of a shape, positive inside. In rad for an edge, a length over L for the clearance.
    pub fn margin(&self, phi: &Vector2<f64>) -> f64 {
        match self {
            Self::Straight(edge) => edge.margin(phi),
            Self::Clearance(clearance) => clearance.margin(phi),
        }
    }

    /// The margin with its first and second derivatives.
    pub fn level(&self, phi: &Vector2<f64>) -> Level {
        match self {
            Self::Straight(edge) => Level {
                value: edge.margin(phi),
                gradient: -edge.normal,
                hessian: Matrix2::zeros(),
            },
            Self::Clearance(clearance) => clearance.deciding_level(phi),
        }
    }

    /// The same for what sees the bound from inside only, smooth there up to the bound: where links may touch, the distance of
    /// the tips is a cone round the corner of the bound that Newton's method cannot see past. Side links cross if and only if
    /// both tips are beyond the other link's line, and the higher one is a smooth margin up to the corner.
    pub fn smooth_level(&self, phi: &Vector2<f64>) -> Level {
        match self {
            Self::Clearance(clearance) if clearance.has_corner() => {
                let [front, back] = [0, 1].map(|tip| clearance.level(Piece::Tip(tip), phi));
                if front.value > back.value {
                    front
                } else {
                    back
                }
            }
            bound => bound.level(phi),
        }
    }

    /// ∂margin/∂Φ; points inwards.
    pub(crate) fn gradient(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        self.level(phi).gradient
    }

    /// Unit vector along the bound with the region on its left. Off the bound: along the curve of equal margin.
    pub(crate) fn tangent(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        self.level(phi).tangent()
    }

    /// A shape on the bound near this one: the nearest one of an edge; for the clearance along the margin's gradient, to
    /// |margin| < 1e-15, where the shape is not too far off (the unchanged shape otherwise).
    pub(crate) fn onto(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        match self {
            Self::Straight(edge) => edge.onto(phi),
            Self::Clearance(clearance) => onto(phi, |phi| clearance.deciding_level(phi)),
        }
    }
}

/// A shape near this one where a margin vanishes, by Newton's method along its gradient; the unchanged shape where that fails.
fn onto(phi: &Vector2<f64>, level: impl Fn(&Vector2<f64>) -> Level) -> Vector2<f64> {
    const STEPS: usize = 40;
    /// Longest step towards the bound \[rad\].
    const STRIDE: f64 = 0.3;
    let mut here = *phi;
    for _ in 0..STEPS {
        let there = level(&here);
        if there.value.abs() < 1e-15 {
            return here;
        }
        let step = there.gradient * (there.value / there.gradient.norm_squared());
        if !step.norm().is_finite() {
            return *phi;
        }
        here -= step * (STRIDE / step.norm()).min(1.0);
    }
    // Rounding may keep it from the very last digit.
    if level(&here).value.abs() < 1e-13 {
        here
    } else {
        *phi
    }
}

impl Region {
    /// The search looks no farther than one full turn of a joint when nothing binds it.
    pub(crate) const HORIZON: f64 = std::f64::consts::TAU;

    /// The region for a swimmer with these links \[m\]; the clearance is measured over their total length.
    pub fn new(bounds: &Bounds, links: &Links<f64>) -> Self {
        let length = links.middle + links.front + links.back;
        let corner = tips_meet(links);
        let links = Links {
            middle: links.middle / length,
            front: links.front / length,
            back: links.back / length,
        };
        let clearance = bounds.clearance / length;
        let mut edges = Vec::with_capacity(7);
        let mut edge = |x: f64, y: f64, offset: f64, kind| {
            edges.push(Edge {
                normal: Vector2::new(x, y),
                offset,
                kind,
            });
        };
        // Of each joint, the tighter of the bound on its angle and of the fold onto the middle link.
        let reach = |side: f64| {
            let fold = bounds
                .no_overlap
                .then(|| Clearance::fold(side, links.middle, clearance));
            match (bounds.max_angle, fold) {
                (Some(max), Some(fold)) if fold < max => Some((fold, ArcKind::Clearance)),
                (Some(max), _) => Some((max, ArcKind::Upper)),
                (None, fold) => fold.map(|fold| (fold, ArcKind::Clearance)),
            }
        };
        let [front, back] = [links.front, links.back].map(reach);
        for (x, y, farthest) in [
            (0.0, 1.0, back),
            (-1.0, 0.0, front),
            (1.0, 0.0, front),
            (0.0, -1.0, back),
        ] {
            if let Some((max, kind)) = farthest {
                edge(x, y, max, kind);
            }
        }
        if let Some(min) = bounds.min_angle {
            edge(0.0, -1.0, -min, ArcKind::Lower);
        }
        if bounds.sector {
            let half = std::f64::consts::FRAC_1_SQRT_2;
            edge(half, -half, 0.0, ArcKind::Diagonal);
            edge(-half, -half, 0.0, ArcKind::Diagonal);
        }
        let farthest = front
            .zip(back)
            .map(|(front, back)| 2.0 * front.0.max(back.0));
        Self {
            edges,
            clearance: bounds
                .no_overlap
                .then(|| Clearance::new(&links, clearance))
                .flatten(),
            corner,
            horizon: farthest.unwrap_or(Self::HORIZON),
        }
    }

    /// The straight bounds.
    pub(crate) fn edges(&self) -> &[Edge] {
        &self.edges
    }

    /// The farthest that any straight bound is from the straight shape \[rad\]: where one bounds each joint, no angle is larger.
    pub(crate) fn reach(&self) -> f64 {
        let offsets = self.edges.iter().map(|edge| edge.offset.abs());
        offsets.fold(0.0, f64::max)
    }

    /// Scale of the shapes that the straight bounds admit: the distance of the nearest one from the straight shape \[rad\], at most 1.
    pub(crate) fn scale(&self) -> f64 {
        let offsets = self.edges.iter().map(|edge| edge.offset.abs());
        offsets.fold(1.0, f64::min)
    }

    /// All bounds: the straight ones, then the curved one. Its index is the place in this order.
    pub fn bounds(&self) -> impl Iterator<Item = Bound> + '_ {
        let straight = self.edges.iter().map(|edge| Bound::Straight(*edge));
        straight.chain(self.clearance.map(Bound::Clearance))
    }

    pub(crate) fn bound(&self, index: usize) -> Option<Bound> {
        self.bounds().nth(index)
    }

    /// The corner of the forbidden shapes on the same side as a shape, if the bound has one.
    pub(crate) fn corner(&self, phi: &Vector2<f64>) -> Option<Vector2<f64>> {
        let side = if phi.x + phi.y < 0.0 { -1.0 } else { 1.0 };
        let bound = self.clearance.filter(Clearance::has_corner);
        Some(bound.and(self.corner)? * side)
    }

    /// `true` if the sector's sides, φ₁ = φ₂ and φ₁ = −φ₂, are bounds.
    pub(crate) fn has_diagonals(&self) -> bool {
        self.edges.iter().any(|edge| edge.kind == ArcKind::Diagonal)
    }

    /// `true` if some bounds are defined on a quarter, so that they apply only to gaits with the paper's symmetries.
    pub(crate) fn is_of_quarters(&self) -> bool {
        let of_quarter = |edge: &Edge| matches!(edge.kind, ArcKind::Lower | ArcKind::Diagonal);
        self.edges.iter().any(of_quarter)
    }

    /// Largest overstepping of any bound at a shape (rad, or over L for the clearance); negative where all hold.
    pub(crate) fn overstepped(&self, phi: &Vector2<f64>) -> f64 {
        self.bounds()
            .map(|bound| -bound.margin(phi))
            .fold(f64::NEG_INFINITY, f64::max)
    }
}
