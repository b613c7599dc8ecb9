//! The bounds of the joint angles as smooth functions that are positive inside, for the interior-point iteration.
//!
//! The two sets of crossing shapes (above and below the middle link) have a corner each, where tip touches tip. It is rounded on
//! the safe side by a soft minimum. The polish uses the sharp bound.

use nalgebra::{Matrix2, Vector2};
use swimmer_files::Bounds;
use swimmer_model::Links;

use crate::region::Level;

/// Largest number of margins: four sides of the box, and two for the links.
pub(crate) const MOST: usize = 6;

/// Region of the curve.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Barrier {
    max_angle: f64,
    /// Links with L = 1 and clearance over L, if links must not cross.
    links: Option<(Links<f64>, f64)>,
}

/// Sharpness of the rounded corner \[1/L\]; its depth is ln 4 over this.
const SHARPNESS: f64 = 400.0;

impl Barrier {
    /// Creates the barrier for `links` with L = 1. Without a bound on the angles, `horizon` \[rad\] limits them.
    pub(crate) fn new(bounds: &Bounds, links: Links<f64>, clearance: f64, horizon: f64) -> Self {
        Self {
            max_angle: bounds.max_angle.unwrap_or(horizon),
            links: bounds.no_overlap.then_some((links, clearance)),
        }
    }

    pub(crate) fn max_angle(&self) -> f64 {
        self.max_angle
    }

    /// Number of margins.
    pub(crate) fn count(&self) -> usize {
        if self.links.is_some() { MOST } else { 4 }
    }

    /// All margins at a shape; entries beyond [`Barrier::count`] are unused.
    pub(crate) fn margins(&self, phi: &Vector2<f64>) -> [Level; MOST] {
        let straight = |x: f64, y: f64| Level {
            value: self.max_angle - x * phi.x - y * phi.y,
            gradient: Vector2::new(-x, -y),
            hessian: Matrix2::zeros(),
        };
        let [above, below] = match &self.links {
            Some((links, clearance)) => [1.0, -1.0].map(|side| apart(links, *clearance, side, phi)),
            None => [straight(0.0, 0.0); 2],
        };
        [
            straight(1.0, 0.0),
            straight(-1.0, 0.0),
            straight(0.0, 1.0),
            straight(0.0, -1.0),
            above,
            below,
        ]
    }

    /// Smallest margin at a shape.
    pub(crate) fn least(&self, phi: &Vector2<f64>) -> f64 {
        let margins = self.margins(phi);
        margins
            .iter()
            .take(self.count())
            .map(|margin| margin.value)
            .fold(f64::INFINITY, f64::min)
    }
}

/// Minus the soft minimum of the four lengths that are all positive if the links cross on this side.
fn apart(links: &Links<f64>, clearance: f64, side: f64, phi: &Vector2<f64>) -> Level {
    let (sin1, cos1) = phi.x.sin_cos();
    let (sin2, cos2) = phi.y.sin_cos();
    let (sum_sin, sum_cos) = (phi.x + phi.y).sin_cos();
    let l0 = links.middle;
    // s₁ = l₀ sin φ₁, s₂ = l₀ sin φ₂ and reach = −l sin(φ₁ + φ₂) of each side link, times the side.
    let first = (
        side * l0 * sin1,
        Vector2::new(side * l0 * cos1, 0.0),
        Matrix2::new(-side * l0 * sin1, 0.0, 0.0, 0.0),
    );
    let second = (
        side * l0 * sin2,
        Vector2::new(0.0, side * l0 * cos2),
        Matrix2::new(0.0, 0.0, 0.0, -side * l0 * sin2),
    );
    let reach = |length: f64, over: &(f64, Vector2<f64>, Matrix2<f64>)| {
        (
            -side * length * sum_sin - over.0,
            Vector2::repeat(-side * length * sum_cos) - over.1,
            Matrix2::repeat(side * length * sum_sin) - over.2,
        )
    };
    let parts = [
        first,
        second,
        reach(links.front, &second),
        reach(links.back, &first),
    ];
    let least = parts
        .iter()
        .map(|part| part.0)
        .fold(f64::INFINITY, f64::min);
    let weights = parts.map(|part| (-SHARPNESS * (part.0 - least)).exp());
    let total: f64 = weights.iter().sum();
    // softmin = least − ln Σ exp(−k (g − least)) / k is never above the minimum; ln(parts) / k is subtracted so that the
    // margin is never too large.
    let soft = least - total.ln() / SHARPNESS;
    let mut gradient = Vector2::zeros();
    let mut hessian = Matrix2::zeros();
    for (part, weight) in parts.iter().zip(&weights) {
        let share = weight / total;
        gradient += part.1 * share;
        hessian += (part.2 - part.1 * part.1.transpose() * SHARPNESS) * share;
    }
    hessian += gradient * gradient.transpose() * SHARPNESS;
    let rounding = (parts.len() as f64).ln() / SHARPNESS;
    Level {
        value: -(soft + rounding) - clearance,
        gradient: -gradient,
        hessian: -hessian,
    }
}
