//! Positions of the side links' reflectors, as far as errors of them show in the angles.

use nalgebra::Vector2;
use swimmer_files::Reflectors;
use swimmer_model::{Pose, Swimmer};

/// Their places.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Sides {
    /// From the joints \[m\].
    pub(crate) reach: [f64; 2],
    /// Half of the middle link \[m\].
    pub(crate) half: f64,
}

impl Sides {
    pub(crate) fn of(reflectors: &Reflectors, swimmer: &Swimmer<f64>) -> Option<Self> {
        let sides = reflectors.sides.as_ref()?;
        Some(Self {
            reach: [&sides[0], &sides[1]].map(|side| side.at[0].hypot(side.at[1])),
            half: swimmer.links.middle / 2.0,
        })
    }

    /// The angle that was, where `measured` came out because the middle link's reflectors sit off by `marker`, lengths come out
    /// by 1 + `scale`, and the side reflectors' own directions are off by `links`: to first order.
    pub(crate) fn corrected(
        &self,
        measured: &Vector2<f64>,
        marker: Pose<f64>,
        scale: f64,
        links: Vector2<f64>,
    ) -> Vector2<f64> {
        // By how much the joints are taken to be off, along and across.
        let along = scale * self.half;
        let across = marker.theta * self.half;
        let [front, back] = [
            Vector2::new(marker.x - along, marker.y + across),
            Vector2::new(marker.x + along, marker.y - across),
        ];
        let (sin, cos) = measured.x.sin_cos();
        let front = (cos * front.y - sin * front.x) / self.reach[0];
        let (sin, cos) = measured.y.sin_cos();
        let back = (cos * back.y + sin * back.x) / self.reach[1];
        measured + links + Vector2::new(front + marker.theta, back - marker.theta)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn errors_of_places_show_in_the_angles_as_they_should() {
        let sides = Sides {
            reach: [0.1, 0.08],
            half: 0.035,
        };
        let truth = Vector2::new(0.7, -0.4);
        let marker = Pose::new(4e-4, -3e-4, 2e-3_f64);
        let (scale, links) = (1e-3, Vector2::new(3e-3, -2e-3));
        // The link at the origin, heading along x; what is taken for it is `marker`, and lengths are too long by `scale`.
        let reflector = |joint: f64, direction: f64, reach: f64| {
            let at = Vector2::new(joint + reach * direction.cos(), reach * direction.sin());
            at * (1.0 + scale)
        };
        let joint = |along: f64| {
            let (sin, cos) = marker.theta.sin_cos();
            marker.position() * (1.0 + scale) + Vector2::new(cos, sin) * along
        };
        let direction = |reflector: Vector2<f64>, joint: Vector2<f64>| {
            let d = reflector - joint;
            d.y.atan2(d.x)
        };
        let pi = std::f64::consts::PI;
        let front = reflector(sides.half, truth.x - links.x, sides.reach[0]);
        let back = reflector(-sides.half, pi - truth.y + links.y, sides.reach[1]);
        let measured = Vector2::new(
            direction(front, joint(sides.half)) - marker.theta,
            marker.theta + pi - direction(back, joint(-sides.half)),
        );
        let measured = measured.map(|angle| (angle + pi).rem_euclid(2.0 * pi) - pi);
        let corrected = sides.corrected(&measured, marker, scale, links);
        assert!((measured - truth).norm() > 4e-3, "{measured}");
        assert!((corrected - truth).norm() < 6e-5, "{corrected} {truth}");
    }
}
