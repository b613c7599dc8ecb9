//! The shapes with side links apart, by brute force: distances of segments, and the border by bisection along rays.

use nalgebra::Vector2;
use swimmer_model::Links;

#[derive(Debug, Clone, Copy)]
pub(crate) struct Apart {
    links: Links<f64>,
    clearance: f64,
}

impl Apart {
    pub(crate) fn new(links: Links<f64>, clearance: f64) -> Self {
        Self { links, clearance }
    }

    /// `true` if the side links do not cross and keep the clearance.
    pub(crate) fn allows(&self, phi: &Vector2<f64>) -> bool {
        self.links.overlap(phi) <= 1e-12 && self.distance(phi) >= self.clearance - 1e-12
    }

    /// The first shape in this direction, seen from the straight one, beyond which links are not apart.
    pub(crate) fn border(&self, direction: f64) -> Vector2<f64> {
        let ray = Vector2::new(direction.cos(), direction.sin());
        // No joint beyond a half turn.
        let (mut low, mut high) = (0.5, std::f64::consts::PI / ray.amax());
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            let phi = ray * middle;
            if self.links.overlap(&phi) <= 0.0 && self.distance(&phi) >= self.clearance {
                low = middle;
            } else {
                high = middle;
            }
        }
        ray * low
    }

    fn distance(&self, phi: &Vector2<f64>) -> f64 {
        let front = Vector2::new(0.5 * self.links.middle, 0.0);
        let back = -front;
        let front_tip = front + Vector2::new(phi.x.cos(), phi.x.sin()) * self.links.front;
        let back_tip = back + Vector2::new(-phi.y.cos(), phi.y.sin()) * self.links.back;
        let from = |point: Vector2<f64>, a: Vector2<f64>, b: Vector2<f64>| {
            let along = b - a;
            let share = ((point - a).dot(&along) / along.norm_squared()).clamp(0.0, 1.0);
            (a + along * share - point).norm()
        };
        from(front_tip, back, back_tip)
            .min(from(back_tip, front, front_tip))
            .min(from(front, back, back_tip))
            .min(from(back, front, front_tip))
    }
}
