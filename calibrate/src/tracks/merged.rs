//! Tracks with times of their own as rows: one row for each time that any of them has.

use super::grid::Body;
use super::timeline::Timeline;
use super::{PointKind, TrackPoint};

/// Times that differ by less than this share of the usual step are the same frame, written by two tracks.
const SAME_FRAME: f64 = 0.25;

/// A track's pose at a time.
#[derive(Debug, Clone, Copy)]
pub(super) struct TimedPose {
    pub(super) time_s: f64,
    pub(super) place: [f64; 3],
    /// Orientation (x, y, z, w), if the file gives it.
    pub(super) turn: Option<[f64; 4]>,
}

/// Tracks by name, each in the order of time; places in metres if a unit has `metres`.
pub(super) fn merged(
    mut timeline: Timeline,
    tracks: Vec<(String, Vec<TimedPose>)>,
    metres: f64,
) -> Body {
    let seen = |(_, seen): &(String, Vec<TimedPose>)| {
        let times = seen.iter().map(|seen| seen.time_s);
        times.filter(|time| time.is_finite()).collect()
    };
    let mut times: Vec<f64> = tracks.iter().flat_map::<Vec<f64>, _>(seen).collect();
    times.sort_by(f64::total_cmp);
    times.dedup();
    let mut steps: Vec<f64> = times
        .windows(2)
        .filter_map(|pair| Some(pair.last()? - pair.first()?))
        .collect();
    steps.sort_by(f64::total_cmp);
    // Two roundings of one time are far nearer than frames: the upper half of the steps are between frames.
    let step = steps.get(steps.len() * 3 / 4).copied().unwrap_or(0.0);
    let mut rows: Vec<f64> = Vec::with_capacity(times.len());
    for time in times {
        if rows
            .last()
            .is_none_or(|last| time - last > SAME_FRAME * step)
        {
            rows.push(time);
        }
    }
    for (row, time) in rows.iter().enumerate() {
        timeline.push(row as u64, *time);
    }
    let points = tracks.into_iter().map(|(name, seen)| {
        let mut point = TrackPoint::new(name, PointKind::Marker, String::new(), Vec::new());
        if seen.iter().any(|seen| seen.turn.is_some()) {
            point = point.oriented();
        }
        for TimedPose {
            time_s,
            place,
            turn,
        } in seen.into_iter().filter(|seen| seen.time_s.is_finite())
        {
            let row = rows.partition_point(|row| *row <= time_s).saturating_sub(1);
            point.push_pose(row, place.map(|value| value * metres), turn);
        }
        point.finish(rows.len());
        point
    });
    Body {
        points: points.collect(),
        timeline,
        warnings: Vec::new(),
        rate_hz: None,
    }
}
