//! Two reflectors followed through swaps, ghosts and drop-outs.
//!
//! In every row all measured points are candidates, whatever they are called. Chosen is the ordered pair nearest to where
//! constant velocity puts both reflectors, among the pairs whose distance is right. A label that moves to the other
//! reflector, or to a ghost, thus changes nothing. After a gap in which a reflector could have covered half of the distance
//! between both, the order could be exchanged unseen: there a new segment begins, and only the labels can say which end is
//! which. Where they cannot, the segment is left out.

use std::collections::HashMap;

use nalgebra::Vector3;
use swimmer_files::{PointName, Reflector, Reflectors};

use super::{PoseError, PoseOptions};
use crate::{TrackFile, TrackPoint};

/// How following went.
#[derive(Debug, Clone, PartialEq)]
pub struct FollowReport {
    /// Rows with both reflectors.
    pub followed: usize,
    /// Rows without.
    pub missing: usize,
    /// Stretches in which the labels were exchanged, and were set right.
    pub swaps_repaired: usize,
    /// Points that were in followed rows and are no reflector.
    pub ghosts_rejected: usize,
    /// Stretches without an ambiguous gap.
    pub segments: usize,
    /// Mean distance between the reflectors \[m\].
    pub distance_m: f64,
    /// Its standard deviation \[m\].
    pub distance_sd_m: f64,
}

pub(super) struct Row {
    pub(super) index: usize,
    pub(super) front: Vector3<f64>,
    pub(super) back: Vector3<f64>,
    /// Labels agree (`true`), contradict, or say nothing.
    labels: Option<bool>,
    /// How far both were from their predicted places \[m\].
    miss: Option<f64>,
}

pub(super) struct Followed {
    pub(super) rows: Vec<Row>,
    pub(super) report: FollowReport,
    pub(super) expected_m: f64,
    pub(super) order_known: bool,
    pub(super) lost_segments: usize,
    pub(super) lost_rows: usize,
}

/// Smoothing time of the velocity \[s\].
const SMOOTHING_S: f64 = 0.2;
/// Longest gap before a speed is known \[s\].
const FIRST_GAP_S: f64 = 1.0;
/// How far both reflectors together may be from their predicted places, over their distance, before it is known how far
/// they usually are; and never further than this in the end, or they could be exchanged.
const REACH: (f64, f64) = (0.1, 0.45);
/// Limits of the second pass over the medians of the first: six standard deviations of a distance, ten of a prediction.
const TIGHTER: (f64, f64) = (9.0, 8.0);
/// More candidates than this in a row are cut off: no recording has them, and the search is quadratic.
const MOST_CANDIDATES: usize = 64;

/// Whether a point goes by this name: its own, or the part behind an asset's name and a colon.
pub(super) fn is_called(point: &TrackPoint, name: &str) -> bool {
    point.name == name
        || point
            .name
            .rsplit_once(':')
            .is_some_and(|(_, last)| last == name)
}

/// The points that a reflector may be called by; measured ones if there are any.
fn labelled(
    track: &TrackFile,
    reflector: &Reflector,
    which: &'static str,
) -> Result<Vec<usize>, PoseError> {
    let matching = |accept: &dyn Fn(&TrackPoint) -> bool| -> Vec<usize> {
        let found: Vec<usize> = (0..track.points.len())
            .filter(|i| track.points.get(*i).is_some_and(accept))
            .collect();
        let measured = |i: &usize| {
            track
                .points
                .get(*i)
                .is_some_and(|point| point.kind.is_measured())
        };
        if found.iter().any(measured) {
            found.into_iter().filter(measured).collect()
        } else {
            found
        }
    };
    let (found, wanted) = match &reflector.point {
        PointName::Auto => return Ok(Vec::new()),
        PointName::Named(name) => {
            let exact = matching(&|point| point.name == *name);
            (
                if exact.is_empty() {
                    matching(&|point| is_called(point, name))
                } else {
                    exact
                },
                name.clone(),
            )
        }
        PointName::Columns(x, y) => {
            let pair = |point: &TrackPoint| matches!(point.columns.as_slice(), [a, b, ..] if a == x && b == y);
            (matching(&pair), format!("{x}, {y}"))
        }
    };
    if found.is_empty() {
        let mut names: Vec<&str> = track
            .points
            .iter()
            .map(|point| point.name.as_str())
            .take(20)
            .collect();
        names.dedup();
        return Err(PoseError::NoPoint {
            reflector: which,
            wanted,
            points: names.join(", "),
        });
    }
    Ok(found)
}

struct Search<'a> {
    track: &'a TrackFile,
    pool: Vec<usize>,
    fronts: Vec<usize>,
    backs: Vec<usize>,
    distance: f64,
    tolerance: f64,
    reach: f64,
}

/// A candidate of a row: which point, and where.
type Candidate = (usize, Vector3<f64>);

impl Search<'_> {
    fn candidates(&self, row: usize, out: &mut Vec<Candidate>) {
        out.clear();
        let seen = self
            .pool
            .iter()
            .filter_map(|i| Some((*i, self.track.points.get(*i)?.position(row)?)));
        out.extend(seen.take(MOST_CANDIDATES));
    }

    fn fits(&self, a: &Vector3<f64>, b: &Vector3<f64>) -> bool {
        ((a - b).norm() - self.distance).abs() < self.tolerance
    }

    /// Limits from the distances and the misses of predictions that were met.
    fn tighten(&mut self, rows: &[Row]) {
        let distances = rows.iter().map(|row| (row.front - row.back).norm());
        let Some(distance) = median(distances.clone()) else {
            return;
        };
        let deviation = median(distances.map(|d| (d - distance).abs())).unwrap_or(0.0);
        let miss = median(rows.iter().filter_map(|row| row.miss)).unwrap_or(0.0);
        self.distance = distance;
        self.tolerance =
            (TIGHTER.0 * deviation).clamp(2e-3 * distance, self.tolerance.max(2e-3 * distance));
        self.reach = (TIGHTER.1 * miss).clamp(5e-3 * distance, REACH.0 * distance);
    }

    /// Whether the labels of a chosen pair agree with the choice.
    fn labels(&self, front: usize, back: usize) -> Option<bool> {
        let says = |which: &[usize], i| which.contains(&i);
        let agrees = usize::from(says(&self.fronts, front)) + usize::from(says(&self.backs, back));
        let contradicts =
            usize::from(says(&self.fronts, back)) + usize::from(says(&self.backs, front));
        (agrees != contradicts).then_some(agrees > contradicts)
    }

    /// The best ordered pair by a cost that may refuse it.
    fn best(
        &self,
        candidates: &[Candidate],
        cost: impl Fn(&Candidate, &Candidate) -> Option<f64>,
    ) -> Option<(Candidate, Candidate)> {
        let mut best: Option<(f64, Candidate, Candidate)> = None;
        for front in candidates {
            for back in candidates
                .iter()
                .filter(|back| back.0 != front.0 && self.fits(&front.1, &back.1))
            {
                if let Some(cost) = cost(front, back)
                    .filter(|cost| best.as_ref().is_none_or(|(least, ..)| cost < least))
                {
                    best = Some((cost, *front, *back));
                }
            }
        }
        best.map(|(_, front, back)| (front, back))
    }

    /// Where nothing is known of the past: labels first, then the better distance.
    fn begin(&self, candidates: &[Candidate]) -> Option<(Candidate, Candidate)> {
        self.best(candidates, |front, back| {
            let misfit = ((front.1 - back.1).norm() - self.distance).abs() / self.tolerance;
            Some(
                misfit
                    + match self.labels(front.0, back.0) {
                        Some(true) => 0.0,
                        None => 2.0,
                        Some(false) => 4.0,
                    },
            )
        })
    }
}

/// Place and velocity of a reflector.
#[derive(Clone, Copy)]
struct Motion {
    place: Vector3<f64>,
    velocity: Vector3<f64>,
}

impl Motion {
    fn new(place: Vector3<f64>) -> Self {
        Self {
            place,
            velocity: Vector3::zeros(),
        }
    }

    fn moved(self, place: Vector3<f64>, dt: f64) -> Self {
        let weight = (dt / SMOOTHING_S).min(1.0);
        let velocity = self.velocity + ((place - self.place) / dt - self.velocity) * weight;
        Self { place, velocity }
    }

    fn after(self, dt: f64) -> Vector3<f64> {
        self.place + self.velocity * dt
    }
}

pub(super) fn follow(
    track: &TrackFile,
    reflectors: &Reflectors,
    options: &PoseOptions,
) -> Result<Followed, PoseError> {
    let [a, b] = [reflectors.front.at, reflectors.back.at];
    let expected_m = (a[0] - b[0]).hypot(a[1] - b[1]);
    if !(expected_m.is_finite() && expected_m > 0.0) {
        return Err(PoseError::SamePlace);
    }
    let mut search = prepare(track, reflectors, expected_m, options)?;
    // First with wide limits, then with limits that fit this recording's noise: a ghost must not pass for a lost reflector.
    let (rows, _) = walk(&search);
    search.tighten(&rows);
    let (rows, starts) = walk(&search);
    if rows.is_empty() {
        return Err(PoseError::NoPair {
            expected_m,
            tolerance_m: search.tolerance,
            frames: track.frames(),
            hint: String::new(),
        });
    }
    let named = !matches!(reflectors.front.point, PointName::Auto)
        || !matches!(reflectors.back.point, PointName::Auto);
    let mut followed = settle(rows, &starts, track.frames(), expected_m);
    followed.order_known = named && followed.rows.iter().any(|row| row.labels.is_some());
    let mut candidates = Vec::new();
    for row in &followed.rows {
        search.candidates(row.index, &mut candidates);
        followed.report.ghosts_rejected += candidates.len().saturating_sub(2);
    }
    Ok(followed)
}

/// Candidates, hints and the distance to look for.
fn prepare<'a>(
    track: &'a TrackFile,
    reflectors: &Reflectors,
    expected_m: f64,
    options: &PoseOptions,
) -> Result<Search<'a>, PoseError> {
    let fronts = labelled(track, &reflectors.front, "front")?;
    let backs = labelled(track, &reflectors.back, "back")?;
    let measured = |i: &usize| {
        track
            .points
            .get(*i)
            .is_some_and(|point| point.kind.is_measured())
    };
    let mut pool: Vec<usize> = (0..track.points.len()).filter(measured).collect();
    pool.extend(fronts.iter().chain(&backs).filter(|i| !measured(i)));
    pool.sort_unstable();
    pool.dedup();
    let tolerance = options.distance_tolerance * expected_m;
    let mut search = Search {
        track,
        pool,
        fronts,
        backs,
        distance: expected_m,
        tolerance,
        reach: REACH.0 * expected_m,
    };
    if !search.fronts.is_empty() && !search.backs.is_empty() {
        if let Some(measured_m) = labelled_distance(&search) {
            if (measured_m / expected_m - 1.0).abs() > options.distance_tolerance {
                return Err(PoseError::Distance {
                    measured_m,
                    expected_m,
                    scale: expected_m / measured_m,
                });
            }
            search.distance = measured_m;
        }
    } else {
        find_labels(&mut search);
    }
    Ok(search)
}

/// Median distance of the labelled points.
fn labelled_distance(search: &Search<'_>) -> Option<f64> {
    let first = |which: &[usize], row| {
        which
            .iter()
            .find_map(|i| search.track.points.get(*i)?.position(row))
    };
    let distance = |row| Some((first(&search.fronts, row)? - first(&search.backs, row)?).norm());
    median((0..search.track.frames()).filter_map(distance))
}

fn median(values: impl Iterator<Item = f64>) -> Option<f64> {
    let mut values: Vec<f64> = values.collect();
    let middle = values.len() / 2;
    (!values.is_empty()).then(|| *values.select_nth_unstable_by(middle, f64::total_cmp).1)
}

/// Without names: the two points that are most often the right distance apart serve as labels, in either order.
fn find_labels(search: &mut Search<'_>) {
    let mut counts: HashMap<(usize, usize), usize> = HashMap::new();
    let mut candidates = Vec::new();
    let allowed = |search: &Search<'_>, i: usize, j: usize| {
        let one = |named: &[usize]| named.is_empty() || named.contains(&i) || named.contains(&j);
        one(&search.fronts) && one(&search.backs)
    };
    for row in 0..search.track.frames() {
        search.candidates(row, &mut candidates);
        for (index, (i, a)) in candidates.iter().enumerate() {
            for (j, b) in candidates.iter().skip(index + 1) {
                if search.fits(a, b) && allowed(search, *i, *j) {
                    *counts.entry((*i, *j)).or_default() += 1;
                }
            }
        }
    }
    // The first pair of the file where two are as frequent, so that the answer does not hang on the map's order.
    let best = counts
        .into_iter()
        .max_by_key(|(pair, count)| (*count, std::cmp::Reverse(*pair)));
    if let Some(((i, j), _)) = best {
        let (front, back) = if search.fronts.contains(&j) || search.backs.contains(&i) {
            (j, i)
        } else {
            (i, j)
        };
        search.fronts = vec![front];
        search.backs = vec![back];
    }
}

/// Through all rows; returns them with the index in them at which each segment starts.
fn walk(search: &Search<'_>) -> (Vec<Row>, Vec<usize>) {
    let (mut rows, mut starts): (Vec<Row>, Vec<usize>) = (Vec::new(), Vec::new());
    let mut state: Option<(f64, Motion, Motion)> = None;
    let mut top_speed: f64 = 0.0;
    let mut candidates = Vec::new();
    for (row, time) in search.track.times.iter().copied().enumerate() {
        search.candidates(row, &mut candidates);
        if candidates.len() < 2 {
            continue;
        }
        let longest = if top_speed > 0.0 {
            search.distance / (2.0 * top_speed)
        } else {
            FIRST_GAP_S
        };
        state = state.filter(|(then, ..)| time - then <= longest.max(2.5 / search.track.rate_hz));
        let found = match &state {
            None => search.begin(&candidates),
            Some((then, front, back)) => {
                // Beyond the usual step from frame to frame, what a turn at top speed could add.
                let speed = if top_speed > 0.0 {
                    top_speed
                } else {
                    search.distance / FIRST_GAP_S
                };
                let blind = (time - then - 1.5 / search.track.rate_hz).max(0.0);
                let reach = (search.reach + 2.0 * speed * blind).min(REACH.1 * search.distance);
                let (front, back) = (front.after(time - then), back.after(time - then));
                search.best(&candidates, |f, b| {
                    let miss = (f.1 - front).norm_squared() + (b.1 - back).norm_squared();
                    (miss < reach * reach).then_some(miss)
                })
            }
        };
        let Some((front, back)) = found else { continue };
        let miss = state.as_ref().map(|(then, f, b)| {
            let dt = time - then;
            (front.1 - f.after(dt))
                .norm()
                .hypot((back.1 - b.after(dt)).norm())
        });
        state = Some(match state {
            None => {
                starts.push(rows.len());
                (time, Motion::new(front.1), Motion::new(back.1))
            }
            Some((then, f, b)) => {
                let (f, b) = (f.moved(front.1, time - then), b.moved(back.1, time - then));
                // Noise alone is fast from one frame to the next; the smoothed velocity after some time is not.
                let old_enough = starts.last().is_some_and(|start| rows.len() - start > 50);
                if old_enough {
                    top_speed = top_speed.max(f.velocity.norm()).max(b.velocity.norm());
                }
                (time, f, b)
            }
        });
        rows.push(Row {
            index: row,
            front: front.1,
            back: back.1,
            labels: search.labels(front.0, back.0),
            miss,
        });
    }
    (rows, starts)
}

/// Lets the labels of each segment decide which end is the front, and counts.
fn settle(rows: Vec<Row>, starts: &[usize], frames: usize, expected_m: f64) -> Followed {
    let length = rows.len();
    let ends = starts.iter().skip(1).copied().chain([length]);
    let mut segments: Vec<(usize, usize, Option<bool>)> = Vec::new();
    for (start, end) in starts.iter().copied().zip(ends) {
        let votes = rows
            .get(start..end)
            .unwrap_or(&[])
            .iter()
            .filter_map(|row| row.labels);
        let balance: i64 = votes.map(|agrees| if agrees { 1 } else { -1 }).sum();
        segments.push((start, end, (balance != 0).then_some(balance > 0)));
    }
    // A segment that no label speaks for is of use only if it is the only one.
    let silent = segments.len() > 1;
    let mut kept = Vec::with_capacity(length);
    let (mut swaps, mut lost_segments, mut lost_rows, mut index) = (0, 0, 0, 0);
    let mut rows = rows.into_iter();
    for (start, end, verdict) in segments {
        debug_assert_eq!(start, index);
        index = end;
        let segment = rows.by_ref().take(end - start);
        if verdict.is_none() && silent {
            lost_segments += 1;
            lost_rows += segment.count();
            continue;
        }
        let exchange = verdict == Some(false);
        let mut contradicted = false;
        for mut row in segment {
            if exchange {
                std::mem::swap(&mut row.front, &mut row.back);
                row.labels = row.labels.map(|agrees| !agrees);
            }
            if let Some(agrees) = row.labels {
                swaps += usize::from(!agrees && !contradicted);
                contradicted = !agrees;
            }
            kept.push(row);
        }
    }
    let count = kept.len().max(1) as f64;
    let distance = |row: &Row| (row.front - row.back).norm();
    let distance_m = kept.iter().map(distance).sum::<f64>() / count;
    let variance = kept
        .iter()
        .map(|row| (distance(row) - distance_m).powi(2))
        .sum::<f64>()
        / count;
    Followed {
        report: FollowReport {
            followed: kept.len(),
            missing: frames - kept.len(),
            swaps_repaired: swaps,
            ghosts_rejected: 0,
            segments: starts.len(),
            distance_m,
            distance_sd_m: variance.sqrt(),
        },
        rows: kept,
        expected_m,
        order_known: false,
        lost_segments,
        lost_rows,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::PointKind;

    #[test]
    fn names_may_stand_behind_an_asset() {
        let point = |name: &str| {
            TrackPoint::new(
                name.to_owned(),
                PointKind::Marker,
                String::new(),
                Vec::new(),
            )
        };
        assert!(is_called(&point("Front"), "Front") && is_called(&point("robot:Front"), "Front"));
        assert!(
            !is_called(&point("Front2"), "Front") && !is_called(&point("Front"), "robot:Front")
        );
    }
}
