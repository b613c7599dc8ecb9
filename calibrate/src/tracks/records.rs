//! Record lines: Tracking Tools 2.x (1.0) and Motive 1.x (1.1). The first word gives the kind of line, and its own counts give
//! the number of its fields; every line is checked against them.
//!
//! The same word (`trackable`, `rigidbody`) defines a body before the first frame, and adds data about one after it. The point
//! cloud of a body's record consists of measured places under the body's names; its solved places are kept from the last
//! sight of the body, so they count only while it is tracked. Markers of a frame have no identity in version 1.0 (their order
//! changes from frame to frame): they are listed by their place in the list, and following ignores those names.

mod body;
mod record;

use std::collections::HashMap;
use std::path::Path;

use super::cells::Cells;
use super::grid::Body;
use super::lines::{Delimiter, Lines, TextLine};
use super::number::Number;
use super::rows::{TakesRows, read_rows};
use super::timeline::Timeline;
use super::{
    Draft, PointKind, Reading, TrackError, TrackFormat, TrackPoint, TrackProblem, TrackWarning,
    Unit, UsedPoints,
};
use body::{FramePose, RigidBody, TrackedBodies, owners};
use record::{Coordinates, Record};

/// Markers that a frame, or bodies that a file may have; more is a broken count.
const MOST: usize = 100_000;

/// # Errors
/// [`TrackError::Broken`] with line and column.
pub(super) fn read(
    lines: &mut Lines<'_>,
    reading: &Reading<'_>,
    delimiter: Delimiter,
) -> Result<Draft, TrackError> {
    let Reading { file, options, .. } = *reading;
    let (unit, metres, overridden) = options.unit(Unit::Metre);
    let mut reader = Reader::new(metres, reading.keeps_places, options.used.clone());
    reader.warnings.extend(overridden);
    let mut taker = Records {
        reader,
        delimiter,
        file,
        cells: Cells::default(),
    };
    let cut = read_rows(lines, file, 0, &mut taker)?;
    let mut reader = taker.reader;
    reader.warnings.extend(cut);
    Ok(reader.finish(unit))
}

/// Lines cut into records for the reader.
struct Records<'f> {
    reader: Reader,
    delimiter: Delimiter,
    file: &'f Path,
    cells: Cells,
}

impl TakesRows for Records<'_> {
    fn take_line(&mut self, line: &TextLine<'_>) -> Result<(), TrackError> {
        let record = Record::read(line, self.delimiter, self.file, &mut self.cells)?;
        self.reader.take(&record)
    }

    fn has_rows(&self) -> bool {
        self.reader.timeline.len() > 0
    }
}

struct Reader {
    metres: f64,
    /// Fields of a frame's marker and of a solved one: 4 and 3 in version 1.0, 5 and 4 in 1.1.
    strides: (usize, usize),
    version: String,
    left_handed: bool,
    frames: Option<u64>,
    timeline: Timeline,
    keeps_places: bool,
    /// Points that poses will be taken from, if known.
    used: Option<UsedPoints>,
    /// Frames that are not in the file: how often, how many.
    skipped: (usize, u64),
    points: Vec<TrackPoint>,
    bodies: Vec<RigidBody>,
    /// Poses of the frame whose records are being read, and what these say of the bodies' markers.
    poses: Vec<FramePose>,
    seen: TrackedBodies,
    /// Poses that went to a body of another number, and poses that no body's markers explain.
    renumbered: (usize, usize),
    /// `true` if no body was defined before the first frame.
    undefined: bool,
    /// Points of a frame's markers: by place in the list (1.0) or by number (1.1).
    markers: HashMap<String, usize>,
    half_blank: Option<(usize, usize)>,
    warnings: Vec<TrackWarning>,
}

impl Reader {
    fn new(metres: f64, keeps_places: bool, used: Option<UsedPoints>) -> Self {
        Self {
            metres,
            strides: (4, 3),
            version: "1.0".to_owned(),
            left_handed: false,
            frames: None,
            timeline: Timeline::new(keeps_places),
            keeps_places,
            used,
            skipped: (0, 0),
            points: Vec::new(),
            bodies: Vec::new(),
            poses: Vec::new(),
            seen: TrackedBodies::default(),
            renumbered: (0, 0),
            undefined: false,
            markers: HashMap::new(),
            half_blank: None,
            warnings: Vec::new(),
        }
    }

    fn take(&mut self, record: &Record<'_>) -> Result<(), TrackError> {
        match record.word() {
            "comment" | "righthanded" => Ok(()),
            "lefthanded" => {
                self.left_handed = true;
                Ok(())
            }
            "info" => self.info(record),
            "frame" => self.frame(record),
            "trackable" | "rigidbody" if self.timeline.len() == 0 => self.definition(record),
            "trackable" | "rigidbody" => self.extended(record),
            _ => Err(record.unknown()),
        }
    }

    fn info(&mut self, record: &Record<'_>) -> Result<(), TrackError> {
        match record.cell(1).raw {
            "version" => {
                let version = record.cell(2).raw.replace(',', ".");
                self.strides = match version.as_str() {
                    "1.0" | "1" => (4, 3),
                    "1.1" => (5, 4),
                    _ => return Err(record.error(2, TrackProblem::RecordVersion { version })),
                };
                self.version = version;
            }
            "framecount" => self.frames = record.cell(2).raw.parse().ok(),
            _ => {}
        }
        Ok(())
    }

    /// name, id, n, n × (x, y, z in the body's own axes)
    fn definition(&mut self, record: &Record<'_>) -> Result<(), TrackError> {
        let markers = record.count(3, "markers")?;
        record.expect(4 + 3 * markers)?;
        let name = record.cell(1).text().into_owned();
        let id = record.cell(2).raw.to_owned();
        let mut offsets = Vec::with_capacity(markers);
        for marker in 0..markers {
            if let Coordinates::Seen(offset) = record.place(4 + 3 * marker)? {
                offsets.push(offset);
            }
        }
        self.body((&name, &id), markers, &offsets);
        Ok(())
    }

    fn body(&mut self, (name, id): (&str, &str), markers: usize, offsets: &[[f64; 3]]) {
        let (keeps_places, used) = (self.keeps_places, self.used.as_ref());
        let mut add = |name: String, kind, id: &str| {
            let mut point = TrackPoint::new(name, kind, id.to_owned(), Vec::new());
            if kind == PointKind::RigidBody {
                point = point.oriented();
            }
            let needed = used.is_none_or(|used| used.may_need(&point));
            point.keep_places(keeps_places && needed);
            self.points.push(point);
            self.points.len() - 1
        };
        let pivot = add(name.to_owned(), PointKind::RigidBody, id);
        let called = |number: usize| format!("{name}:Marker{number}");
        let solved = (1..=markers)
            .map(|number| add(called(number), PointKind::RigidBodyMarker, id))
            .collect();
        let measured = (1..=markers)
            .map(|number| add(called(number), PointKind::Marker, id))
            .collect();
        self.bodies.push(RigidBody::new(
            (name, id),
            pivot,
            (solved, measured),
            offsets,
        ));
    }

    /// Gives the last frame's poses to their bodies.
    fn settle_poses(&mut self) {
        let poses = std::mem::take(&mut self.poses);
        let seen = std::mem::take(&mut self.seen);
        let owners = owners(&poses, &self.bodies, &seen);
        let Some(row) = self.timeline.len().checked_sub(1) else {
            return;
        };
        for (pose, owner) in poses.into_iter().zip(owners) {
            let Some(body) = owner.and_then(|owner| self.bodies.get(owner)) else {
                self.renumbered.1 += 1;
                continue;
            };
            self.renumbered.0 += usize::from(body.id != pose.id);
            let pivot = body.pivot;
            let (place, turn) = (pose.place.map(|value| value * self.metres), pose.turn);
            if let Some(point) = self.points.get_mut(pivot) {
                let ([x, y, z], mirrored) = (place, self.left_handed);
                let place = [x, y, if mirrored { -z } else { z }];
                let turn = turn.map(|[x, y, z, w]| {
                    if mirrored {
                        [-x, -y, z, w]
                    } else {
                        [x, y, z, w]
                    }
                });
                point.push_pose(row, place, turn);
            }
        }
    }

    /// index, time, bodies, bodies × (id, x, y, z, quaternion, Euler angles), markers, markers × (x, y, z, id[, name])
    fn frame(&mut self, record: &Record<'_>) -> Result<(), TrackError> {
        let number = record.frame_number(1)?;
        let time = record.time(2)?;
        let bodies = record.count(3, "bodies")?;
        let markers_at = 4 + 11 * bodies;
        let markers = record.count(markers_at, "markers")?;
        let stride = self.strides.0;
        record.expect(markers_at + 1 + stride * markers)?;
        let frame = number;
        if let Some((previous, before)) = self.timeline.last() {
            if frame <= previous && time <= before {
                return Err(record.error(1, TrackProblem::FrameOrder { previous, frame }));
            }
            if time <= before {
                let previous = before;
                return Err(record.error(2, TrackProblem::TimeOrder { previous, time }));
            }
        }
        self.settle_poses();
        if self.timeline.len() == 0 {
            self.undefined = self.bodies.is_empty();
        }
        let mut poses = Vec::with_capacity(bodies);
        let mut seen: Vec<(usize, [f64; 3])> = Vec::with_capacity(markers);
        for body in 0..bodies {
            let at = 4 + 11 * body;
            let id = record.cell(at).raw.to_owned();
            // Without any definition there is nothing but the number.
            if self.undefined && !self.bodies.iter().any(|body| body.id == id) {
                self.body((&format!("body {id}"), &id), 0, &[]);
            }
            if let Some(place) = self.place(record, at + 1)? {
                let turn = record.turn(at + 4)?;
                poses.push(FramePose { id, place, turn });
            }
        }
        for marker in 0..markers {
            let at = markers_at + 1 + stride * marker;
            let place = self.place(record, at)?;
            let point = self.marker(record, at, marker);
            seen.extend(place.map(|place| (point, place)));
        }
        let row = self.timeline.len();
        if let Some((previous, _)) = self.timeline.last() {
            let left_out = frame.saturating_sub(previous + 1);
            self.skipped.0 += usize::from(left_out > 0);
            self.skipped.1 += left_out;
            if frame <= previous {
                self.timeline.renumbered(record.line());
            }
        }
        self.timeline.push(frame, time);
        self.push(row, &seen);
        self.poses = poses;
        Ok(())
    }

    fn place(&mut self, record: &Record<'_>, at: usize) -> Result<Option<[f64; 3]>, TrackError> {
        Ok(match record.place(at)? {
            Coordinates::Seen(place) => Some(place),
            Coordinates::Missing => None,
            Coordinates::HalfBlank => {
                self.half_blank.get_or_insert((0, record.line())).0 += 1;
                None
            }
        })
    }

    /// The point of a frame's marker: in version 1.0 by its place in the list, in 1.1 by its number.
    fn marker(&mut self, record: &Record<'_>, at: usize, index: usize) -> usize {
        let numbered = self.strides.0 == 5;
        let id = if numbered {
            record.cell(at + 3).raw.to_owned()
        } else {
            (index + 1).to_string()
        };
        if let Some(point) = self.markers.get(&id) {
            return *point;
        }
        let name = if numbered {
            record.cell(at + 4).text().into_owned()
        } else {
            format!("Unlabeled {id}")
        };
        let kind = PointKind::of_marker(&name);
        let mut point = TrackPoint::new(name, kind, id.clone(), Vec::new());
        point.keep_places(self.keeps_places);
        self.points.push(point);
        self.markers.insert(id, self.points.len() - 1);
        self.points.len() - 1
    }

    /// index, time, name, id, frames since it was tracked, n, n × solved (x, y, z[, id]), n × point cloud (x, y, z), n × tracked,
    /// n × quality, mean error
    fn extended(&mut self, record: &Record<'_>) -> Result<(), TrackError> {
        let number = record.frame_number(1)?;
        let id = record.cell(4).raw.to_owned();
        let since = record.count(5, "frames since it was tracked")?;
        let markers = record.count(6, "markers")?;
        let stride = self.strides.1;
        let cloud_at = 7 + stride * markers;
        record.expect(cloud_at + 5 * markers + 1)?;
        let last = self.timeline.last().map(|(frame, _)| frame);
        if last != Some(number) {
            let previous = last.unwrap_or(0);
            let frame = number;
            return Err(record.error(1, TrackProblem::FrameOrder { previous, frame }));
        }
        let name = record.cell(3).text().into_owned();
        let known = |body: &RigidBody| body.measured.len() >= markers;
        let bodies = || {
            self.bodies
                .iter()
                .enumerate()
                .filter(|(_, body)| known(body))
        };
        let by_name = bodies().find(|(_, body)| body.name == name);
        let found = by_name.or_else(|| bodies().find(|(_, body)| body.id == id));
        let found = found.map(|(index, _)| index);
        let index = found.unwrap_or_else(|| {
            self.body((&name, &id), markers, &[]);
            self.bodies.len() - 1
        });
        let mut seen = Vec::with_capacity(2 * markers);
        let mut tracked = Vec::with_capacity(markers);
        for marker in 0..markers {
            let Some(body) = self.bodies.get(index) else {
                break;
            };
            let (solved, measured) = (
                body.solved.get(marker).copied(),
                body.measured.get(marker).copied(),
            );
            if let (Some(point), Some(place), 0) =
                (solved, self.place(record, 7 + stride * marker)?, since)
            {
                seen.push((point, place));
                tracked.push(place);
            }
            if let (Some(point), Some(place)) =
                (measured, self.place(record, cloud_at + 3 * marker)?)
            {
                seen.push((point, place));
            }
        }
        self.push(self.timeline.len() - 1, &seen);
        self.seen.add(index, &tracked);
        Ok(())
    }

    fn push(&mut self, row: usize, seen: &[(usize, [f64; 3])]) {
        for (index, place) in seen {
            if let Some(point) = self.points.get_mut(*index) {
                let [x, y, z] = place.map(|value| value * self.metres);
                point.push(row, [x, y, if self.left_handed { -z } else { z }]);
            }
        }
    }

    fn finish(mut self, unit: Unit) -> Draft {
        self.settle_poses();
        let rows = self.timeline.len();
        for point in &mut self.points {
            point.finish(rows);
        }
        if self.renumbered != (0, 0) {
            let (renumbered, left_out) = self.renumbered;
            self.warnings.push(TrackWarning::BodyNumbers {
                renumbered,
                left_out,
            });
        }
        if self.left_handed {
            self.warnings.push(TrackWarning::LeftHanded);
        }
        if let Some((count, first_line)) = self.half_blank {
            let warning = TrackWarning::HalfBlank { count, first_line };
            self.warnings.push(warning);
        }
        if let (jumps @ 1.., frames) = self.skipped {
            self.warnings
                .push(TrackWarning::FrameJumps { jumps, frames });
        }
        self.warnings
            .extend(TrackWarning::frame_count(self.frames, rows));
        Draft {
            format: if self.version == "1.0" || self.version == "1" {
                TrackFormat::TrackingTools
            } else {
                TrackFormat::Motive(self.version)
            },
            rate_hz: None,
            unit,
            image: false,
            body: Body {
                timeline: self.timeline,
                points: self.points,
                warnings: Vec::new(),
                rate_hz: None,
            },
            warnings: self.warnings,
        }
    }
}
