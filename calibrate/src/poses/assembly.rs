//! Poses in time: of the rows in which both reflectors were seen, and of those in between that may be filled.

use nalgebra::Vector2;
use swimmer_files::Reflectors;
use swimmer_model::Pose;

use super::fill::{Bridge, Seen};
use super::follow::Followed;
use super::{Origin, Plane, PoseSample, pose_of, wrapped};
use crate::TrackFile;

/// Poses in time from what was seen, and from cubics over gaps.
pub(super) struct Assembly<'a> {
    pub(super) track: &'a TrackFile,
    pub(super) reflectors: &'a Reflectors,
    pub(super) followed: &'a Followed<'a>,
    pub(super) plane: &'a Plane,
    pub(super) longest_s: f64,
}

impl Assembly<'_> {
    pub(super) fn samples(&self, seen: &[Seen]) -> Vec<PoseSample> {
        let mut samples: Vec<PoseSample> = Vec::with_capacity(seen.len());
        let mut push = |time_s: f64, mut pose: Pose<f64>, origin: Origin| {
            if let Some(last) = samples.last() {
                pose.theta = last.pose.theta + wrapped(pose.theta - last.pose.theta);
            }
            samples.push(PoseSample {
                time_s,
                pose,
                origin,
            });
        };
        let [front, back] = [self.reflectors.front.at, self.reflectors.back.at];
        for (index, sample) in seen.iter().enumerate() {
            for (time_s, pose, origin) in self.fill(seen, index).unwrap_or_default() {
                push(time_s, pose, origin);
            }
            let pose = pose_of(&sample.front, &sample.back, front, back);
            let origin = if sample.tail {
                Origin::Tail
            } else {
                Origin::Seen
            };
            push(sample.time_s, pose, origin);
        }
        samples
    }

    /// The poses in the gap before a sample, if there is one that may be filled.
    fn fill(&self, seen: &[Seen], after: usize) -> Option<Vec<(f64, Pose<f64>, Origin)>> {
        let (before, next) = (seen.get(after.checked_sub(1)?)?, seen.get(after)?);
        let rows = before.row + 1..next.row;
        let gap_s = next.time_s - before.time_s;
        if rows.is_empty() || gap_s > self.longest_s + 1.5 / self.track.rate_hz {
            return None;
        }
        let bridge = Bridge::over(seen, after)?;
        // In a single lost frame the cubic is better than one reflector's noise.
        let hidden = rows.len() > 1;
        let row = |row: usize| {
            let time_s = *self.track.times.get(row)?;
            let (front, back) = bridge.at(time_s)?;
            let moved = hidden.then(|| self.moved(row, &front, &back)).flatten();
            let [at_front, at_back] = [self.reflectors.front.at, self.reflectors.back.at];
            let mut pose = pose_of(&front, &back, at_front, at_back);
            let by = moved.unwrap_or_default();
            (pose.x, pose.y) = (pose.x + by.x, pose.y + by.y);
            let origin = moved.map_or(Origin::Filled, |_| Origin::OneSeen);
            Some((time_s, pose, origin))
        };
        Some(rows.filter_map(row).collect())
    }

    /// From the cubic to the reflector that was seen, where one was.
    fn moved(&self, row: usize, front: &Vector2<f64>, back: &Vector2<f64>) -> Option<Vector2<f64>> {
        let near = |place| {
            self.followed
                .nearest(row, |point| self.plane.project(point), place)
        };
        match (near(front), near(back)) {
            (Some(there), None) => Some(there - front),
            (None, Some(there)) => Some(there - back),
            _ => None,
        }
    }
}
