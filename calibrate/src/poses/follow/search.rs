//! Search for two reflectors: candidates, labels as hints, and the expected distance.

use std::collections::HashMap;

use swimmer_files::{PointName, Reflector, Reflectors};

use super::Row;
use super::pairs::{Candidate, Pairs};
use crate::median::median;
use crate::poses::{PoseError, PoseOptions};
use crate::{TrackFile, TrackPoint};

/// More candidates than this in a row are cut off: no recording has them, and the search is quadratic.
const MOST_CANDIDATES: usize = 64;

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
        PointName::Auto | PointName::Near(_) => return Ok(Vec::new()),
        PointName::Named(name) => {
            let exact = matching(&|point| point.name == *name);
            (
                if exact.is_empty() {
                    matching(&|point| point.is_called(name))
                } else {
                    exact
                },
                name.clone(),
            )
        }
        columns @ PointName::Columns(x, y) => {
            let pair = |point: &TrackPoint| point.goes_by(columns);
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

pub(super) struct Search<'a> {
    pub(super) track: &'a TrackFile,
    pub(super) pool: Vec<usize>,
    pub(super) pairs: Pairs,
}

impl<'a> Search<'a> {
    /// Without candidates: the reflectors are not to be searched for.
    pub(super) fn of_nothing(track: &'a TrackFile, distance: f64) -> Self {
        Self {
            track,
            pool: Vec::new(),
            pairs: Pairs {
                fronts: Vec::new(),
                backs: Vec::new(),
                distance,
                tolerance: 0.0,
                after_gap: (0.0, 0.0),
                step_s: track.rate_hz.recip(),
            },
        }
    }
}

impl Search<'_> {
    pub(super) fn candidates(&self, row: usize, out: &mut Vec<Candidate>) {
        out.clear();
        let seen = self
            .pool
            .iter()
            .filter_map(|i| Some((*i, self.track.points.get(*i)?.position(row)?)));
        for (point, place) in seen {
            // Record lines give a body's marker twice, in its own record and in the frame's list: it is one candidate.
            if let Some(same) = out.iter_mut().find(|(_, there)| *there == place) {
                if self.pairs.is_label(point) {
                    same.0 = point;
                }
            } else if out.len() < MOST_CANDIDATES {
                out.push((point, place));
            }
        }
    }

    /// Time of a row \[s\].
    pub(super) fn time(&self, row: &Row) -> f64 {
        self.track.times.get(row.index).copied().unwrap_or(0.0)
    }
}

/// Candidates, hints and the distance to look for.
pub(super) fn prepare<'a>(
    track: &'a TrackFile,
    reflectors: &Reflectors,
    expected_m: f64,
    options: &PoseOptions,
) -> Result<Search<'a>, PoseError> {
    let fronts = labelled(track, &reflectors.front, "front")?;
    let backs = labelled(track, &reflectors.back, "back")?;
    if let ([front], [back]) = (fronts.as_slice(), backs.as_slice())
        && front == back
    {
        let point = track.points.get(*front).map(|point| point.name.clone());
        return Err(PoseError::SamePoint {
            point: point.unwrap_or_default(),
        });
    }
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
    let mut search = Search {
        track,
        pool,
        pairs: Pairs {
            fronts,
            backs,
            step_s: track.rate_hz.recip(),
            ..Pairs::new(expected_m, options.distance_tolerance)
        },
    };
    if !search.pairs.fronts.is_empty() && !search.pairs.backs.is_empty() {
        if let Some(measured_m) = median_distance(track, &search.pairs.fronts, &search.pairs.backs)
        {
            if (measured_m / expected_m - 1.0).abs() > options.distance_tolerance {
                return Err(PoseError::Distance {
                    measured_m,
                    expected_m,
                    scale: expected_m / measured_m,
                });
            }
            search.pairs.distance = measured_m;
        }
    } else {
        find_labels(&mut search);
    }
    Ok(search)
}

/// The scale at which the named points, or the only two, have the reflectors' distance.
pub(super) fn scale(track: &TrackFile, reflectors: &Reflectors, expected_m: f64) -> Option<f64> {
    let fronts = labelled(track, &reflectors.front, "front").ok()?;
    let backs = labelled(track, &reflectors.back, "back").ok()?;
    let distance = match (fronts.as_slice(), backs.as_slice()) {
        ([], _) | (_, []) if track.points.len() == 2 => median_distance(track, &[0], &[1]),
        _ => median_distance(track, &fronts, &backs),
    };
    distance.map(|distance| expected_m / distance)
}

/// Median distance of two points that may go by several names.
fn median_distance(track: &TrackFile, fronts: &[usize], backs: &[usize]) -> Option<f64> {
    let first = |which: &[usize], row| {
        which
            .iter()
            .find_map(|i| track.points.get(*i)?.position(row))
    };
    let distance = |row| Some((first(fronts, row)? - first(backs, row)?).norm());
    median((0..track.frames()).filter_map(distance))
}

/// Without names: the two points that are most often the right distance apart serve as labels, in either order.
fn find_labels(search: &mut Search<'_>) {
    let mut counts: HashMap<(usize, usize), usize> = HashMap::new();
    let mut candidates = Vec::new();
    let allowed = |search: &Search<'_>, i: usize, j: usize| {
        let one = |named: &[usize]| named.is_empty() || named.contains(&i) || named.contains(&j);
        one(&search.pairs.fronts) && one(&search.pairs.backs)
    };
    for row in 0..search.track.frames() {
        search.candidates(row, &mut candidates);
        for (index, (i, a)) in candidates.iter().enumerate() {
            for (j, b) in candidates.iter().skip(index + 1) {
                if search.pairs.fits(a, b, search.pairs.tolerance) && allowed(search, *i, *j) {
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
        let (front, back) = if search.pairs.fronts.contains(&j) || search.pairs.backs.contains(&i) {
            (j, i)
        } else {
            (i, j)
        };
        search.pairs.fronts = vec![front];
        search.pairs.backs = vec![back];
    }
}
