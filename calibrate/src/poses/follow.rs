//! Two reflectors followed through swaps, ghosts and drop-outs.
//!
//! In every row all measured points are candidates, whatever they are called, except those that are nearer to a point that was
//! no reflector a row ago than to where constant velocity puts the reflectors: they are that other point still. Chosen is the
//! ordered pair nearest to the predicted places, among the pairs whose distance is right. A label that moves to the other
//! reflector, or to a ghost, thus changes nothing. After a gap in which a reflector could have covered half of the distance
//! between both, the order could be exchanged unseen: there a new segment begins. `identity` joins segments and determines their
//! orientation.

mod frame_jump;
mod identity;
mod incremental;
mod pairs;
mod rigid;
mod search;
mod walk;

use nalgebra::{Vector2, Vector3};
use swimmer_files::{PointName, Reflectors};

use super::frozen::{Frozen, take_frozen};
use super::{PoseError, PoseOptions};
use crate::TrackFile;
use identity::Settled;
pub use incremental::{End, FollowedPair, PairFollower, Sighting};
use search::{Search, prepare};
use walk::walk;

/// Report on following the reflectors.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowReport {
    /// Rows with both reflectors.
    pub followed: usize,
    /// Rows without.
    pub missing: usize,
    /// Those of them in which both were held: copies of the row before, digit for digit.
    pub frozen: usize,
    /// Number of stretches in which the labels were exchanged, and were corrected.
    pub swaps_repaired: usize,
    /// These stretches.
    pub swaps: Vec<Stretch>,
    /// Number of points near the reflectors that are no reflectors. Named reflectors limit this to three times their distance.
    pub ghosts_rejected: usize,
    /// Stretches of rows with such points.
    pub ghosts: Vec<Stretch>,
    /// Stretches without an ambiguous gap.
    pub segments: usize,
    /// Mean distance between the reflectors \[m\].
    pub distance_m: f64,
    /// Its standard deviation \[m\].
    pub distance_sd_m: f64,
    /// Distance by `at` \[m\].
    pub expected_m: f64,
}

impl FollowReport {
    /// Of no recording.
    pub(super) fn none() -> Self {
        Self {
            followed: 0,
            missing: 0,
            frozen: 0,
            swaps_repaired: 0,
            swaps: Vec::new(),
            ghosts_rejected: 0,
            ghosts: Vec::new(),
            segments: 0,
            distance_m: f64::NAN,
            distance_sd_m: f64::NAN,
            expected_m: f64::NAN,
        }
    }
}

/// Rows one after another in which something held.
#[derive(Debug, Clone, Copy, PartialEq, serde::Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Stretch {
    /// The first of them \[s\].
    pub from_s: f64,
    /// The last of them \[s\].
    pub until_s: f64,
    /// Number.
    pub rows: usize,
}

impl Stretch {
    /// The stretches of what holds, among times in order.
    fn of(times: impl Iterator<Item = (f64, bool)>) -> Vec<Self> {
        let (mut stretches, mut open): (Vec<Self>, bool) = (Vec::new(), false);
        for (time, holds) in times {
            match stretches.last_mut().filter(|_| open && holds) {
                Some(stretch) => {
                    stretch.until_s = time;
                    stretch.rows += 1;
                }
                None if holds => stretches.push(Self {
                    from_s: time,
                    until_s: time,
                    rows: 1,
                }),
                None => {}
            }
            open = holds;
        }
        stretches
    }
}

/// A row in which both reflectors were found.
#[derive(Debug, Clone, Copy)]
pub(super) struct Row {
    pub(super) index: usize,
    pub(super) front: Vector3<f64>,
    pub(super) back: Vector3<f64>,
    /// Labels agree (`true`), contradict, or say nothing.
    labels: Option<bool>,
    /// Distance of both from their predicted positions \[m\].
    miss: Option<f64>,
    /// `true` if a segment begins with it.
    pub(super) begins: bool,
}

pub(super) struct Followed<'a> {
    search: Search<'a>,
    pub(super) rows: Vec<Row>,
    pub(super) report: FollowReport,
    pub(super) expected_m: f64,
    pub(super) order_known: bool,
    pub(super) lost_segments: usize,
    pub(super) lost_rows: usize,
    pub(super) frozen: Frozen,
    /// Share of rows whose labels contradict the others', if it is too large to decide which are right.
    pub(super) contested: Option<f64>,
    /// Rows in which a rigid body was tipped over.
    pub(super) tipped: usize,
}

/// Tolerance of a lone point about a cubic, over the reflectors' distance: the bend of a fast gait in 0.1 s.
const NEAR: f64 = 0.05;

impl Followed<'_> {
    /// The measured point of a row that is nearest to where a reflector ought to be, if it is near enough to be it.
    pub(super) fn nearest(
        &self,
        row: usize,
        project: impl Fn(&Vector3<f64>) -> Vector2<f64>,
        place: &Vector2<f64>,
    ) -> Option<Vector2<f64>> {
        let mut candidates = Vec::new();
        self.search.candidates(row, &mut candidates);
        let reach = self
            .search
            .pairs
            .after_gap
            .1
            .max(NEAR * self.search.pairs.distance);
        candidates
            .iter()
            .map(|(_, at)| project(at))
            .filter(|at| (at - place).norm() < reach)
            .min_by(|a, b| (a - place).norm().total_cmp(&(b - place).norm()))
    }
}

pub(super) fn follow<'a>(
    track: &'a TrackFile,
    reflectors: &Reflectors,
    options: &PoseOptions,
) -> Result<Followed<'a>, PoseError> {
    let [a, b] = [reflectors.front.at, reflectors.back.at];
    let expected_m = (a[0] - b[0]).hypot(a[1] - b[1]);
    if !(expected_m.is_finite() && expected_m > 0.0) {
        return Err(PoseError::SamePlace);
    }
    if track.unit.metres().is_none() {
        let scale = search::scale(track, reflectors, expected_m);
        return Err(PoseError::NoScale {
            unit: track.unit,
            scale,
        });
    }
    if let Some(body) = &reflectors.body {
        return rigid::follow(track, reflectors, body, expected_m);
    }
    let mut search = prepare(track, reflectors, expected_m, options)?;
    // The first pass determines the distance, and its scatter and that of predictions.
    let rows = walk(&search).0;
    let distances = rows.iter().map(|row| (row.front - row.back).norm());
    let misses = rows.iter().filter_map(|row| row.miss);
    search.pairs.learn(distances, misses);
    drop(rows);
    let (rows, starts) = walk(&search);
    if rows.is_empty() {
        return Err(PoseError::NoPair {
            expected_m,
            tolerance_m: search.pairs.tolerance,
            frames: track.frames(),
        });
    }
    let has_name = |point: &PointName| !matches!(point, PointName::Auto | PointName::Near(_));
    let named = has_name(&reflectors.front.point) || has_name(&reflectors.back.point);
    let settled = identity::settle(&search, rows, &starts);
    let mut followed = settle(search, settled, starts.len(), expected_m);
    followed.order_known = named
        && followed.contested.is_none()
        && followed.rows.iter().any(|row| row.labels.is_some());
    followed.contested = followed.contested.filter(|_| named);
    // A reflector that measures a joint angle is not a ghost.
    let own = 2 + reflectors.sides.as_ref().map_or(0, |sides| sides.len());
    let mut candidates = Vec::new();
    let mut crowded = Vec::with_capacity(followed.rows.len());
    for row in &followed.rows {
        followed.search.candidates(row.index, &mut candidates);
        let ghosts = candidates.len().saturating_sub(own);
        followed.report.ghosts_rejected += ghosts;
        crowded.push((followed.search.time(row), ghosts > 0));
    }
    followed.report.ghosts = Stretch::of(crowded.into_iter());
    Ok(followed)
}

/// Counts the followed rows of this number of segments.
fn settle(search: Search<'_>, settled: Settled, segments: usize, expected_m: f64) -> Followed<'_> {
    let frames = search.track.frames();
    let mut kept = settled.rows;
    let named = kept.iter().filter_map(|row| Some((row, row.labels?)));
    let swaps = Stretch::of(named.map(|(row, agrees)| (search.time(row), !agrees)));
    let frozen = take_frozen(&mut kept);
    let count = kept.len().max(1) as f64;
    let distance = |row: &Row| (row.front - row.back).norm();
    let distance_m = kept.iter().map(distance).sum::<f64>() / count;
    let variance = kept
        .iter()
        .map(|row| (distance(row) - distance_m).powi(2))
        .sum::<f64>()
        / count;
    Followed {
        search,
        report: FollowReport {
            followed: kept.len(),
            missing: frames - kept.len(),
            frozen: frozen.rows,
            swaps_repaired: swaps.len(),
            swaps,
            ghosts_rejected: 0,
            ghosts: Vec::new(),
            segments,
            distance_m,
            distance_sd_m: variance.sqrt(),
            expected_m,
        },
        rows: kept,
        expected_m,
        order_known: false,
        lost_segments: settled.lost_segments,
        lost_rows: settled.lost_rows,
        frozen,
        contested: settled.contested,
        tipped: 0,
    }
}
