//! Pose filter: frames of the cameras in, pose of the middle link out. Sans-IO and incremental.
//!
//! 1. `calibrate`'s [`PairFollower`] picks the two reflectors out of all points of a frame, as it does for recordings: by their
//!    distance and by constant velocity. Names are hints.
//! 2. Names vote on which of the two is the front, until the vote is clear. After a gap the heading decides if it can.
//! 3. A Kalman filter for each coordinate takes the measured pose. If one reflector is seen alone, it takes the position that the
//!    predicted heading gives.
//! 4. [`PoseFilter::pose_now`] extrapolates over the latency: the quickest of recent frames matches camera clock and host clock.
//!
//! With a rigid body in [`Reflectors`](swimmer_files::Reflectors), its position and orientation are the measured pose, and steps 1 and 2 fall away.
//!
//! A pose that jumps is believed after a few frames that agree, and reported as [`FilterEvent::Jumped`].

mod body;
mod estimate;
mod kinematics;
mod lone;
mod options;
mod order;
mod pairs;
mod sides;

use std::f64::consts::{FRAC_PI_2, PI};

use calibrate::{PairFollower, SideFollower, Sighting, is_called};
use nalgebra::Vector2;
use pose_source::{Frame, Marker};
use swimmer_files::{PointName, Reflectors};
use swimmer_model::wrapped_angle;

use crate::delays::Delays;
use crate::pose::Pose;
use estimate::{Estimate, Variances};
pub use options::{FilterCounts, FilterEvent, FilterOptions};
use order::Order;
use sides::side_followers;

/// A stamp that goes back by more means that the camera clock was set \[s\].
const CLOCK_SET_S: f64 = 1.0;
/// Frames in a row that must agree before a pose that jumped is believed.
const CONFIRMED: u32 = 5;
/// A pose jumps if it is farther than this from the prediction \[m\],
const JUMP_M: f64 = 0.02;
/// and farther than this in standard deviations.
const JUMP_SIGMAS: f64 = 6.0;

/// A pose that jumped and is not yet confirmed.
#[derive(Debug, Clone, Copy)]
struct Doubtful {
    order: Order,
    frames: u32,
}

/// A joint angle that a reflector on a side link shows.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct JointAngle {
    /// Time of the exposure \[s\].
    pub time_s: f64,
    /// The angle, unwrapped \[rad\].
    pub angle_rad: f64,
}

/// Estimates the pose of the middle link from frames.
#[derive(Debug)]
pub struct PoseFilter {
    options: FilterOptions,
    follower: PairFollower,
    /// Followers of the reflectors on the front and the back side link.
    sides: Option<[SideFollower; 2]>,
    joints: [Option<JointAngle>; 2],
    distance_m: f64,
    order: Order,
    estimate: Option<Estimate>,
    doubtful: Option<Doubtful>,
    /// The last frame with a reflector \[s\].
    seen_s: Option<f64>,
    last_stamp_s: Option<f64>,
    /// Frame of the last pose that was taken \[s\].
    taken_s: Option<f64>,
    delays: Delays,
    /// Variance of a measured coordinate \[m²\].
    noise: f64,
    counts: FilterCounts,
}

impl PoseFilter {
    /// A filter that has seen nothing; `None` if both reflectors are at the same place.
    pub fn new(options: FilterOptions) -> Option<Self> {
        let [front, back] = [&options.reflectors.front, &options.reflectors.back];
        let distance_m = (front.at[0] - back.at[0]).hypot(front.at[1] - back.at[1]);
        Some(Self {
            follower: PairFollower::new(distance_m)?,
            sides: side_followers(&options),
            joints: [None; 2],
            distance_m,
            order: Order::open(),
            estimate: None,
            doubtful: None,
            seen_s: None,
            last_stamp_s: None,
            taken_s: None,
            delays: Delays::default(),
            noise: options.noise_m.powi(2),
            counts: FilterCounts::default(),
            options,
        })
    }

    /// Counts so far.
    pub fn counts(&self) -> FilterCounts {
        self.counts
    }

    /// Returns `true` while the robot is found: a reflector was seen within the longest blank.
    pub fn is_tracked(&self) -> bool {
        self.estimate.is_some()
    }

    /// Returns `true` if a rigid body, the names or the heading have settled which end is the front.
    pub fn knows_front(&self) -> bool {
        if self.options.reflectors.body.is_some() {
            return self.is_tracked();
        }
        self.is_tracked() && self.has_names() && self.order.is_known()
    }

    /// Pose at the last frame; `None` if the robot is not found.
    pub fn pose(&self) -> Option<Pose> {
        self.estimate.map(|estimate| estimate.pose())
    }

    /// Pose at a time on the camera clock, extrapolated if it is later than the last frame.
    pub fn pose_at(&self, camera_s: f64) -> Option<Pose> {
        Some(self.estimate?.after(camera_s).pose())
    }

    /// Pose at a time on the host clock: extrapolated over the latency. Its time is on the camera clock.
    pub fn pose_now(&self, host_s: f64) -> Option<Pose> {
        self.pose_at(self.camera_time(host_s)?)
    }

    /// The camera clock at a time on the host clock; `None` before the first frame.
    pub fn camera_time(&self, host_s: f64) -> Option<f64> {
        self.delays.camera_time(host_s)
    }

    /// Pose at the last frame with a reflector, once per frame, with its time on the host clock. `None` while the front is unknown.
    pub fn take_pose(&mut self, host_s: f64) -> Option<Pose> {
        if !self.knows_front() {
            return None;
        }
        let ahead_s = self.camera_time(host_s)? - host_s;
        let time_s = self.seen_s?;
        if self.taken_s.is_some_and(|taken_s| taken_s >= time_s) {
            return None;
        }
        let pose = self
            .estimate
            .filter(|estimate| estimate.time_s >= time_s)?
            .pose();
        self.taken_s = Some(time_s);
        Some(Pose {
            time_s: pose.time_s - ahead_s,
            ..pose
        })
    }

    /// Time since a reflector was last exposed \[s\], by the host clock; `None` if none was seen yet.
    pub fn age_s(&self, host_s: f64) -> Option<f64> {
        Some(self.camera_time(host_s)? - self.seen_s?)
    }

    /// Velocity of the centre \[m/s\] and turning rate \[rad/s\] at the last frame.
    pub fn velocity(&self) -> Option<(Vector2<f64>, f64)> {
        let estimate = self.estimate?;
        let linear = Vector2::new(estimate.x.velocity(), estimate.y.velocity());
        Some((linear, estimate.heading.velocity()))
    }

    /// Front and back joint angle when they were last seen; `None` for a side link without a reflector.
    pub fn joints(&self) -> [Option<JointAngle>; 2] {
        self.joints
    }

    /// Exchanges front and back, for reflectors without names: the caller knows from the direction of travel.
    pub fn turn_round(&mut self) {
        self.order = Order::settled(!self.order.exchanged);
        self.estimate = None;
    }

    /// Settles which end is the front by the heading, which the caller knows within 90°: for reflectors without names. Returns
    /// `false` if the robot is not found yet.
    pub fn face(&mut self, heading_rad: f64) -> bool {
        let Some(estimate) = self.estimate else {
            return false;
        };
        let pose = estimate.pose().placed();
        let turn = wrapped_angle(pose.theta - heading_rad).abs() > FRAC_PI_2;
        self.order = Order::settled(self.order.exchanged != turn);
        if turn {
            let Reflectors { front, back, .. } = &self.options.reflectors;
            let centre = pose.transform(&(Vector2::from(front.at) + Vector2::from(back.at)));
            let heading = wrapped_angle(pose.theta + PI);
            let pose = swimmer_model::Pose::new(centre.x, centre.y, heading);
            self.begin(estimate.time_s, &pose, self.variances());
        }
        true
    }

    /// Takes a frame.
    pub fn push(&mut self, frame: &Frame) -> Option<FilterEvent> {
        self.counts.frames += 1;
        let time_s = frame.stamp_s;
        if let Some(last_s) = self.last_stamp_s.filter(|last| time_s <= *last) {
            if last_s - time_s <= CLOCK_SET_S {
                self.counts.out_of_order += 1;
                return None;
            }
            let fresh = Self::new(self.options.clone())?;
            let counts = self.counts;
            *self = Self { counts, ..fresh };
            self.counts.frames -= 1;
            self.push(frame);
            return Some(FilterEvent::ClockSet);
        }
        self.last_stamp_s = Some(time_s);
        let latency_s = frame.latency_s.unwrap_or(self.options.latency_s);
        self.delays.push(time_s, frame.received_s, latency_s);
        let was_found = self.estimate.is_some();
        let event = if self.options.reflectors.body.is_some() {
            self.take_body(frame)
        } else {
            self.take_markers(frame)
        };
        let blank_s = self.seen_s.map_or(0.0, |seen_s| time_s - seen_s);
        if self.estimate.is_some() && blank_s > self.options.longest_blank_s {
            self.estimate = None;
            self.doubtful = None;
            return Some(FilterEvent::Lost);
        }
        event.or((!was_found && self.estimate.is_some()).then_some(FilterEvent::Found))
    }

    /// Takes the points of a frame.
    fn take_markers(&mut self, frame: &Frame) -> Option<FilterEvent> {
        let time_s = frame.stamp_s;
        let sightings: Vec<Sighting> = frame.markers.iter().map(|m| self.sighting(m)).collect();
        let Some(pair) = self.follower.push(time_s, &sightings) else {
            self.take_lone(time_s, &sightings);
            return None;
        };
        let event = self.take_pair(time_s, &pair);
        self.take_sides(frame, &pair);
        event
    }

    /// Returns `true` if a measured pose is too far from the estimate to continue it.
    fn jumps(&self, estimate: &Estimate, pose: &swimmer_model::Pose<f64>) -> bool {
        let [off, turned] = estimate.off(pose);
        let predicted = estimate.pose();
        let limit = |least: f64, sigma: f64| least.max(JUMP_SIGMAS * sigma);
        off > limit(JUMP_M, predicted.sigma_position_m)
            || turned.abs() > limit(JUMP_M / self.distance_m, predicted.sigma_heading_rad)
    }

    /// Begins anew at a pose that jumped.
    fn jump(
        &mut self,
        before: &Estimate,
        pose: &swimmer_model::Pose<f64>,
        variances: Variances,
    ) -> FilterEvent {
        self.doubtful = None;
        self.begin(before.time_s, pose, variances);
        let [moved_m, turned_rad] = before.off(pose);
        FilterEvent::Jumped {
            moved_m,
            turned_rad,
        }
    }

    fn begin(&mut self, time_s: f64, pose: &swimmer_model::Pose<f64>, variances: Variances) {
        let (period_s, distance_m) = (self.options.period_s, self.distance_m);
        self.seen_s = Some(time_s);
        self.estimate = Some(Estimate::at(time_s, pose, variances, period_s, distance_m));
    }
}

/// Returns `true` if a marker goes by a name.
fn goes_by(marker: &Marker, point: &PointName) -> bool {
    match (point, &marker.name) {
        (PointName::Named(wanted), Some(name)) => is_called(name, wanted),
        _ => false,
    }
}
