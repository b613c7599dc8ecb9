//! Joint angles by the reflectors on the side links.

use calibrate::{End, FollowedPair, SideFollower, SideSighting};
use nalgebra::Vector2;
use pose_source::Frame;
use swimmer_files::{PointName, Reflector};

use super::{FilterOptions, JointAngle, PoseFilter, goes_by};

impl PoseFilter {
    /// Joint angles, if the pose of this frame is believed and the order is settled.
    pub(super) fn take_sides(&mut self, frame: &Frame, pair: &FollowedPair) {
        if self.doubtful.is_some() || self.estimate.is_none() || !self.order.is_known() {
            return;
        }
        let pose = self.measured(pair, self.order);
        let (Some(followers), Some(reflectors)) = (&mut self.sides, &self.options.reflectors.sides)
        else {
            return;
        };
        let sides = followers.iter_mut().zip(reflectors).zip(&mut self.joints);
        for ((follower, reflector), joint) in sides {
            let points = frame.markers.iter().map(|marker| SideSighting {
                named: goes_by(marker, &reflector.point),
                place: Vector2::new(marker.x_m, marker.y_m),
            });
            let points: Vec<SideSighting> = points.collect();
            if let Some(angle_rad) = follower.push(frame.stamp_s, &pose, &points) {
                *joint = Some(JointAngle {
                    time_s: frame.stamp_s,
                    angle_rad,
                });
            }
        }
    }
}

pub(super) fn side_followers(options: &FilterOptions) -> Option<[SideFollower; 2]> {
    let half = options.middle_m / 2.0;
    let [front, back] = options.reflectors.sides.as_ref()?;
    let follower = |end, reflector: &Reflector| {
        let has_name = matches!(reflector.point, PointName::Named(_));
        SideFollower::new(end, half, reflector.at, has_name)
    };
    Some([follower(End::Front, front), follower(End::Back, back)])
}
