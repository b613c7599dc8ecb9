//! A side link's angle in time, from the one point that keeps the reflector's distance from the joint: names are hints, and
//! what goes on from the last row counts for more.

use swimmer_files::{Reflector, Reflectors};

use super::side::{SideFollower, SideSighting};
use crate::poses::{End, Origin, PoseTrack};
use crate::tracks::TrackFile;

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
        let end = if self.end > 0.0 {
            End::Front
        } else {
            End::Back
        };
        let mut follower = SideFollower::new(end, half, self.reflector.at, !named.is_empty());
        let mut out: Vec<(f64, f64)> = Vec::with_capacity(poses.samples.len());
        for sample in poses.samples.iter().filter(|s| s.origin == Origin::Seen) {
            let Some(row) = row_at(track, sample.time_s) else {
                continue;
            };
            let seen: Vec<SideSighting> = pool
                .iter()
                .filter_map(|point| {
                    let place = track.points.get(*point)?.position(row)?;
                    Some(SideSighting {
                        named: named.contains(point),
                        place: poses.plane.project(&place),
                    })
                })
                .collect();
            if let Some(angle) = follower.push(sample.time_s, &sample.pose, &seen) {
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
}

fn row_at(track: &TrackFile, time_s: f64) -> Option<usize> {
    let row = track.times.partition_point(|time| *time < time_s);
    track
        .times
        .get(row)
        .is_some_and(|time| *time <= time_s)
        .then_some(row)
}
