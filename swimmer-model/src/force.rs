//! Distribution of the fluid's force along the links.

use crate::{Link, Model, Scalar};
use nalgebra::Vector2;

/// Link in the middle link's frame with the fluid's force per length, which is linear between the ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkForce<T> {
    /// Ends of the link \[m\].
    pub ends: [Vector2<T>; 2],
    /// Force per length over μ at those ends \[m/s\].
    pub density: [Vector2<T>; 2],
}

impl<T: Scalar> Model<T> {
    /// Force of the fluid on the back, middle and front link at shape Φ with joint rates Φ̇ \[rad/s\], by resistive force theory:
    /// −c_t along the link and −c_n across it, times the local velocity. The force on the sphere is not included. Returns `None`
    /// outside a viscous fluid.
    ///
    /// ```
    /// use nalgebra::Vector2;
    /// use swimmer_model::{Model, Swimmer};
    ///
    /// let model = Model::new(&Swimmer::<f64>::purcell())?;
    /// let links = model.link_forces(&Vector2::new(0.5, -0.3), &Vector2::new(1.0, 0.0)).expect("a viscous fluid");
    /// let total: f64 = links.iter().map(|link| 0.5 * (link.density[0].x + link.density[1].x)).sum();
    /// assert!(total.abs() < 1e-12, "links of length 1 without a sphere: no net force");
    /// # Ok::<(), swimmer_model::InvalidSwimmer>(())
    /// ```
    pub fn link_forces(&self, phi: &Vector2<T>, rate: &Vector2<T>) -> Option<[LinkForce<T>; 3]> {
        let swimmer = self.swimmer();
        if !swimmer.is_viscous() {
            return None;
        }
        let links = &swimmer.links;
        let body = self.local_connection(phi) * rate;
        let outline = links.outline(phi);
        let carried =
            |point: &Vector2<T>| Vector2::new(body.x - body.z * point.y, body.y + body.z * point.x);
        let (sin1, cos1) = phi.x.sin_cos();
        let (sin2, cos2) = phi.y.sin_cos();
        // Velocity that the joint rates add at the tips. The joints themselves move with the middle link.
        let turned = [
            Vector2::new(sin2, cos2) * (links.back * rate.y),
            Vector2::zeros(),
            Vector2::zeros(),
            Vector2::new(-sin1, cos1) * (links.front * rate.x),
        ];
        let along = [
            Vector2::new(cos2, -sin2),
            Vector2::new(T::one(), T::zero()),
            Vector2::new(cos1, sin1),
        ];
        let order = [Link::Back, Link::Middle, Link::Front];
        Some(core::array::from_fn(|link| {
            let tangential = swimmer.tangential_drag_of(order[link]);
            let normal = swimmer.chi_of(order[link]) * tangential;
            let density = |end: usize| {
                let velocity = carried(&outline[end]) + turned[end];
                let slip = along[link] * along[link].dot(&velocity);
                slip * (normal - tangential) - velocity * normal
            };
            LinkForce {
                ends: [outline[link], outline[link + 1]],
                density: [density(link), density(link + 1)],
            }
        }))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Swimmer;
    use core::f64::consts::PI;

    /// The moment of a link's force about a point, counter-clockwise.
    fn moment(link: &LinkForce<f64>, about: &Vector2<f64>) -> f64 {
        let [a, b] = link.ends.map(|end| end - about);
        let [f, g] = link.density;
        // Simpson's rule is exact for the product of two straight lines.
        let middle = (a + b).perp(&(f + g)) * 0.25;
        (a.perp(&f) + 4.0 * middle + b.perp(&g)) * (b - a).norm() / 6.0
    }

    /// The torque of each servo, from the balance of its side link about the joint and without W, equals W Φ̇.
    #[test]
    fn the_torques_of_the_joints_are_w_times_their_rates() {
        let mut uneven = Swimmer::<f64>::robot();
        uneven.links.front = 0.09;
        for swimmer in [Swimmer::purcell(), Swimmer::robot(), uneven] {
            let model = Model::new(&swimmer).unwrap();
            for (phi, rate) in [
                (Vector2::new(0.9, -1.4), Vector2::new(0.7, 1.3)),
                (Vector2::new(-2.1, -0.3), Vector2::new(-0.2, 0.9)),
                (Vector2::new(0.0, 2.6), Vector2::new(1.1, 0.0)),
            ] {
                let [back, _, front] = model.link_forces(&phi, &rate).unwrap();
                // φ₁ turns the front link counter-clockwise, φ₂ the back link clockwise.
                let torques = Vector2::new(
                    -moment(&front, &front.ends[0]),
                    moment(&back, &back.ends[1]),
                );
                let by_power = model.power_matrix(&phi) * rate;
                let off = (torques - by_power).norm();
                assert!(
                    off < 1e-13 * torques.norm().max(1e-3),
                    "{torques} {by_power}"
                );
            }
        }
    }

    /// The forces and torques of links and sphere add up to zero.
    #[test]
    fn forces_and_torques_balance() {
        let (phi, rate) = (Vector2::new(0.9, -1.4), Vector2::new(0.7, 1.3));
        for swimmer in [Swimmer::<f64>::purcell(), Swimmer::robot()] {
            let model = Model::new(&swimmer).unwrap();
            let body = model.local_connection(&phi) * rate;
            let drag = 6.0 * PI * swimmer.sphere_radius;
            let mut force = Vector2::new(body.x, body.y) * -drag;
            let mut torque = -8.0 * PI * swimmer.sphere_radius.powi(3) * body.z;
            for link in model.link_forces(&phi, &rate).unwrap() {
                let [a, b] = link.ends;
                let [f, g] = link.density;
                force += (f + g) * (0.5 * (b - a).norm());
                torque += moment(&link, &Vector2::zeros());
            }
            assert!(force.norm() < 1e-13 * drag.max(1.0), "{force}");
            assert!(torque.abs() < 1e-13, "{torque}");
        }
    }
}
