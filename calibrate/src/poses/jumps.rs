//! Jumps of the pose: the tank's frame was moved (a camera was bumped, the system calibrated anew), or the robot was lifted.
//! Samples before and after a jump are good, but nothing that spans it is.

use swimmer_model::Pose;

use super::PoseSample;
use crate::median::median;

/// A jump of the pose that no servo and no drag could make.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Jump {
    /// The last sample before it \[s\].
    pub before_s: f64,
    /// The first sample after it \[s\].
    pub after_s: f64,
    /// Displacement of the middle link's centre \[m\].
    pub moved_m: f64,
    /// Rotation \[rad\].
    pub turned_rad: f64,
}

/// Samples on either side that must agree on the jump.
const SIDE: usize = 5;
/// Least length of a jump, as a share of the reflectors' distance.
const LEAST: f64 = 0.05;
/// Least length of a jump, in usual steps from frame to frame, which may be mostly noise.
const USUAL: f64 = 6.0;
/// Least length of a jump, in steps at the local speed: from frame to frame, and over a gap, with the speed of the whole run.
const SPEEDS: (f64, f64) = (4.0, 2.0);
/// Interval over which speeds are averaged \[s\].
const SPEED_S: f64 = 0.5;

/// The jumps among samples, in time. `distance_m` is the reflectors', by which turns are weighed.
pub(super) fn jumps(samples: &[PoseSample], distance_m: f64, rate_hz: f64) -> Vec<Jump> {
    let way = |a: &Pose<f64>, b: &Pose<f64>| {
        (b.position() - a.position()).norm() + distance_m * (b.theta - a.theta).abs()
    };
    let between = |a: &PoseSample, b: &PoseSample| way(&a.pose, &b.pose);
    let ways = samples.windows(2).filter_map(|pair| match pair {
        [a, b] => Some(between(a, b)),
        _ => None,
    });
    let usual = median(ways).unwrap_or(0.0);
    let least = (LEAST * distance_m).max(USUAL * usual);
    let speed = |a: &PoseSample, b: &PoseSample| between(a, b) / (b.time_s - a.time_s);
    let top_speed = top_speed(samples, rate_hz, speed);
    let mut jumps = Vec::new();
    for sides in samples.windows(2 * SIDE) {
        let (before, after) = sides.split_at(SIDE);
        let ([first, .., a], [b, .., last]) = (before, after) else {
            continue;
        };
        let (moved, passed_s) = (between(a, b), b.time_s - a.time_s);
        let limit = if passed_s * rate_hz < 1.5 {
            SPEEDS.0 * top_speed.max(speed(first, a)).max(speed(b, last))
        } else {
            SPEEDS.1 * top_speed
        };
        if moved <= least + limit * passed_s {
            continue;
        }
        // A single pose that is wrong jumps there and back, and where samples are missing the robot has moved on.
        let time = |side: &[PoseSample]| side.get(SIDE / 2).map_or(0.0, |sample| sample.time_s);
        let on_its_way = top_speed * (time(after) - time(before));
        let stays = way(&middle(before), &middle(after)) > 0.5 * moved + on_its_way;
        if stays {
            jumps.push(Jump {
                before_s: a.time_s,
                after_s: b.time_s,
                moved_m: (b.pose.position() - a.pose.position()).norm(),
                turned_rad: swimmer_model::wrapped_angle(b.pose.theta - a.pose.theta),
            });
        }
    }
    jumps
}

/// The speed that is seldom passed \[m/s\].
fn top_speed(
    samples: &[PoseSample],
    rate_hz: f64,
    speed: impl Fn(&PoseSample, &PoseSample) -> f64,
) -> f64 {
    // Bounded and positive.
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)]
    let far = (SPEED_S * rate_hz).clamp(1.0, 1e6) as usize;
    let pairs = samples.iter().zip(samples.iter().skip(far));
    let mut speeds: Vec<f64> = pairs.map(|(a, b)| speed(a, b)).collect();
    let seldom = speeds.len() * 19 / 20;
    if speeds.is_empty() {
        return 0.0;
    }
    *speeds.select_nth_unstable_by(seldom, f64::total_cmp).1
}

/// The pose in the middle of some, each coordinate for itself.
fn middle(samples: &[PoseSample]) -> Pose<f64> {
    let of = |value: fn(&Pose<f64>) -> f64| {
        median(samples.iter().map(|sample| value(&sample.pose))).unwrap_or(0.0)
    };
    Pose::new(of(|p| p.x), of(|p| p.y), of(|p| p.theta))
}
