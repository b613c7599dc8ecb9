//! A rigid body of the source: its position and orientation are the pose of the middle link.

use nalgebra::{Quaternion, UnitQuaternion, Vector2, Vector3};
use pose_source::Frame;
use swimmer_files::RigidBody;
use swimmer_model::Pose;

use super::estimate::Variances;
use super::order::Order;
use super::{CONFIRMED, Doubtful, FilterEvent, PoseFilter, is_called};

impl PoseFilter {
    /// Takes the rigid body of a frame, if the frame has it.
    pub(super) fn take_body(&mut self, frame: &Frame) -> Option<FilterEvent> {
        let named = self.options.reflectors.body.as_ref()?;
        let mut bodies = frame.bodies.iter();
        let body = bodies.find(|body| {
            body.name
                .as_ref()
                .is_some_and(|name| is_called(name, &named.name))
        })?;
        let pose = pose_of(named, body)?;
        let time_s = frame.stamp_s;
        self.counts.both += 1;
        let variances = self.body_variances();
        let estimate = self.estimate.map(|estimate| estimate.after(time_s));
        if let Some(estimate) = estimate.filter(|estimate| !self.jumps(estimate, &pose)) {
            self.doubtful = None;
            self.seen_s = Some(time_s);
            self.estimate = Some(estimate.updated(&pose, variances));
            return None;
        }
        let frames = self.doubtful.map_or(0, |doubtful| doubtful.frames) + 1;
        let order = Order::settled(false);
        self.doubtful = Some(Doubtful { order, frames });
        if frames < CONFIRMED {
            return None;
        }
        self.doubtful = None;
        if let Some(estimate) = estimate {
            return Some(self.jump(&estimate, &pose, variances));
        }
        self.begin(time_s, &pose, variances);
        None
    }

    /// Variances of a solved pose: those of two points at the reflectors' distance, whose noise is the option's.
    fn body_variances(&self) -> Variances {
        let noise = self.options.noise_m.powi(2);
        Variances {
            position: noise / 2.0,
            heading: 2.0 * noise / self.distance_m.powi(2),
        }
    }
}

/// The middle link's pose. Axes of the body are those of the tank while the body is not turned. Returns `None` if the named axis is
/// vertical.
fn pose_of(named: &RigidBody, body: &pose_source::RigidBody) -> Option<Pose<f64>> {
    let [x, y, z, w] = body.quaternion;
    let turn = UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)?;
    let (axis, sign) = named.axis.unwrap_or((0, 1.0));
    if axis > 2 {
        return None;
    }
    let ahead = (turn * Vector3::ith(axis, sign)).xy().try_normalize(0.1)?;
    let heading = ahead.y.atan2(ahead.x) + named.heading_rad;
    let [x, y, _] = body.position;
    let pivot = Pose::new(x, y, heading);
    // `named.at` is the place of the pivot on the link.
    let centre = pivot.transform(&-Vector2::from(named.at));
    Some(Pose::new(centre.x, centre.y, heading))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_body_beside_the_centre_gives_the_centre() {
        let truth = Pose::new(0.2, -0.1, 0.7);
        let at = [0.02, 0.01];
        let pivot = truth.transform(&Vector2::from(at));
        let half = (truth.theta - 0.3) / 2.0;
        let body = pose_source::RigidBody {
            id: 1,
            name: Some("robot".to_owned()),
            position: [pivot.x, pivot.y, 0.05],
            quaternion: [0.0, 0.0, half.sin(), half.cos()],
        };
        let named = RigidBody {
            at,
            heading_rad: 0.3,
            ..RigidBody::named("robot".to_owned())
        };
        let pose = pose_of(&named, &body).unwrap();
        assert!((pose.position() - truth.position()).norm() < 1e-12);
        assert!((pose.theta - truth.theta).abs() < 1e-12);
        // The y axis is a quarter turn ahead of x; the vertical axis has no heading.
        let across = RigidBody {
            axis: Some((1, -1.0)),
            heading_rad: 0.3 + std::f64::consts::FRAC_PI_2,
            ..named.clone()
        };
        assert!((pose_of(&across, &body).unwrap().theta - truth.theta).abs() < 1e-12);
        let vertical = RigidBody {
            axis: Some((2, 1.0)),
            ..named
        };
        assert_eq!(pose_of(&vertical, &body), None);
    }
}
