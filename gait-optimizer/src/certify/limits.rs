//! Margins and normals of the bounds at a shape.
//!
//! Upper bounds and the clearance of the links hold everywhere. A lower bound and the sector are defined for the first quarter,
//! between φ₁ = φ₂ > 0 and φ₁ = −φ₂, φ₂ > 0; the other quarters are its images.

use nalgebra::Vector2;
use swimmer_files::ArcKind;

use crate::region::{Bound, Region};

/// Bound at a shape.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Limit {
    /// Distance of the shape from the bound \[rad\]; negative outside.
    pub(super) margin: f64,
    /// Outward unit normal.
    pub(super) normal: Vector2<f64>,
    /// `true` for the clearance of the links.
    pub(super) curved: bool,
}

impl Limit {
    /// All bounds of a region at a shape in one quarter of the cycle (0 to 3), always in the same order.
    pub(super) fn all(region: &Region, phi: &Vector2<f64>, quarter: usize) -> Vec<Self> {
        let limit = |bound: Bound| {
            let of_quarter = matches!(bound.kind(), ArcKind::Lower | ArcKind::Diagonal);
            // The images are their own inverses.
            let quarter = if of_quarter { quarter } else { 0 };
            let shape = image(*phi, quarter);
            let gradient = bound.gradient(&shape);
            let slope = gradient.norm();
            // Where tip meets tip the distance has no gradient: the shape is on the bound, and outward is away from the straight shape.
            let (margin, out) = if slope > f64::EPSILON {
                (bound.margin(&shape) / slope, -gradient / slope)
            } else {
                (bound.margin(&shape), shape.normalize())
            };
            Self {
                margin,
                normal: image(out, quarter),
                curved: bound.edge().is_none(),
            }
        };
        region.bounds().map(limit).collect()
    }
}

/// Reflects a vector of the first quarter to another quarter, or back, by the paper's symmetries.
pub(super) fn image(v: Vector2<f64>, quarter: usize) -> Vector2<f64> {
    match quarter {
        1 => Vector2::new(-v.y, -v.x),
        2 => -v,
        3 => Vector2::new(v.y, v.x),
        _ => v,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_files::Bounds;
    use swimmer_model::Links;

    /// Gaits may start at the corner of the forbidden shapes, where the distance of the tips and its gradient are zero.
    #[test]
    fn the_shape_with_tip_on_tip_lies_on_the_bound() {
        let bounds = Bounds::default().apart(0.0);
        for tenths in 3..20 {
            let middle = 0.1 * f64::from(tenths);
            let links = Links {
                middle,
                front: 1.0,
                back: 1.0,
            };
            let region = Region::new(&bounds, &links);
            for corner in [1.0, -1.0].map(|side| Vector2::repeat(side * (-0.5 * middle).acos())) {
                let at = Limit::all(&region, &corner, 0);
                let curved = at.iter().find(|limit| limit.curved).unwrap();
                assert!(curved.margin.abs() < 1e-7, "{middle}: {}", curved.margin);
                assert!((curved.normal.norm() - 1.0).abs() < 1e-12, "{middle}");
                assert!(curved.normal.dot(&corner) > 0.0, "{middle}");
            }
        }
    }
}
