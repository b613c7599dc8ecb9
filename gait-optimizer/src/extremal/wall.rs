//! Bounds as curves that an extremal follows, and the set of bounds of a full cycle.

use nalgebra::Vector2;
use swimmer_files::Bounds;
use swimmer_model::Links;

use crate::region::{Bound, Level, Piece, Region};

impl Bound {
    /// Curvature of the bound: dψ per arc length of a curve tangent to it.
    pub(crate) fn turning(&self, phi: &Vector2<f64>, e: &Vector2<f64>) -> f64 {
        match self {
            Self::Straight(_) => 0.0,
            Self::Clearance(_) => {
                let level = self.level(phi);
                -e.dot(&(level.hessian * e)) / level.gradient.dot(&Vector2::new(-e.y, e.x))
            }
        }
    }

    /// [`Bound::turning`] and its derivatives with respect to φ₁, φ₂, ψ.
    ///
    /// Derivatives of the Hessian are central differences. They affect only the convergence of Newton's method, not its limit.
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

    /// Direction of the tangent nearest to ψ.
    pub(crate) fn direction_near(&self, phi: &Vector2<f64>, psi: f64) -> f64 {
        let gradient = self.gradient(phi);
        let along = gradient.y.atan2(gradient.x) + std::f64::consts::FRAC_PI_2;
        let halves: f64 = (psi - along) / std::f64::consts::PI;
        along + halves.round() * std::f64::consts::PI
    }
}

/// Distance of links that may touch, as a share of the side links, so that samples along the bound do not cross by rounding.
const HAIR: f64 = 1e-8;

/// Bounds of a full cycle for a swimmer with these links \[m\]. Bounds that are defined for quarters only (lower bound, sector) are
/// omitted.
pub(crate) fn walls(bounds: &Bounds, links: &Links<f64>) -> Region {
    let wider = |length: f64| length * (1.0 + if bounds.clearance > 0.0 { 0.0 } else { HAIR });
    let of_cycles = Bounds {
        min_angle: None,
        sector: false,
        ..*bounds
    };
    let links = Links {
        front: wider(links.front),
        back: wider(links.back),
        ..*links
    };
    Region::new(&of_cycles, &links)
}

impl Region {
    /// Bound with the smallest margin at a shape, and its margin. Returns `None` without bounds.
    pub(crate) fn nearest(&self, phi: &Vector2<f64>) -> Option<(Bound, f64)> {
        // The bound for a tip at the other side link's joint depends on one angle only and is straight.
        let at_joint = |bound: &Bound| matches!(bound.piece(phi), Some(Piece::TipToJoint(_)));
        let bounds = self.bounds().filter(|bound| !at_joint(bound));
        let depths = bounds.map(|bound| (bound.held_at(phi), -bound.margin(phi)));
        depths.max_by(|a, b| a.1.total_cmp(&b.1))
    }

    /// Bound of this region that corresponds to a bound of another region.
    pub(crate) fn like(&self, other: &Bound) -> Option<Bound> {
        self.bounds().find_map(|own| match (own, other) {
            (Bound::Straight(a), Bound::Straight(b)) => (a.normal == b.normal).then_some(own),
            (Bound::Clearance(a), Bound::Clearance(b)) => {
                Some(Bound::Clearance(a.held_to(b.held?)))
            }
            _ => None,
        })
    }
}
