//! From tracked points to poses of the middle link.
//!
//! 1. Following picks the two reflectors in every row out of all measured points: labels are only hints, the distance
//!    between the reflectors and constant-velocity prediction decide.
//! 2. [`Plane`] is fitted to all of their positions and gives the tank's x and y.
//! 3. Two points in the plane and their places on the link give the link's centre and heading.
//!
//! Gaps of at most [`PoseOptions::longest_fill_s`] are filled by a monotone cubic, which also replaces the neighbouring samples,
//! since those are not reliable; all are marked ([`Origin`]). Cycles use them: a harmonic curve leaves a residual for a
//! gait with corners, and where samples are missing that rest does not average out. Longer gaps stay gaps.

mod assembly;
mod error;
mod fill;
mod follow;
mod frozen;
mod jumps;
mod pchip;
mod plane;
mod rest;
mod warning;

use std::f64::consts::TAU;
use std::fmt;

use nalgebra::{Vector2, Vector3};
use swimmer_files::{PointName, Reflectors, RigidBody};
use swimmer_model::{Pose, Swimmer, wrapped_angle};

use crate::TrackFile;
use assembly::Assembly;
pub use error::PoseError;
use fill::VisibleRow;
pub use follow::{End, FollowReport, FollowedPair, PairFollower, Sighting, Stretch};
pub use jumps::Jump;
pub use plane::Plane;
pub use rest::Drift;
pub use warning::PoseWarning;

/// Limits of the way from points to poses.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseOptions {
    /// Gaps up to this long are filled \[s\].
    pub longest_fill_s: f64,
    /// Largest deviation of the reflectors' distance from its mean, as a share of it.
    pub distance_tolerance: f64,
}

impl Default for PoseOptions {
    /// 0.1 s; a tenth of the distance.
    fn default() -> Self {
        Self {
            longest_fill_s: 0.1,
            distance_tolerance: 0.1,
        }
    }
}

impl PoseOptions {
    /// The default, limited to a tenth of a period \[s\].
    pub fn of_period(period_s: f64) -> Self {
        let usual = Self::default();
        Self {
            longest_fill_s: usual.longest_fill_s.min(0.1 * period_s),
            ..usual
        }
    }
}

/// One pose in time.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PoseSample {
    /// Time \[s\].
    pub time_s: f64,
    /// Centre of the middle link \[m\] and its heading, unwrapped.
    pub pose: Pose<f64>,
    /// Origin of the sample.
    pub origin: Origin,
}

/// Rule that distinguishes the front reflector from the back one: two points alone do not show it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum FrontRule {
    /// By the points' names in the file.
    Label,
    /// By which of the two was nearer to a place in the first frame.
    Place,
    /// By the orientation of a rigid body.
    Body,
    /// By nothing yet: forwards is where the model says that the robot swims.
    Travel,
}

impl FrontRule {
    /// The word that stands for it in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Label => "label",
            Self::Place => "place",
            Self::Body => "body",
            Self::Travel => "travel",
        }
    }
}

impl fmt::Display for FrontRule {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Label => "by the points' names",
            Self::Place => "nearer to the place given, in the first frame",
            Self::Body => "by the rigid body's orientation",
            Self::Travel => "by the direction of travel",
        })
    }
}

/// Origin of a pose.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Origin {
    /// Both reflectors were seen.
    Seen,
    /// Both were seen, but right before or after a gap too long to be filled, where what is seen of a reflector is not all of
    /// it. For drawing only.
    Tail,
    /// Both were seen, right before or after a gap that was filled; the pose is the cubic's.
    Smoothed,
    /// From the reflector that was seen, and a cubic's heading.
    OneSeen,
    /// From a cubic.
    Filled,
}

impl Origin {
    /// The word that stands for it in tables.
    pub fn word(self) -> &'static str {
        match self {
            Self::Seen => "seen",
            Self::Tail => "tail",
            Self::Smoothed => "smoothed",
            Self::OneSeen => "one-seen",
            Self::Filled => "filled",
        }
    }
}

impl PoseSample {
    /// Returns `true` if at least one reflector was lost.
    pub fn is_filled(&self) -> bool {
        matches!(self.origin, Origin::OneSeen | Origin::Filled)
    }
}

/// The middle link's poses through a run.
#[derive(Debug, Clone)]
pub struct PoseTrack {
    /// In time; rows without a pose are not there.
    pub samples: Vec<PoseSample>,
    /// Rows of the file.
    pub frames: usize,
    /// Rows a second.
    pub rate_hz: f64,
    /// The plane, and how the file's axes map to x and y.
    pub plane: Plane,
    /// Report on following the reflectors.
    pub report: FollowReport,
    /// Frame jumps: an interval that contains one of these is not a measurement.
    pub jumps: Vec<Jump>,
    /// Motion of the robot while it rests before or after its cycles, by the fluid.
    pub drift: Option<Drift>,
    /// Rule that distinguished front and back.
    pub front: FrontRule,
    /// Warnings.
    pub warnings: Vec<PoseWarning>,
}

impl PoseTrack {
    /// Track of a run without a recording.
    pub(crate) fn none() -> Self {
        Self {
            samples: Vec::new(),
            frames: 0,
            rate_hz: 0.0,
            plane: Plane::fit(&[], None),
            report: FollowReport::none(),
            jumps: Vec::new(),
            drift: None,
            front: FrontRule::Label,
            warnings: Vec::new(),
        }
    }

    /// The samples that were seen, and not next to a gap.
    pub fn seen(&self) -> impl Iterator<Item = &PoseSample> {
        self.with(Origin::Seen)
    }

    /// The samples found in one way.
    pub fn with(&self, origin: Origin) -> impl Iterator<Item = &PoseSample> {
        self.samples.iter().filter(move |s| s.origin == origin)
    }

    /// If a reflector is given as the one nearer to a place, takes that one for its end.
    fn settle_by_place(&mut self, reflectors: &Reflectors, first: &VisibleRow) {
        let nearer = |place: [f64; 2]| {
            let to = |point: &Vector2<f64>| (point - Vector2::from(place)).norm();
            to(&first.front) < to(&first.back)
        };
        let front_is_front = match (&reflectors.front.point, &reflectors.back.point) {
            (PointName::Near(place), _) => nearer(*place),
            (_, PointName::Near(place)) => !nearer(*place),
            _ => return,
        };
        self.front = FrontRule::Place;
        if !front_is_front {
            self.turn_round(reflectors);
        }
    }

    /// Exchanges front and back. `reflectors` are those that the track was made with.
    pub(crate) fn turn_round(&mut self, reflectors: &Reflectors) {
        let (front, back) = (reflectors.front.at, reflectors.back.at);
        for sample in &mut self.samples {
            // The points where they are, with each other's places on the link.
            let points = [front, back].map(|at| sample.pose.transform(&Vector2::from(at)));
            let theta = sample.pose.theta;
            sample.pose = pose_of_pair(&points[1], &points[0], front, back);
            sample.pose.theta = theta + (sample.pose.theta - theta).rem_euclid(TAU);
        }
    }
}

/// The reflectors that a file and a swimmer suggest when nobody says: points called `Front` and `Back` if they are there; else the
/// only rigid body, if there are no two measured points; else whatever two points keep the right distance; at the ends of the
/// middle link.
pub fn usual_reflectors(track: &TrackFile, swimmer: &Swimmer<f64>) -> Reflectors {
    let reach = swimmer.links.middle / 2.0;
    let named = |name: &str| track.points.iter().any(|point| point.is_called(name));
    let both = named("Front") && named("Back");
    let reflector = |name: &str, at| swimmer_files::Reflector {
        point: if both {
            PointName::Named(name.to_owned())
        } else {
            PointName::Auto
        },
        at,
    };
    Reflectors {
        front: reflector("Front", [reach, 0.0]),
        back: reflector("Back", [-reach, 0.0]),
        body: lone_body(track).filter(|_| !both),
        sides: None,
    }
}

/// The only point with an orientation, if no two measured points could be the reflectors.
fn lone_body(track: &TrackFile) -> Option<RigidBody> {
    let mut oriented = track.points.iter().filter(|point| point.is_oriented());
    let body = oriented.next().filter(|_| oriented.next().is_none())?;
    let measured = track.points.iter().filter(|point| point.kind.is_measured());
    (measured.count() < 2).then(|| RigidBody::named(body.name.clone()))
}

/// The middle link's poses of a track.
///
/// # Errors
/// [`PoseError`]: a reflector that is not in the file, or no pair of points with the right distance.
pub fn poses(
    track: &TrackFile,
    reflectors: &Reflectors,
    options: &PoseOptions,
) -> Result<PoseTrack, PoseError> {
    let followed = follow::follow(track, reflectors, options)?;
    let points: Vec<Vector3<f64>> = followed
        .rows
        .iter()
        .flat_map(|row| [row.front, row.back])
        .collect();
    let distance = followed.report.distance_m;
    let plane = Plane::fit(&points, track.axes);
    let mut warnings = Vec::new();
    if (distance / followed.expected_m - 1.0).abs() > 0.02 {
        warnings.push(PoseWarning::Distance {
            measured_m: distance,
            expected_m: followed.expected_m,
        });
    }
    if plane.rms_m > (0.02 * distance).min(0.005) {
        warnings.push(PoseWarning::OutOfPlane { rms_m: plane.rms_m });
    }
    if !plane.fitted {
        warnings.push(PoseWarning::PlaneAssumed);
    }
    if followed.lost_segments > 0 {
        warnings.push(PoseWarning::AmbiguousGaps {
            segments: followed.lost_segments,
            rows: followed.lost_rows,
        });
    }
    if followed.tipped > 0 {
        warnings.push(PoseWarning::Tipped {
            rows: followed.tipped,
        });
    }
    if followed.frozen.rows > 0 {
        warnings.push(PoseWarning::Frozen {
            stretches: followed.frozen.stretches,
            rows: followed.frozen.rows,
        });
    }
    if let Some(share) = followed.contested {
        warnings.push(PoseWarning::LabelsContested {
            stretches: followed.report.swaps.clone(),
            share,
        });
    }
    let mut seen: Vec<VisibleRow> = followed
        .rows
        .iter()
        .map(|row| VisibleRow {
            row: row.index,
            time_s: track.times.get(row.index).copied().unwrap_or(0.0),
            front: plane.project(&row.front),
            back: plane.project(&row.back),
            tail: false,
            begins: row.begins,
        })
        .collect();
    fill::mark_tails(&mut seen);
    let assembly = Assembly {
        track,
        reflectors,
        followed: &followed,
        plane: &plane,
        longest_s: options.longest_fill_s,
    };
    let samples = assembly.samples(&seen);
    let jumps = jumps::jumps(&samples, distance, track.rate_hz);
    if !jumps.is_empty() {
        warnings.push(PoseWarning::Jumps(jumps.clone()));
    }
    let mut poses = PoseTrack {
        drift: rest::drift(&samples),
        samples,
        jumps,
        frames: track.frames(),
        rate_hz: track.rate_hz,
        plane,
        report: followed.report,
        front: if reflectors.body.is_some() {
            FrontRule::Body
        } else if followed.order_known {
            FrontRule::Label
        } else {
            FrontRule::Travel
        },
        warnings,
    };
    if let Some(first) = seen.first().filter(|_| poses.front == FrontRule::Travel) {
        poses.settle_by_place(reflectors, first);
    }
    Ok(poses)
}

/// The link's pose from two points in the plane and their places on the link.
pub fn pose_of_pair(
    front: &Vector2<f64>,
    back: &Vector2<f64>,
    at_front: [f64; 2],
    at_back: [f64; 2],
) -> Pose<f64> {
    let (at_front, at_back) = (Vector2::from(at_front), Vector2::from(at_back));
    let angle = |v: Vector2<f64>| v.y.atan2(v.x);
    let theta = wrapped_angle(angle(front - back) - angle(at_front - at_back));
    let middle = (front + back) / 2.0;
    let turned = Pose::new(0.0, 0.0, theta).transform(&((at_front + at_back) / 2.0));
    Pose::new(middle.x - turned.x, middle.y - turned.y, theta)
}
