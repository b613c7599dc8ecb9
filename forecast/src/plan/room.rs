//! Whether a plan stays within its tank.

use nalgebra::Vector2;
use swimmer_model::{Gait as _, Model, Pose, trajectory};

use super::member::Nets;
use super::{Errand, Family, Step};
use crate::losses::tolerance;
use crate::path::Polyline;
use crate::tank::Tank;

/// Looks at the body a cycle.
const LOOKS: usize = 72;

/// The walls, and who swims between them.
pub(super) struct Room<'a> {
    model: &'a Model<f64>,
    tank: Option<Tank>,
    margin: f64,
}

impl<'a> Room<'a> {
    pub(super) fn new(model: &'a Model<f64>, errand: &Errand) -> Self {
        Self {
            model,
            tank: errand.tank,
            margin: errand.margin,
        }
    }

    /// Whether the body in this shape and pose stays clear of the walls.
    pub(super) fn fits(&self, pose: &Pose<f64>, phi: &Vector2<f64>) -> bool {
        let Some(tank) = &self.tank else { return true };
        let swimmer = self.model.swimmer();
        let inside = |point: &Vector2<f64>, radius: f64| {
            let at = pose.transform(point);
            at.x.abs() + radius + self.margin <= 0.5 * tank.length
                && at.y.abs() + radius + self.margin <= 0.5 * tank.width
        };
        let links = swimmer.links.outline(phi);
        links.iter().all(|point| inside(point, 0.0))
            && inside(&Vector2::zeros(), swimmer.sphere_radius)
    }

    /// Whether all of a plan does, from this pose at the common shape.
    pub(super) fn leaves(
        &self,
        family: &Family,
        begun: &Pose<f64>,
        nets: &Nets,
        steps: &[Step],
    ) -> bool {
        let Some(tank) = &self.tank else { return true };
        let mut pose = *begun;
        for step in steps {
            let net = nets.of(&step.member);
            let mut cycle: Vec<(Pose<f64>, Vector2<f64>)> = Vec::with_capacity(LOOKS + 1);
            trajectory(
                self.model,
                &step.member.of(family),
                &tolerance(),
                LOOKS,
                |point| {
                    cycle.push((point.pose, point.phi));
                },
            );
            let swimmer = self.model.swimmer();
            let sway = cycle.iter().map(|(pose, _)| pose.position().norm());
            let reach = sway.fold(0.0, f64::max)
                + swimmer.total_length().max(swimmer.sphere_radius)
                + self.margin;
            for _ in 0..step.cycles {
                let far = pose.x.abs() + reach < 0.5 * tank.length
                    && pose.y.abs() + reach < 0.5 * tank.width;
                if !far && !cycle.iter().all(|(at, phi)| self.fits(&(pose * *at), phi)) {
                    return false;
                }
                pose = pose * net;
            }
        }
        true
    }

    /// Whether the way that the servos take does, from the straight shape at this pose.
    pub(super) fn leaves_played(&self, from: &Pose<f64>, way: &Polyline) -> bool {
        if self.tank.is_none() {
            return true;
        }
        let mut inside = true;
        trajectory(self.model, way, &tolerance(), way.pieces(), |point| {
            inside = inside && self.fits(&(*from * point.pose), &point.phi);
        });
        inside
    }
}
