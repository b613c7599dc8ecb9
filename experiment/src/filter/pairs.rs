//! Both reflectors of a frame: order of front and back, poses that jump.

use std::f64::consts::{FRAC_PI_2, PI};

use calibrate::{End, FollowedPair, Sighting, pose_of_pair};
use nalgebra::Vector3;
use pose_source::Marker;
use swimmer_files::PointName;
use swimmer_model::wrapped_angle;

use super::estimate::{Estimate, Variances};
use super::order::Order;
use super::{CONFIRMED, Doubtful, FilterEvent, PoseFilter, goes_by};

/// Least noise of a point \[m\]: rounding of a stream.
const LEAST_NOISE_M: f64 = 2e-5;
/// Weight of a frame in the running estimate of the noise.
const NOISE_WEIGHT: f64 = 0.01;

/// Log-likelihood ratio from which the heading decides the order after a gap: 1000 to 1.
const CLEAR: f64 = 7.0;

impl PoseFilter {
    pub(super) fn has_names(&self) -> bool {
        let [front, back] = [
            &self.options.reflectors.front,
            &self.options.reflectors.back,
        ];
        [front, back]
            .iter()
            .any(|reflector| matches!(reflector.point, PointName::Named(_)))
    }

    pub(super) fn sighting(&self, marker: &Marker) -> Sighting {
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
    pub(super) fn measured(&self, pair: &FollowedPair, order: Order) -> swimmer_model::Pose<f64> {
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

    pub(super) fn take_pair(&mut self, time_s: f64, pair: &FollowedPair) -> Option<FilterEvent> {
        self.counts.both += 1;
        self.learn_noise(pair);
        let Some(estimate) = self.estimate.map(|estimate| estimate.after(time_s)) else {
            return self.find(time_s, pair);
        };
        if pair.begins {
            // A new stretch is doubtful if it is away from the prediction.
            self.doubtful = None;
            let order = self.order_after_gap(&estimate, pair);
            if self.jumps_to(&estimate, pair, order) {
                self.doubtful = Some(Doubtful { order, frames: 1 });
                return None;
            }
            self.order = order;
        } else if let Some(doubtful) = &mut self.doubtful {
            doubtful.frames += 1;
            doubtful.order.vote(pair.labels);
            let Doubtful { order, frames } = *doubtful;
            return (frames >= CONFIRMED).then(|| {
                self.order = order;
                self.jump(&estimate, &self.measured(pair, order), self.variances())
            });
        }
        let turned = self.order.vote(pair.labels);
        let contradicts = pair
            .labels
            .is_some_and(|agrees| agrees == self.order.exchanged);
        self.counts.swapped += u64::from(contradicts);
        let pose = self.measured(pair, self.order);
        if turned {
            self.begin(time_s, &pose, self.variances());
            return Some(FilterEvent::TurnedRound);
        }
        self.seen_s = Some(time_s);
        self.estimate = Some(estimate.updated(&pose, self.variances()));
        None
    }

    /// Takes the first pair, or the first after the robot was lost: some frames must agree.
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
            self.begin(time_s, &self.measured(pair, self.order), self.variances());
        }
        None
    }

    /// The order of a new stretch: the heading continues it if it is known well enough, else names decide.
    fn order_after_gap(&self, estimate: &Estimate, pair: &FollowedPair) -> Order {
        let heading = self.measured(pair, Order::settled(false)).theta;
        let off = wrapped_angle(heading - estimate.heading.position()).abs();
        let exchanged = off > FRAC_PI_2;
        if !self.has_names() {
            return Order::settled(exchanged);
        }
        // Log-likelihood of this order over that of the other one.
        let nearer = off.min(PI - off);
        let evidence = PI * (0.5 * PI - nearer) / estimate.heading.variance();
        if evidence < CLEAR {
            return Order::open();
        }
        self.order.continued(exchanged)
    }

    fn jumps_to(&self, estimate: &Estimate, pair: &FollowedPair, order: Order) -> bool {
        self.jumps(estimate, &self.measured(pair, order))
    }

    /// Variances of a pose by two points, from that of a coordinate of a point.
    pub(super) fn variances(&self) -> Variances {
        Variances {
            position: self.noise / 2.0,
            heading: 2.0 * self.noise / self.distance_m.powi(2),
        }
    }

    /// The distance of both points varies by their noise.
    fn learn_noise(&mut self, pair: &FollowedPair) {
        let off = (pair.front - pair.back).norm() - self.follower.distance_m();
        // One frame that is wrong must not count for many.
        let squared = (off * off / 2.0).min(16.0 * self.noise);
        self.noise += NOISE_WEIGHT * (squared - self.noise);
        self.noise = self.noise.max(LEAST_NOISE_M.powi(2));
    }
}
