//! Pose filter: frames of the cameras in, pose of the middle link out. Sans-IO and incremental.
//!
//! 1. `calibrate`'s [`PairFollower`] picks the two reflectors out of all points of a frame, as it does for recordings: by their
//!    distance and by constant velocity. Names are hints.
//! 2. Names vote on which of the two is the front, until the vote is clear. After a gap the heading decides if it can.
//! 3. A Kalman filter for each coordinate takes the measured pose. If one reflector is seen alone, it takes the position that the
//!    predicted heading gives.
//! 4. [`PoseFilter::pose_now`] extrapolates over the latency: the quickest of recent frames matches camera clock and host clock.
//!
//! A pose that jumps is believed after a few frames that agree, and reported as [`FilterEvent::Jumped`].

mod delays;
mod kinematics;
mod order;

use std::f64::consts::{FRAC_PI_2, TAU};

use calibrate::{
    End, FollowedPair, PairFollower, SideFollower, SideSighting, Sighting, pose_of_pair,
};
use nalgebra::{Vector2, Vector3};
use pose_source::{Frame, Marker};
use swimmer_files::{PointName, Reflector, Reflectors};
use swimmer_model::wrapped_angle;

use crate::pose::Pose;
use delays::Delays;
use kinematics::{Agility, Coordinate};
use order::Order;

/// A stamp that goes back by more means that the camera clock was set \[s\].
const CLOCK_SET_S: f64 = 1.0;
/// Frames in a row that must agree before a pose that jumped is believed.
const CONFIRMED: u32 = 5;
/// A pose jumps if it is farther than this from the prediction \[m\],
const JUMP_M: f64 = 0.02;
/// and than so many standard deviations.
const JUMP_SIGMAS: f64 = 6.0;
/// A lone point within so many standard deviations of where a reflector should be is the reflector.
const LONE_SIGMAS: f64 = 4.0;
/// Least noise of a point \[m\]: rounding of a stream.
const LEAST_NOISE_M: f64 = 2e-5;
/// Weight of a frame in the running estimate of the noise.
const NOISE_WEIGHT: f64 = 0.01;
/// Heading and position swing by so much within a cycle: radians, and shares of the reflectors' distance.
const SWING: (f64, f64) = (0.5, 0.4);

/// Options of the pose filter.
#[derive(Debug, Clone)]
pub struct FilterOptions {
    /// Names of the reflectors, and their places on the middle link.
    pub reflectors: Reflectors,
    /// Length of the middle link \[m\]: its ends are the joints.
    pub middle_m: f64,
    /// Period of the quickest gait that will be swum \[s\]: sets how fast the motion may change.
    pub period_s: f64,
    /// Delay between exposure and transmission \[s\], if the source does not state it.
    pub latency_s: f64,
    /// Standard deviation of a measured coordinate \[m\], at the beginning; later it is estimated.
    pub noise_m: f64,
    /// Longest time without a reflector before the robot is lost \[s\].
    pub longest_blank_s: f64,
}

impl FilterOptions {
    /// For these reflectors on a middle link of this length \[m\]: a period of 4 s, no latency, 0.3 mm, lost after 1 s.
    pub fn new(reflectors: Reflectors, middle_m: f64) -> Self {
        Self {
            reflectors,
            middle_m,
            period_s: 4.0,
            latency_s: 0.0,
            noise_m: 3e-4,
            longest_blank_s: 1.0,
        }
    }
}

/// Change of the tracking state that a caller must handle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum FilterEvent {
    /// The robot was found, for the first time or after it was lost.
    Found,
    /// No reflector was seen for too long.
    Lost,
    /// The pose jumped: the cameras were moved or set up anew, or the robot was lifted.
    Jumped {
        /// Distance \[m\].
        moved_m: f64,
        /// Angle \[rad\].
        turned_rad: f64,
    },
    /// Front and back were exchanged: the names had been wrong at first.
    TurnedRound,
    /// The camera clock was set back; everything begins anew.
    ClockSet,
}

/// Counts of frames.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub struct FilterCounts {
    /// All frames.
    pub frames: u64,
    /// Frames with both reflectors.
    pub both: u64,
    /// Frames with one of them.
    pub one: u64,
    /// Frames whose names contradict the order: swaps that changed nothing.
    pub swapped: u64,
    /// Frames that came after a later one.
    pub out_of_order: u64,
}

/// Position and heading, as estimated at a time.
#[derive(Debug, Clone, Copy)]
struct Estimate {
    time_s: f64,
    x: Coordinate,
    y: Coordinate,
    heading: Coordinate,
}

impl Estimate {
    fn after(&self, time_s: f64) -> Self {
        let dt = (time_s - self.time_s).max(0.0);
        Self {
            time_s: time_s.max(self.time_s),
            x: self.x.after(dt),
            y: self.y.after(dt),
            heading: self.heading.after(dt),
        }
    }

    fn pose(&self) -> Pose {
        Pose {
            time_s: self.time_s,
            x_m: self.x.position(),
            y_m: self.y.position(),
            heading_rad: self.heading.position(),
            sigma_position_m: self.x.variance().max(self.y.variance()).sqrt(),
            sigma_heading_rad: self.heading.variance().sqrt(),
        }
    }
}

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
    pub fn is_found(&self) -> bool {
        self.estimate.is_some()
    }

    /// Returns `true` if names or the heading have settled which end is the front.
    pub fn knows_front(&self) -> bool {
        self.has_names() && self.order.is_settled()
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
        let sightings: Vec<Sighting> = frame.markers.iter().map(|m| self.sighting(m)).collect();
        let pair = self.follower.push(time_s, &sightings);
        let was_found = self.estimate.is_some();
        let event = match pair {
            Some(pair) => {
                let event = self.take_pair(time_s, &pair);
                self.take_sides(frame, &pair);
                event
            }
            None => self.take_lone(time_s, &sightings),
        };
        let blank_s = self.seen_s.map_or(0.0, |seen_s| time_s - seen_s);
        if self.estimate.is_some() && blank_s > self.options.longest_blank_s {
            self.estimate = None;
            self.doubtful = None;
            return Some(FilterEvent::Lost);
        }
        event.or((!was_found && self.estimate.is_some()).then_some(FilterEvent::Found))
    }

    fn has_names(&self) -> bool {
        let [front, back] = [
            &self.options.reflectors.front,
            &self.options.reflectors.back,
        ];
        [front, back]
            .iter()
            .any(|reflector| matches!(reflector.point, PointName::Named(_)))
    }

    fn sighting(&self, marker: &Marker) -> Sighting {
        let is = |point: &PointName| goes_by(marker, point);
        let label = if is(&self.options.reflectors.front.point) {
            Some(End::Front)
        } else if is(&self.options.reflectors.back.point) {
            Some(End::Back)
        } else {
            None
        };
        Sighting {
            label,
            place: Vector3::from(marker.position()),
        }
    }

    /// The middle link's pose from a pair, in an order.
    fn measured(&self, pair: &FollowedPair, order: Order) -> swimmer_model::Pose<f64> {
        let (mut front, mut back) = (pair.front.xy(), pair.back.xy());
        if order.exchanged {
            std::mem::swap(&mut front, &mut back);
        }
        let [at_front, at_back] = [
            &self.options.reflectors.front,
            &self.options.reflectors.back,
        ]
        .map(|r| r.at);
        pose_of_pair(&front, &back, at_front, at_back)
    }

    /// Joint angles, if the pose of this frame is believed and the order is settled.
    fn take_sides(&mut self, frame: &Frame, pair: &FollowedPair) {
        if self.doubtful.is_some() || self.estimate.is_none() || !self.order.is_settled() {
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

    fn take_pair(&mut self, time_s: f64, pair: &FollowedPair) -> Option<FilterEvent> {
        self.counts.both += 1;
        self.learn_noise(pair);
        let Some(estimate) = self.estimate.map(|estimate| estimate.after(time_s)) else {
            return self.find(time_s, pair);
        };
        if pair.begins {
            // A new stretch is doubtful if it is away from the prediction.
            self.doubtful = None;
            let order = self.order_after_gap(&estimate, pair);
            if self.jumps(&estimate, pair, order) {
                self.doubtful = Some(Doubtful { order, frames: 1 });
                return None;
            }
            self.order = order;
        } else if let Some(doubtful) = &mut self.doubtful {
            doubtful.frames += 1;
            doubtful.order.vote(pair.labels);
            let doubtful = *doubtful;
            return (doubtful.frames >= CONFIRMED)
                .then(|| self.jump(time_s, &estimate, pair, doubtful.order));
        }
        let turned = self.order.vote(pair.labels);
        let contradicts = pair
            .labels
            .is_some_and(|agrees| agrees == self.order.exchanged);
        self.counts.swapped += u64::from(contradicts);
        if turned {
            self.begin(time_s, pair);
            return Some(FilterEvent::TurnedRound);
        }
        let pose = self.measured(pair, self.order);
        self.seen_s = Some(time_s);
        self.estimate = Some(self.updated(estimate, &pose));
        None
    }

    /// The first pair, or the first after the robot was lost: a few frames must agree.
    fn find(&mut self, time_s: f64, pair: &FollowedPair) -> Option<FilterEvent> {
        let open = || {
            if self.has_names() {
                Order::open()
            } else {
                Order::settled(false)
            }
        };
        let mut doubtful = match self.doubtful.filter(|_| !pair.begins) {
            Some(doubtful) => doubtful,
            None => Doubtful {
                order: open(),
                frames: 0,
            },
        };
        doubtful.order.vote(pair.labels);
        doubtful.frames += 1;
        self.doubtful = Some(doubtful);
        if doubtful.frames >= CONFIRMED {
            self.doubtful = None;
            self.order = doubtful.order;
            self.begin(time_s, pair);
        }
        None
    }

    /// The order of a new stretch: the heading goes on if it is known well enough, else names decide.
    fn order_after_gap(&self, estimate: &Estimate, pair: &FollowedPair) -> Order {
        let sigma = estimate.heading.variance().sqrt();
        if 3.0 * sigma > FRAC_PI_2 {
            return if self.has_names() {
                Order::open()
            } else {
                Order::settled(false)
            };
        }
        let heading = self.measured(pair, Order::settled(false)).theta;
        let off = wrapped_angle(heading - estimate.heading.position());
        let exchanged = off.abs() > FRAC_PI_2;
        if self.order.is_settled() {
            Order::settled(exchanged)
        } else {
            self.order.with(exchanged)
        }
    }

    fn jumps(&self, estimate: &Estimate, pair: &FollowedPair, order: Order) -> bool {
        let pose = self.measured(pair, order);
        let off = (pose.x - estimate.x.position()).hypot(pose.y - estimate.y.position());
        let turned = wrapped_angle(pose.theta - estimate.heading.position()).abs();
        let predicted = estimate.pose();
        let limit = |least: f64, sigma: f64| least.max(JUMP_SIGMAS * sigma);
        off > limit(JUMP_M, predicted.sigma_position_m)
            || turned > limit(JUMP_M / self.distance_m, predicted.sigma_heading_rad)
    }

    /// A pose that jumped is believed.
    fn jump(
        &mut self,
        time_s: f64,
        before: &Estimate,
        pair: &FollowedPair,
        order: Order,
    ) -> FilterEvent {
        self.doubtful = None;
        self.order = order;
        let pose = self.measured(pair, order);
        self.begin(time_s, pair);
        FilterEvent::Jumped {
            moved_m: (pose.x - before.x.position()).hypot(pose.y - before.y.position()),
            turned_rad: wrapped_angle(pose.theta - before.heading.position()),
        }
    }

    fn begin(&mut self, time_s: f64, pair: &FollowedPair) {
        let pose = self.measured(pair, self.order);
        let omega = TAU / self.options.period_s;
        let agility = |swing: f64| Agility {
            acceleration: swing * omega * omega,
            lasts_s: 1.0 / omega,
        };
        let sway = agility(SWING.1 * self.distance_m);
        let (position, heading) = self.variances();
        self.seen_s = Some(time_s);
        self.estimate = Some(Estimate {
            time_s,
            x: Coordinate::at(pose.x, position, sway),
            y: Coordinate::at(pose.y, position, sway),
            heading: Coordinate::at(pose.theta, heading, agility(SWING.0)),
        });
    }

    /// Variances of a measured position and heading, from that of a coordinate of a point.
    fn variances(&self) -> (f64, f64) {
        (self.noise / 2.0, 2.0 * self.noise / self.distance_m.powi(2))
    }

    fn updated(&self, mut estimate: Estimate, pose: &swimmer_model::Pose<f64>) -> Estimate {
        let (position, heading) = self.variances();
        let before = estimate.heading.position();
        let near = before + wrapped_angle(pose.theta - before);
        estimate.x.measure(pose.x, position);
        estimate.y.measure(pose.y, position);
        estimate.heading.measure(near, heading);
        // Headings stay within a turn of zero.
        let wrapped = wrapped_angle(estimate.heading.position());
        estimate
            .heading
            .shift(wrapped - estimate.heading.position());
        estimate
    }

    /// The distance of both points varies by their noise.
    fn learn_noise(&mut self, pair: &FollowedPair) {
        let off = (pair.front - pair.back).norm() - self.follower.distance_m();
        // One frame that is wrong must not count for many.
        let squared = (off * off / 2.0).min(16.0 * self.noise);
        self.noise += NOISE_WEIGHT * (squared - self.noise);
        self.noise = self.noise.max(LEAST_NOISE_M.powi(2));
    }

    /// One reflector alone: the position that it has with the predicted heading.
    fn take_lone(&mut self, time_s: f64, sightings: &[Sighting]) -> Option<FilterEvent> {
        let estimate = self.estimate?.after(time_s);
        let predicted = estimate.pose();
        let placed = predicted.placed();
        let [at_front, at_back] = [
            &self.options.reflectors.front,
            &self.options.reflectors.back,
        ]
        .map(|r| r.at);
        let mut near: Option<Vector2<f64>> = None;
        for at in [at_front, at_back] {
            let expected = placed.transform(&Vector2::from(at));
            let reach = at[0].hypot(at[1]);
            let sigma = (predicted.sigma_position_m.powi(2)
                + (reach * predicted.sigma_heading_rad).powi(2)
                + self.noise)
                .sqrt();
            let offs = sightings.iter().map(|s| s.place.xy() - expected);
            for off in offs.filter(|off| off.norm() < LONE_SIGMAS * sigma) {
                // Two that fit are ambiguous.
                if near.replace(off).is_some() {
                    return None;
                }
            }
        }
        let off = near?;
        self.counts.one += 1;
        let reach = at_front[0]
            .hypot(at_front[1])
            .max(at_back[0].hypot(at_back[1]));
        let variance = self.noise + (reach * predicted.sigma_heading_rad).powi(2);
        let mut estimate = estimate;
        estimate.x.measure(predicted.x_m + off.x, variance);
        estimate.y.measure(predicted.y_m + off.y, variance);
        self.seen_s = Some(time_s);
        self.estimate = Some(estimate);
        None
    }
}

/// Returns `true` if a marker goes by a name: its own, or the part after an asset's name and a colon.
fn goes_by(marker: &Marker, point: &PointName) -> bool {
    match (point, &marker.name) {
        (PointName::Named(wanted), Some(name)) => {
            name == wanted
                || name
                    .rsplit_once(':')
                    .is_some_and(|(_, last)| last == wanted)
        }
        _ => false,
    }
}

fn side_followers(options: &FilterOptions) -> Option<[SideFollower; 2]> {
    let half = options.middle_m / 2.0;
    let [front, back] = options.reflectors.sides.as_ref()?;
    let follower = |end, reflector: &Reflector| {
        let has_name = matches!(reflector.point, PointName::Named(_));
        SideFollower::new(end, half, reflector.at, has_name)
    };
    Some([follower(End::Front, front), follower(End::Back, back)])
}
