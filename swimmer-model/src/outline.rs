//! Outline of the body at a shape, for drawings and distances to walls.

use crate::{Links, Scalar};
use nalgebra::Vector2;

impl<T: Scalar> Links<T> {
    /// The body at shape Φ as a chain of four points \[m\], in the middle link's frame: tip of the back link, back joint, front
    /// joint, tip of the front link.
    pub fn outline(&self, phi: &Vector2<T>) -> [Vector2<T>; 4] {
        let half = self.middle * T::from_f64(0.5);
        let (sin1, cos1) = phi.x.sin_cos();
        let (sin2, cos2) = phi.y.sin_cos();
        [
            Vector2::new(-half - self.back * cos2, self.back * sin2),
            Vector2::new(-half, T::zero()),
            Vector2::new(half, T::zero()),
            Vector2::new(half + self.front * cos1, self.front * sin1),
        ]
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Swimmer;

    #[test]
    fn links_keep_their_lengths_and_positive_angles_lift_both_tips() {
        let links = Swimmer::<f64>::robot().links;
        for phi in [
            Vector2::new(0.0, 0.0),
            Vector2::new(1.0, 0.3),
            Vector2::new(-2.0, 2.7),
        ] {
            let [back_tip, back, front, front_tip] = links.outline(&phi);
            let lengths =
                [front_tip - front, front - back, back - back_tip].map(|link| link.norm());
            for (length, expected) in lengths.iter().zip([links.front, links.middle, links.back]) {
                assert!((length - expected).abs() < 1e-15, "{lengths:?}");
            }
            assert!(front_tip.y * phi.x.sin() >= 0.0 && back_tip.y * phi.y.sin() >= 0.0);
        }
    }

    /// The model reports crossing links exactly if the outline crosses itself.
    #[test]
    fn the_outline_crosses_where_the_links_do() {
        let links = Swimmer::<f64>::robot().links;
        let side = |o: Vector2<f64>, p: Vector2<f64>, q: Vector2<f64>| (p - o).perp(&(q - o));
        for i in 0..100 {
            let phi = Vector2::new(0.061 * f64::from(i) - 3.0, 2.9 - 0.037 * f64::from(i));
            let [a, b, c, d] = links.outline(&phi);
            let crosses =
                side(a, b, c) * side(a, b, d) < 0.0 && side(c, d, a) * side(c, d, b) < 0.0;
            assert_eq!(crosses, links.cross(&phi), "{phi}");
        }
    }
}
