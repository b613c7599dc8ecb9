//! What keeps a node inside: margins c(Φ) ≥ 0 with their derivatives, and the logarithmic barrier on them.

use gait_optimizer::region::{Bound, Level, Region};
use nalgebra::{Matrix2, Vector2};
use swimmer_files::{ArcKind, Bounds};
use swimmer_model::Links;

/// A bound at every point of the mesh.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Wall(Bound);

/// What the walls of a point add to gradient and Hessian of the barrier problem.
#[derive(Debug, Clone, Copy)]
pub(crate) struct WallTerm {
    pub(crate) gradient: Vector2<f64>,
    pub(crate) hessian: Matrix2<f64>,
}

impl Wall {
    /// All bounds of a swimmer with these links.
    pub(crate) fn all(bounds: &Bounds, links: &Links<f64>) -> Vec<Self> {
        Region::new(bounds, links).bounds().map(Self).collect()
    }

    pub(crate) fn kind(&self) -> ArcKind {
        self.0.kind()
    }

    pub(crate) fn value(&self, phi: &Vector2<f64>) -> f64 {
        self.0.smooth_level(phi).value
    }

    /// c, its gradient and its second derivatives at a shape.
    pub(crate) fn margin(&self, phi: &Vector2<f64>) -> Level {
        self.0.smooth_level(phi)
    }

    /// Moves a shape, near enough, to where its margin is `wanted`.
    pub(crate) fn draw(&self, phi: &mut Vector2<f64>, wanted: f64) {
        for _ in 0..3 {
            let margin = self.margin(phi);
            let step = margin.gradient * ((wanted - margin.value) / margin.gradient.norm_squared());
            if !step.norm().is_finite() {
                return;
            }
            *phi += step;
        }
    }
}

/// The walls of one point, with their multiplier densities and the point's weight.
pub(crate) fn wall_term(
    walls: &[Wall],
    multipliers: &[f64],
    phi: &Vector2<f64>,
    barrier: f64,
    weight: f64,
) -> WallTerm {
    let (mut gradient, mut hessian) = (Vector2::zeros(), Matrix2::zeros());
    for (wall, multiplier) in walls.iter().zip(multipliers) {
        let Level {
            value,
            gradient: slope,
            hessian: curvature,
        } = wall.margin(phi);
        gradient -= slope * (weight * barrier / value);
        hessian += slope * slope.transpose() * (weight * multiplier / value)
            - curvature * (weight * multiplier);
    }
    WallTerm { gradient, hessian }
}
