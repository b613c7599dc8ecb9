//! One point of a tracking file and where it was.

use std::fmt;

use nalgebra::{Quaternion, UnitQuaternion, Vector3};
use swimmer_files::PointName;

/// Type of a group of columns.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum PointKind {
    /// A measured marker that the tracker has a name for.
    Marker,
    /// A measured marker without a name of its own.
    Unlabeled,
    /// The pivot of a rigid body: solved, not measured.
    RigidBody,
    /// A marker where the solved rigid body says it is: vanishes with the body, and not blank when the marker is hidden.
    RigidBodyMarker,
    /// Any other type, kept but never used for poses unless it is named.
    Other,
}

impl PointKind {
    /// Type of a marker by its name.
    pub(super) fn of_marker(name: &str) -> Self {
        if is_unlabeled(name) {
            Self::Unlabeled
        } else {
            Self::Marker
        }
    }

    /// Returns `true` if cameras saw this point itself.
    pub fn is_measured(self) -> bool {
        matches!(self, Self::Marker | Self::Unlabeled)
    }
}

impl fmt::Display for PointKind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Marker => "marker",
            Self::Unlabeled => "unlabeled",
            Self::RigidBody => "rigid-body",
            Self::RigidBodyMarker => "rigid-body-marker",
            Self::Other => "other",
        })
    }
}

/// `Unlabeled:108` (1.21), `Unlabeled 2278` (1.23 on), `Marker-49813`, alone or after an asset's name and a colon.
fn is_unlabeled(name: &str) -> bool {
    let digits = |rest: &str| !rest.is_empty() && rest.bytes().all(|b| b.is_ascii_digit());
    name.strip_prefix("Unlabeled")
        .is_some_and(|rest| digits(rest.trim_start_matches([' ', ':', '-'])))
        || name.strip_prefix("Marker-").is_some_and(digits)
}

/// One point and where it was in every row.
#[derive(Debug, Clone)]
pub struct TrackPoint {
    /// Its name, as in the file (without quotes).
    pub name: String,
    /// Type.
    pub kind: PointKind,
    /// Its ID in the file; empty where the file has none.
    pub id: String,
    /// The names of its columns in a plain table (x, y and perhaps z); empty otherwise.
    pub columns: Vec<String>,
    /// `true` if positions are kept, `false` if they are only counted.
    keeps: bool,
    /// `true` if the file gives its orientation.
    oriented: bool,
    presence: Presence,
    /// First row and first place of each run of rows in which it is there. Markers come and go: what is missing costs nothing.
    runs: Vec<(usize, usize)>,
    /// The places of all runs \[m\].
    places: Vec<[f64; 3]>,
    /// The orientations of all runs (x, y, z, w), if the file gives any; NaN if a row has none.
    turns: Vec<[f64; 4]>,
}

/// In which rows a point was, counted as they go by.
#[derive(Debug, Clone, Copy, Default)]
struct Presence {
    present: usize,
    gaps: usize,
    longest_gap: usize,
    /// The row after the last one that counts.
    next: usize,
}

impl Presence {
    /// Missing until this row.
    fn missing_until(&mut self, row: usize) {
        let gap = row.saturating_sub(self.next);
        self.gaps += usize::from(gap > 0);
        self.longest_gap = self.longest_gap.max(gap);
    }
}

impl TrackPoint {
    pub(crate) fn new(name: String, kind: PointKind, id: String, columns: Vec<String>) -> Self {
        Self {
            name,
            kind,
            id,
            columns,
            keeps: true,
            oriented: false,
            presence: Presence::default(),
            runs: Vec::new(),
            places: Vec::new(),
            turns: Vec::new(),
        }
    }

    /// The same point with orientations.
    pub(super) fn oriented(mut self) -> Self {
        self.oriented = true;
        self
    }

    /// Returns `true` if the file gives the point's orientation.
    pub fn is_oriented(&self) -> bool {
        self.oriented
    }

    /// Returns `true` if the user may call the point by this name: its own, the part after an asset's name and a colon, or its
    /// columns.
    pub(crate) fn goes_by(&self, name: &PointName) -> bool {
        match name {
            PointName::Named(name) => self.is_called(name),
            PointName::Columns(x, y) => {
                matches!(self.columns.as_slice(), [a, b, ..] if a == x && b == y)
            }
            PointName::Auto | PointName::Near(_) => false,
        }
    }

    /// Returns `true` if the point has this name: its own, or the part after an asset's name and a colon.
    pub(crate) fn is_called(&self, name: &str) -> bool {
        is_called(&self.name, name)
    }

    /// Before the first place: whether places are kept, or only counted.
    pub(super) fn keep_places(&mut self, keeps: bool) {
        self.keeps = keeps;
    }

    /// Position of the point in this row \[m\], in the file's own axes. Returns `None` if it is missing.
    pub fn position(&self, row: usize) -> Option<Vector3<f64>> {
        let place = self.index(row)?;
        self.places.get(place).copied().map(Vector3::from)
    }

    /// The point's orientation in this row, in the file's own axes: turns vectors of the body into the file's frame. `None` if the
    /// point or its orientation is missing.
    pub fn orientation(&self, row: usize) -> Option<UnitQuaternion<f64>> {
        let [x, y, z, w] = self.turns.get(self.index(row)?).copied()?;
        UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6)
    }

    /// The index among the kept places of this row's.
    fn index(&self, row: usize) -> Option<usize> {
        let index = self.runs.partition_point(|(start, _)| *start <= row);
        let (start, first) = *self.runs.get(index.checked_sub(1)?)?;
        let place = first + (row - start);
        let end = self.runs.get(index).map_or(self.places.len(), |run| run.1);
        (place < end).then_some(place)
    }

    /// In how many rows it is there.
    pub fn present(&self) -> usize {
        self.presence.present
    }

    /// Number of gaps.
    pub fn gaps(&self) -> usize {
        self.presence.gaps
    }

    /// The longest run of rows that it is missing in.
    pub fn longest_gap(&self) -> usize {
        self.presence.longest_gap
    }

    /// It was there in this row; rows come in order, and the first place in a row holds.
    pub(super) fn push(&mut self, row: usize, place: [f64; 3]) {
        self.push_pose(row, place, None);
    }

    /// The same with its orientation (x, y, z, w).
    pub(super) fn push_pose(&mut self, row: usize, place: [f64; 3], turn: Option<[f64; 4]>) {
        if row < self.presence.next {
            return;
        }
        if self.keeps {
            let next = self
                .runs
                .last()
                .map(|(start, first)| start + self.places.len() - first);
            if next != Some(row) {
                self.runs.push((row, self.places.len()));
            }
            self.places.push(place);
            if self.oriented {
                self.turns.push(turn.unwrap_or([f64::NAN; 4]));
            }
        }
        self.count(row);
    }

    /// Counts a row in which the point is there, without keeping its place.
    pub(super) fn count(&mut self, row: usize) {
        if row < self.presence.next {
            return;
        }
        self.presence.missing_until(row);
        self.presence.present += 1;
        self.presence.next = row + 1;
    }

    /// So many rows has the file.
    pub(super) fn finish(&mut self, rows: usize) {
        self.presence.missing_until(rows);
        self.presence.next = self.presence.next.max(rows);
    }
}

/// Returns `true` if a point or body whose whole name is `own` goes by `name`: its own, or the part after an asset's name and a colon.
///
/// ```
/// use calibrate::is_called;
///
/// assert!(is_called("robot:Front", "Front") && !is_called("Front", "robot:Front"));
/// ```
pub fn is_called(own: &str, name: &str) -> bool {
    let asset = own.rsplit_once(':');
    own == name || asset.is_some_and(|(_, last)| last == name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_may_stand_behind_an_asset() {
        let point = |name: &str| {
            let name = name.to_owned();
            TrackPoint::new(name, PointKind::Marker, String::new(), Vec::new())
        };
        assert!(point("Front").is_called("Front") && point("robot:Front").is_called("Front"));
        assert!(!point("Front2").is_called("Front") && !point("Front").is_called("robot:Front"));
    }

    #[test]
    fn runs_and_gaps() {
        let mut point = TrackPoint::new("p".into(), PointKind::Marker, String::new(), Vec::new());
        for row in [2, 3, 6, 7, 8] {
            point.push(row, [row as f64, 0.0, 0.0]);
        }
        point.finish(12);
        let seen: Vec<Option<f64>> = (0..13)
            .map(|row| point.position(row).map(|p| p.x))
            .collect();
        let at = |x: f64| Some(x);
        let none = None;
        assert_eq!(
            seen,
            [
                none,
                none,
                at(2.0),
                at(3.0),
                none,
                none,
                at(6.0),
                at(7.0),
                at(8.0),
                none,
                none,
                none,
                none
            ]
        );
        assert_eq!(
            (point.present(), point.gaps(), point.longest_gap()),
            (5, 3, 3)
        );
        let mut never = TrackPoint::new("n".into(), PointKind::Marker, String::new(), Vec::new());
        never.finish(4);
        assert_eq!(
            (never.present(), never.gaps(), never.longest_gap()),
            (0, 1, 4)
        );
    }
}
