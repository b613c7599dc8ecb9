//! The full cycle of a smooth quarter without bounds: one arc, no corner.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitArc};

use super::Cycle;

impl Cycle {
    /// From shapes at equal fractions of the quarter's energy, from φ₁ = φ₂ to φ₁ = −φ₂, both included.
    pub(crate) fn of_smooth_quarter(shapes: &[Vector2<f64>]) -> Self {
        let quarter = shapes.len().saturating_sub(1);
        let mut phi = Vec::with_capacity(4 * quarter + 1);
        for sign in [1.0, -1.0] {
            phi.extend(shapes.iter().take(quarter).map(|shape| shape * sign));
            let back = shapes.iter().skip(1).rev();
            phi.extend(back.map(|shape| Vector2::new(-shape.y, -shape.x) * sign));
        }
        phi.extend(phi.first().copied());
        let intervals = (4 * quarter).max(1) as f64;
        Self {
            u: (0..phi.len()).map(|i| i as f64 / intervals).collect(),
            phi,
            corners: Vec::new(),
            arcs: vec![GaitArc {
                kind: ArcKind::Regular,
                from: 0.0,
                to: 1.0,
            }],
        }
    }
}
