//! Where a quarter gait may go: the bounds of the joint angles as a convex polygon in the (φ₁, φ₂) plane.
//!
//! A quarter runs from φ₁ = φ₂ > 0 to φ₁ = −φ₂, φ₂ > 0, so bounds on |φᵢ| bind its leading angle φ₂ from below and both
//! angles from above; the sector adds the two diagonals.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, Bounds};

/// One bound: `normal · Φ ≤ offset`, with a unit normal that points out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Edge {
    pub(crate) normal: Vector2<f64>,
    pub(crate) offset: f64,
    pub(crate) kind: ArcKind,
}

/// A convex region of shapes.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Region {
    edges: Vec<Edge>,
    /// Beyond this |Φ| the search does not look \[rad\]; farther than any corner where a bound binds.
    pub(crate) horizon: f64,
}

impl Edge {
    /// How far inside a shape is \[rad\]; negative outside.
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

impl Region {
    /// The search looks no farther than one full turn of a joint when nothing binds it.
    pub(crate) const HORIZON: f64 = std::f64::consts::TAU;

    pub(crate) fn new(bounds: &Bounds) -> Self {
        let mut edges = Vec::with_capacity(6);
        let mut edge = |x: f64, y: f64, offset: f64, kind| {
            edges.push(Edge {
                normal: Vector2::new(x, y),
                offset,
                kind,
            });
        };
        if let Some(max) = bounds.max_angle {
            edge(0.0, 1.0, max, ArcKind::Upper);
            edge(-1.0, 0.0, max, ArcKind::Upper);
            edge(1.0, 0.0, max, ArcKind::Upper);
        }
        if let Some(min) = bounds.min_angle {
            edge(0.0, -1.0, -min, ArcKind::Lower);
        }
        if bounds.sector {
            let half = std::f64::consts::FRAC_1_SQRT_2;
            edge(half, -half, 0.0, ArcKind::Diagonal);
            edge(-half, -half, 0.0, ArcKind::Diagonal);
        }
        Self {
            edges,
            horizon: bounds.max_angle.map_or(Self::HORIZON, |max| 2.0 * max),
        }
    }

    pub(crate) fn edges(&self) -> &[Edge] {
        &self.edges
    }

    pub(crate) fn edge(&self, index: usize) -> Option<&Edge> {
        self.edges.get(index)
    }

    /// Whether the sector's sides, φ₁ = φ₂ and φ₁ = −φ₂, are bounds.
    pub(crate) fn has_diagonals(&self) -> bool {
        self.edges.iter().any(|edge| edge.kind == ArcKind::Diagonal)
    }

    /// Largest overstepping of any bound at a shape \[rad\]; negative where all hold.
    pub(crate) fn overstepped(&self, phi: &Vector2<f64>) -> f64 {
        self.edges
            .iter()
            .map(|edge| -edge.margin(phi))
            .fold(f64::NEG_INFINITY, f64::max)
    }
}
