//! Search for two reflectors: candidates, labels as hints, and the expected distance.

use std::collections::HashMap;

use nalgebra::Vector3;
use swimmer_files::{PointName, Reflector, Reflectors};

use super::Row;
use crate::median::median;
use crate::poses::{PoseError, PoseOptions};
use crate::{TrackFile, TrackPoint};

/// Tolerance of both reflectors about their predicted positions from one row to the next, over their distance; and after a gap,
/// or they could be exchanged.
pub(super) const REACH: (f64, f64) = (0.3, 0.45);
/// Limits after a gap over the medians of a first pass: six standard deviations of a distance, ten of a prediction.
const TIGHTER: (f64, f64) = (9.0, 8.0);
/// Largest noise of the reflectors' distance that is allowed for, as a share of it.
const MOST_NOISE: f64 = 0.3;
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
    pub(super) fronts: Vec<usize>,
    pub(super) backs: Vec<usize>,
    pub(super) distance: f64,
    pub(super) tolerance: f64,
    /// Limits after a gap, when a ghost may stand where a reflector is expected: of the distance, and of both together to
    /// their predicted places \[m\].
    pub(super) after_gap: (f64, f64),
}

/// A candidate of a row: which point, and where.
pub(super) type Candidate = (usize, Vector3<f64>);

impl<'a> Search<'a> {
    /// Without candidates: the reflectors are not to be searched for.
    pub(super) fn of_nothing(track: &'a TrackFile, distance: f64) -> Self {
        Self {
            track,
            pool: Vec::new(),
            fronts: Vec::new(),
            backs: Vec::new(),
            distance,
            tolerance: 0.0,
            after_gap: (0.0, 0.0),
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
                if self.is_label(point) {
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

    fn is_label(&self, point: usize) -> bool {
        self.fronts.contains(&point) || self.backs.contains(&point)
    }

    fn fits(&self, a: &Vector3<f64>, b: &Vector3<f64>, tolerance: f64) -> bool {
        ((a - b).norm() - self.distance).abs() < tolerance
    }

    /// Limits after a gap from the distances and the misses of predictions that were met: there a ghost must not pass for a
    /// lost reflector. From row to row such limits would lose real reflectors, whose distances have long tails.
    pub(super) fn learn(&mut self, rows: &[Row]) {
        let distances = rows.iter().map(|row| (row.front - row.back).norm());
        let Some(distance) = median(distances.clone()) else {
            return;
        };
        let deviation = median(distances.map(|d| (d - distance).abs())).unwrap_or(0.0);
        let miss = median(rows.iter().filter_map(|row| row.miss)).unwrap_or(0.0);
        self.distance = distance;
        // Noise of the cameras may be wider than the usual tolerance.
        let noise = (TIGHTER.0 * deviation).min(MOST_NOISE * distance);
        self.tolerance = self.tolerance.max(noise);
        let widest = self.tolerance.max(2e-3 * distance);
        self.after_gap = (
            (TIGHTER.0 * deviation).clamp(2e-3 * distance, widest),
            (TIGHTER.1 * miss).clamp(5e-3 * distance, REACH.0 * distance),
        );
    }

    /// Number of labels of a chosen pair that agree with the choice, and that contradict it.
    fn votes(&self, front: usize, back: usize) -> (f64, f64) {
        let says = |which: &[usize], i| f64::from(u8::from(which.contains(&i)));
        (
            says(&self.fronts, front) + says(&self.backs, back),
            says(&self.fronts, back) + says(&self.backs, front),
        )
    }

    /// Returns `true` if the labels of a chosen pair agree with the choice.
    pub(super) fn labels(&self, front: usize, back: usize) -> Option<bool> {
        let (agrees, contradicts) = self.votes(front, back);
        let most = agrees.total_cmp(&contradicts);
        most.is_ne().then_some(most.is_gt())
    }

    pub(super) fn has_both_labels(&self, front: usize, back: usize) -> bool {
        self.fronts.contains(&front) && self.backs.contains(&back)
    }

    /// The best ordered pair by a cost that may refuse it.
    pub(super) fn best(
        &self,
        candidates: &[Candidate],
        tolerance: f64,
        cost: impl Fn(&Candidate, &Candidate) -> Option<f64>,
    ) -> Option<(Candidate, Candidate)> {
        let mut best: Option<(f64, Candidate, Candidate)> = None;
        for front in candidates {
            for back in candidates
                .iter()
                .filter(|back| back.0 != front.0 && self.fits(&front.1, &back.1, tolerance))
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

    /// First pair, without a past: by labels, then by distance.
    pub(super) fn begin(&self, candidates: &[Candidate]) -> Option<(Candidate, Candidate)> {
        self.best(candidates, self.tolerance, |front, back| {
            let misfit = ((front.1 - back.1).norm() - self.distance).abs() / self.tolerance;
            let (agrees, contradicts) = self.votes(front.0, back.0);
            Some(misfit + 2.0 - agrees + contradicts)
        })
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
    let tolerance = options.distance_tolerance * expected_m;
    let mut search = Search {
        track,
        pool,
        fronts,
        backs,
        distance: expected_m,
        tolerance,
        after_gap: (tolerance, 0.1 * expected_m),
    };
    if !search.fronts.is_empty() && !search.backs.is_empty() {
        if let Some(measured_m) = median_distance(track, &search.fronts, &search.backs) {
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
        one(&search.fronts) && one(&search.backs)
    };
    for row in 0..search.track.frames() {
        search.candidates(row, &mut candidates);
        for (index, (i, a)) in candidates.iter().enumerate() {
            for (j, b) in candidates.iter().skip(index + 1) {
                if search.fits(a, b, search.tolerance) && allowed(search, *i, *j) {
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
