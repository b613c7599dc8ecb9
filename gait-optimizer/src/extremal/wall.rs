//! A bound of the joint angles as a smooth curve to run along.

use nalgebra::{Matrix2, Vector2};
use swimmer_files::{ArcKind, Bounds};

/// A bound `value(Φ) ≤ 0` whose zero is a smooth curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wall {
    normal: Vector2<f64>,
    offset: f64,
    pub(crate) kind: ArcKind,
}

impl Wall {
    /// `normal · Φ ≤ offset` with a unit normal that points out.
    pub(crate) fn straight(normal: Vector2<f64>, offset: f64, kind: ArcKind) -> Self {
        Self {
            normal,
            offset,
            kind,
        }
    }

    /// How far beyond the bound a shape is \[rad\]; negative inside.
    pub(crate) fn value(&self, phi: &Vector2<f64>) -> f64 {
        self.normal.dot(phi) - self.offset
    }

    /// Gradient of [`Wall::value`]; points out.
    pub(crate) fn gradient(&self, _phi: &Vector2<f64>) -> Vector2<f64> {
        self.normal
    }

    /// Second derivatives of [`Wall::value`].
    pub(crate) fn hessian(&self, _phi: &Vector2<f64>) -> Matrix2<f64> {
        Matrix2::zeros()
    }

    /// dψ over the arc length of a curve that keeps tangent to the bound.
    pub(crate) fn turning(&self, _phi: &Vector2<f64>, _e: &Vector2<f64>) -> f64 {
        0.0
    }

    /// [`Wall::turning`] and its derivatives with respect to φ₁, φ₂, ψ.
    pub(crate) fn turning_and_slopes(
        &self,
        _phi: &Vector2<f64>,
        _e: &Vector2<f64>,
    ) -> (f64, [f64; 3]) {
        (0.0, [0.0; 3])
    }

    /// Whether both are the same bound, perhaps at another place.
    pub(crate) fn is_like(&self, other: &Self) -> bool {
        self.normal == other.normal && self.kind == other.kind
    }

    /// The shape on the bound nearest to this one, to first order.
    pub(crate) fn onto(&self, phi: &Vector2<f64>) -> Vector2<f64> {
        let gradient = self.gradient(phi);
        phi - gradient * (self.value(phi) / gradient.norm_squared())
    }

    /// The tangent's direction nearest to ψ.
    pub(crate) fn tangent(&self, phi: &Vector2<f64>, psi: f64) -> f64 {
        let gradient = self.gradient(phi);
        let along = gradient.y.atan2(gradient.x) + std::f64::consts::FRAC_PI_2;
        let halves: f64 = (psi - along) / std::f64::consts::PI;
        along + halves.round() * std::f64::consts::PI
    }
}

/// All bounds of a full cycle.
#[derive(Debug, Clone, PartialEq, Default)]
pub(crate) struct Walls {
    walls: Vec<Wall>,
}

impl Walls {
    /// The upper bound on both angles, where there is one.
    pub(crate) fn new(bounds: &Bounds) -> Self {
        let sides = [(0.0, 1.0), (-1.0, 0.0), (0.0, -1.0), (1.0, 0.0)];
        let walls = bounds.max_angle.map_or_else(Vec::new, |max| {
            sides
                .map(|(x, y)| Wall::straight(Vector2::new(x, y), max, ArcKind::Upper))
                .to_vec()
        });
        Self { walls }
    }

    /// The bound that a shape is farthest beyond, or nearest to, with how far; none without bounds.
    pub(crate) fn nearest(&self, phi: &Vector2<f64>) -> Option<(Wall, f64)> {
        self.walls
            .iter()
            .map(|wall| (*wall, wall.value(phi)))
            .max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// This region's wall that is like another's.
    pub(crate) fn like(&self, wall: &Wall) -> Option<Wall> {
        self.walls.iter().copied().find(|own| own.is_like(wall))
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.walls.is_empty()
    }
}
