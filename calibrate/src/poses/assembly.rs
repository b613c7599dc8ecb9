//! Poses in time: of the rows in which both reflectors were seen, and of those in between that may be filled.

use nalgebra::Vector2;
use swimmer_files::Reflectors;
use swimmer_model::{Pose, wrapped_angle};

use super::fill::{Bridge, TAIL, VisibleRow};
use super::follow::Followed;
use super::{Origin, Plane, PoseSample, pose_of_pair};
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
    pub(super) fn samples(&self, seen: &[VisibleRow]) -> Vec<PoseSample> {
        let mut samples: Vec<PoseSample> = Vec::with_capacity(seen.len());
        let mut push = |time_s: f64, mut pose: Pose<f64>, origin: Origin| {
            if let Some(last) = samples.last() {
                pose.theta = last.pose.theta + wrapped_angle(pose.theta - last.pose.theta);
            }
            samples.push(PoseSample {
                time_s,
                pose,
                origin,
            });
        };
        let bridges: Vec<Option<Bridge>> = (0..seen.len()).map(|i| self.bridge(seen, i)).collect();
        for (index, sample) in seen.iter().enumerate() {
            let bridge = bridges.get(index).and_then(Option::as_ref);
            let filled = bridge.and_then(|bridge| self.fill(bridge, seen, index));
            for (time_s, pose, origin) in filled.unwrap_or_default() {
                push(time_s, pose, origin);
            }
            let mut pose = self.pose(&sample.front, &sample.back);
            let mut origin = Origin::Seen;
            if sample.tail {
                // The cubic of a gap within reach, where that was filled.
                let mut near = index.saturating_sub(TAIL - 1)..=index + TAIL;
                let bridge = near.find_map(|i| bridges.get(i)?.as_ref());
                let smooth = bridge.and_then(|bridge| bridge.at(sample.time_s));
                origin = smooth.map_or(Origin::Tail, |_| Origin::Smoothed);
                pose = smooth.map_or(pose, |(front, back)| self.pose(&front, &back));
            }
            push(sample.time_s, pose, origin);
        }
        samples
    }

    fn pose(&self, front: &Vector2<f64>, back: &Vector2<f64>) -> Pose<f64> {
        pose_of_pair(
            front,
            back,
            self.reflectors.front.at,
            self.reflectors.back.at,
        )
    }

    /// The cubic over the gap before a sample, if there is one that may be filled.
    fn bridge(&self, seen: &[VisibleRow], after: usize) -> Option<Bridge> {
        let (before, next) = (seen.get(after.checked_sub(1)?)?, seen.get(after)?);
        let gap_s = next.time_s - before.time_s;
        let may = !next.begins
            && next.row - before.row > 1
            && gap_s <= self.longest_s + 1.5 / self.track.rate_hz;
        may.then(|| Bridge::over(seen, after)).flatten()
    }

    /// The poses in the gap before a sample.
    fn fill(
        &self,
        bridge: &Bridge,
        seen: &[VisibleRow],
        after: usize,
    ) -> Option<Vec<(f64, Pose<f64>, Origin)>> {
        let rows = seen.get(after.checked_sub(1)?)?.row + 1..seen.get(after)?.row;
        // In a single lost frame the cubic is better than one reflector's noise.
        let hidden = rows.len() > 1;
        let row = |row: usize| {
            let time_s = *self.track.times.get(row)?;
            let (front, back) = bridge.at(time_s)?;
            let moved = hidden.then(|| self.moved(row, &front, &back)).flatten();
            let mut pose = self.pose(&front, &back);
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
