//! Rigid bodies of record lines, and which of a frame's poses is whose.
//!
//! A frame numbers its poses, definitions and extended records number bodies, and the two numberings need not agree. The extended
//! record says where the program puts the body's markers; a pose belongs to the body whose markers it explains.

use nalgebra::{Quaternion, UnitQuaternion, Vector3};

/// Lengths up to which a pose may be off its body's markers \[m\], apart from twice the body's own size.
const NEAR_M: f64 = 5e-3;

/// A rigid body and the points that belong to it.
pub(super) struct RigidBody {
    pub(super) name: String,
    pub(super) id: String,
    pub(super) pivot: usize,
    pub(super) solved: Vec<usize>,
    pub(super) measured: Vec<usize>,
    /// Mean of the markers' places in the body's own axes.
    centre: Vector3<f64>,
    /// Largest distance of a marker from that mean.
    size: f64,
}

impl RigidBody {
    pub(super) fn new(
        (name, id): (&str, &str),
        pivot: usize,
        (solved, measured): (Vec<usize>, Vec<usize>),
        offsets: &[[f64; 3]],
    ) -> Self {
        let offsets: Vec<Vector3<f64>> = offsets.iter().copied().map(Vector3::from).collect();
        let centre = mean(&offsets).unwrap_or_default();
        let sizes = offsets.iter().map(|offset| (offset - centre).norm());
        Self {
            name: name.to_owned(),
            id: id.to_owned(),
            pivot,
            solved,
            measured,
            centre,
            size: sizes.fold(0.0, f64::max),
        }
    }
}

/// A pose in a frame's list.
pub(super) struct FramePose {
    pub(super) id: String,
    pub(super) place: [f64; 3],
    pub(super) turn: Option<[f64; 4]>,
}

/// Markers in the extended records of a frame.
#[derive(Default)]
pub(super) struct TrackedBodies {
    /// Tracked bodies by their index, and the mean of their markers' solved places.
    tracked: Vec<(usize, Vector3<f64>)>,
    /// `true` if there was any record.
    any: bool,
}

impl TrackedBodies {
    /// Adds a body's record; `solved` are its markers' places if it is tracked.
    pub(super) fn add(&mut self, body: usize, solved: &[[f64; 3]]) {
        self.any = true;
        let places: Vec<Vector3<f64>> = solved.iter().copied().map(Vector3::from).collect();
        self.tracked
            .extend(mean(&places).map(|centre| (body, centre)));
    }
}

/// The body of each pose: by its markers if the frame has extended records, else by its number. `None` for a pose that
/// belongs to no body.
pub(super) fn owners(
    poses: &[FramePose],
    bodies: &[RigidBody],
    seen: &TrackedBodies,
) -> Vec<Option<usize>> {
    if !seen.any {
        let by_id = |pose: &FramePose| bodies.iter().position(|body| body.id == pose.id);
        return poses.iter().map(by_id).collect();
    }
    let mut pairs: Vec<(f64, usize, usize)> = Vec::new();
    for (index, pose) in poses.iter().enumerate() {
        for (body, centre) in &seen.tracked {
            let Some(known) = bodies.get(*body) else {
                continue;
            };
            let off = (pose.carries(&known.centre) - centre).norm();
            if off <= NEAR_M + 2.0 * known.size {
                pairs.push((off, index, *body));
            }
        }
    }
    pairs.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut owners: Vec<Option<usize>> = vec![None; poses.len()];
    for (_, index, body) in pairs {
        let taken = owners.contains(&Some(body));
        if let Some(owner) = owners
            .get_mut(index)
            .filter(|owner| owner.is_none() && !taken)
        {
            *owner = Some(body);
        }
    }
    owners
}

impl FramePose {
    /// Position of a point of the body in this pose.
    fn carries(&self, point: &Vector3<f64>) -> Vector3<f64> {
        let place = Vector3::from(self.place);
        let turn = self
            .turn
            .and_then(|[x, y, z, w]| UnitQuaternion::try_new(Quaternion::new(w, x, y, z), 1e-6));
        turn.map_or(place, |turn| place + turn * point)
    }
}

fn mean(places: &[Vector3<f64>]) -> Option<Vector3<f64>> {
    (!places.is_empty()).then(|| places.iter().sum::<Vector3<f64>>() / places.len() as f64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_pose_belongs_to_the_markers_that_it_explains() {
        let offsets = [[0.03, 0.0, 0.01], [-0.03, 0.0, 0.01]];
        let body = |name, id| RigidBody::new((name, id), 0, (vec![], vec![]), &offsets);
        let bodies = [body("robot", "1"), body("tool", "2")];
        let pose = |id: &str, x| FramePose {
            id: id.to_owned(),
            place: [x, 0.0, 0.0],
            // A quarter turn about y takes the body's z to x.
            turn: Some([0.0, 0.5_f64.sqrt(), 0.0, 0.5_f64.sqrt()]),
        };
        let poses = [pose("2", 0.5), pose("1", 2.0), pose("3", 9.0)];
        let mut seen = TrackedBodies::default();
        assert_eq!(owners(&poses, &bodies, &seen), [Some(1), Some(0), None]);
        seen.add(0, &[[0.51, 0.0, -0.03], [0.51, 0.0, 0.03]]);
        seen.add(1, &[[2.01, 0.0, -0.03], [2.01, 0.0, 0.03]]);
        assert_eq!(owners(&poses, &bodies, &seen), [Some(0), Some(1), None]);
    }
}
