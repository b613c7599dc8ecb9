//! A rigid body instead of two reflectors: its position and orientation put the reflectors' places on the link where they would be
//! seen.
//!
//! Which of the body's axes is the normal is read off the rotations: it is the one that they leave in place. The heading is that of
//! the next axis (z if y is up, x if z is up), or of the one that the campaign names. A solver that loses a marker may tip the body
//! over; rows whose normal is far from the usual one are left out.

use nalgebra::{UnitQuaternion, Vector3};
use swimmer_files::{Reflectors, RigidBody};

use super::{Followed, Row, Search, Settled, settle};
use crate::median::median;
use crate::poses::PoseError;
use crate::{TrackFile, TrackPoint};

/// Cosine of the angle between a row's normal and the usual one beyond which the body is taken for tipped over: 15°.
const TIPPED: f64 = 0.965_926;

/// A body's pose in a row.
struct Pose {
    row: usize,
    place: Vector3<f64>,
    turn: UnitQuaternion<f64>,
}

/// # Errors
/// [`PoseError`]: a body that is not in the file or never seen, or an axis that shows no heading.
pub(super) fn follow<'a>(
    track: &'a TrackFile,
    reflectors: &Reflectors,
    body: &RigidBody,
    expected_m: f64,
) -> Result<Followed<'a>, PoseError> {
    let point = find(track, body)?;
    let mut poses: Vec<Pose> = (0..track.frames())
        .filter_map(|row| {
            Some(Pose {
                row,
                place: point.position(row)?,
                turn: point.orientation(row)?,
            })
        })
        .collect();
    if poses.is_empty() {
        return Err(PoseError::BodyUnseen {
            body: body.name.clone(),
            frames: track.frames(),
        });
    }
    let normal = normal_axis(&poses);
    let (axis, sign) = body.axis.unwrap_or(((normal + 1) % 3, 1.0));
    if axis == normal {
        let letter = ["x", "y", "z"].get(axis).copied().unwrap_or("?");
        return Err(PoseError::BodyAxis {
            body: body.name.clone(),
            axis: letter,
        });
    }
    let along = |poses: &[Pose]| {
        let directions = poses
            .iter()
            .map(|pose| pose.turn * Vector3::ith(normal, 1.0));
        usual(&directions.collect::<Vec<_>>())
    };
    let up = along(&poses);
    let before = poses.len();
    poses.retain(|pose| (pose.turn * Vector3::ith(normal, 1.0)).dot(&up) > TIPPED);
    let tipped = before - poses.len();
    // Seen from the positive side of the file's axis that the normal is nearest to, as the plane is.
    let upright = up[up.iamax()].signum();
    let forward = Vector3::ith(axis, sign);
    let left = Vector3::ith(normal, upright).cross(&forward);
    let (sin, cos) = body.heading_rad.sin_cos();
    let (ahead, aside) = (cos * forward + sin * left, cos * left - sin * forward);
    let carried = |pose: &Pose, at: [f64; 2]| {
        let [x, y] = [at[0] - body.at[0], at[1] - body.at[1]];
        pose.place + pose.turn * (x * ahead + y * aside)
    };
    let rows: Vec<Row> = poses
        .iter()
        .enumerate()
        .map(|(index, pose)| Row {
            index: pose.row,
            front: carried(pose, reflectors.front.at),
            back: carried(pose, reflectors.back.at),
            labels: None,
            begins: index == 0,
            miss: None,
        })
        .collect();
    if rows.is_empty() {
        return Err(PoseError::BodyUnseen {
            body: body.name.clone(),
            frames: track.frames(),
        });
    }
    let search = Search::of_nothing(track, expected_m);
    let settled = Settled {
        rows,
        lost_segments: 0,
        lost_rows: 0,
        contested: None,
    };
    let mut followed = settle(search, settled, 1, expected_m);
    followed.order_known = true;
    followed.tipped = tipped;
    Ok(followed)
}

/// The body by its whole name, or by its name after an asset's.
fn find<'a>(track: &'a TrackFile, body: &RigidBody) -> Result<&'a TrackPoint, PoseError> {
    let oriented = || track.points.iter().filter(|point| point.is_oriented());
    let exact = oriented().find(|point| point.name == body.name);
    let found = exact.or_else(|| oriented().find(|point| point.is_called(&body.name)));
    found.ok_or_else(|| {
        let names: Vec<&str> = oriented()
            .map(|point| point.name.as_str())
            .take(20)
            .collect();
        PoseError::NoBody {
            wanted: body.name.clone(),
            bodies: names.join(", "),
        }
    })
}

/// The body's axis that its rotations leave in place.
fn normal_axis(poses: &[Pose]) -> usize {
    let spread = |axis: usize| {
        let sum: Vector3<f64> = poses
            .iter()
            .map(|pose| pose.turn * Vector3::ith(axis, 1.0))
            .sum();
        1.0 - sum.norm() / poses.len() as f64
    };
    let spreads = [spread(0), spread(1), spread(2)];
    // A body that never turns keeps all three: then the one that is the file's own axis of least motion.
    if spreads.iter().all(|spread| *spread < 1e-9) {
        let motion = |axis: usize| {
            let values = || {
                poses
                    .iter()
                    .filter_map(|pose| pose.place.get(axis).copied())
            };
            values().fold(f64::NEG_INFINITY, f64::max) - values().fold(f64::INFINITY, f64::min)
        };
        let still = (0..3)
            .min_by(|a, b| motion(*a).total_cmp(&motion(*b)))
            .unwrap_or(2);
        return still;
    }
    (0..3)
        .min_by(|a, b| spreads[*a].total_cmp(&spreads[*b]))
        .unwrap_or(2)
}

/// The usual direction: the median of each component.
fn usual(directions: &[Vector3<f64>]) -> Vector3<f64> {
    let component =
        |axis: usize| median(directions.iter().map(|direction| direction[axis])).unwrap_or(0.0);
    let middle = Vector3::new(component(0), component(1), component(2));
    middle.try_normalize(1e-9).unwrap_or_else(Vector3::z)
}
