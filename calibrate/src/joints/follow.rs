//! A side link's angle in time, from the one point that keeps the reflector's distance from the joint: names are hints, and
//! what goes on from the last row counts for more.

use nalgebra::Vector2;
use swimmer_files::{Reflector, Reflectors};

use swimmer_model::wrapped_angle;

use crate::poses::{Origin, PoseSample, PoseTrack};
use crate::tracks::TrackFile;

/// Largest error of a point's distance to the joint, as a share of the reflector's.
const DISTANCE: f64 = 0.1;
/// Largest turn from one row to the next \[rad\], and how fast a link may turn over a gap \[rad/s\].
const STEP: f64 = 0.3;
const SPEED: f64 = 6.0;

/// One side link: the position of its joint along the middle link, in half lengths of it, and the sign of its angle.
struct Side<'a> {
    reflector: &'a Reflector,
    end: f64,
}

/// Times and angles \[rad\] of the front joint, and of the back joint, in the samples in which both of the middle link's
/// reflectors were seen. `half` is that of the middle link \[m\].
pub(super) fn angles(
    track: &TrackFile,
    poses: &PoseTrack,
    reflectors: &Reflectors,
    half: f64,
) -> [Vec<(f64, f64)>; 2] {
    let Some([front, back]) = &reflectors.sides else {
        return [Vec::new(), Vec::new()];
    };
    let sides = [(front, 1.0), (back, -1.0)];
    sides.map(|(reflector, end)| Side { reflector, end }.angles(track, poses, half))
}

impl Side<'_> {
    fn angles(&self, track: &TrackFile, poses: &PoseTrack, half: f64) -> Vec<(f64, f64)> {
        let measured = |i: &usize| {
            let point = track.points.get(*i);
            point.is_some_and(|point| point.kind.is_measured())
        };
        let all = || 0..track.points.len();
        let pool: Vec<usize> = if all().any(|i| measured(&i)) {
            all().filter(measured).collect()
        } else {
            all().collect()
        };
        let named: Vec<usize> = self.named(track, &pool);
        let mut out: Vec<(f64, f64)> = Vec::with_capacity(poses.samples.len());
        for sample in poses.samples.iter().filter(|s| s.origin == Origin::Seen) {
            let Some(row) = row_at(track, sample.time_s) else {
                continue;
            };
            let seen = pool.iter().filter_map(|point| {
                let place = track.points.get(*point)?.position(row)?;
                let angle = self.angle(sample, poses.plane.project(&place), half)?;
                Some((*point, angle))
            });
            let seen: Vec<(usize, f64)> = seen.collect();
            let last = out.last().copied();
            if let Some(angle) = next(&seen, &named, sample.time_s, last) {
                out.push((sample.time_s, angle));
            }
        }
        out
    }

    /// The points of the pool that go by the reflector's name.
    fn named(&self, track: &TrackFile, pool: &[usize]) -> Vec<usize> {
        let is = |i: &&usize| {
            let point = track.points.get(**i);
            point.is_some_and(|point| point.goes_by(&self.reflector.point))
        };
        pool.iter().filter(is).copied().collect()
    }

    /// The link's angle by a point at this place, if it is as far from the joint as the reflector.
    fn angle(&self, sample: &PoseSample, place: Vector2<f64>, half: f64) -> Option<f64> {
        let pose = &sample.pose;
        let from = place - pose.transform(&Vector2::new(self.end * half, 0.0));
        let [along, across] = self.reflector.at;
        let reach = along.hypot(across);
        if (from.norm() - reach).abs() > DISTANCE * reach {
            return None;
        }
        let outwards = from.y.atan2(from.x) - across.atan2(along);
        Some(wrapped_angle(if self.end > 0.0 {
            outwards - pose.theta
        } else {
            pose.theta + std::f64::consts::PI - outwards
        }))
    }
}

/// Angle that continues the last one; without a last one the named point's, else the straightest.
fn next(
    seen: &[(usize, f64)],
    named: &[usize],
    time: f64,
    last: Option<(f64, f64)>,
) -> Option<f64> {
    let by_name = || seen.iter().find(|(point, _)| named.contains(point));
    let Some((then, angle)) = last else {
        let straightest = || seen.iter().min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()));
        let first = by_name().or_else(|| straightest().filter(|_| named.is_empty()))?;
        return Some(first.1);
    };
    let reach = STEP.max(SPEED * (time - then));
    let off = |(_, other): &&(usize, f64)| wrapped_angle(other - angle).abs();
    let nearest = seen.iter().min_by(|a, b| off(a).total_cmp(&off(b)))?;
    // Over a long gap everything is near: the name decides.
    let found = if reach > 1.0 {
        by_name().unwrap_or(nearest)
    } else {
        nearest
    };
    (off(&found) < reach).then(|| angle + wrapped_angle(found.1 - angle))
}

fn row_at(track: &TrackFile, time_s: f64) -> Option<usize> {
    let row = track.times.partition_point(|time| *time < time_s);
    track
        .times
        .get(row)
        .is_some_and(|time| *time <= time_s)
        .then_some(row)
}
