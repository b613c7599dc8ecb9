//! Joint angles measured by two reflectors on the side links: the true Φ(t), independent of the commands.
//!
//! A side link's reflector lies at a known place from its joint, the joint at an end of the middle link, and the middle link's
//! pose is measured: the reflector's direction from the joint is the link's (`follow.rs`). All cycles together give each angle's
//! mean curve over a cycle (`curve.rs`), which the model then swims instead of the command; held against the command it says what
//! the servos made of it (`servo.rs`).

mod curve;
mod follow;
mod servo;
mod side;

use nalgebra::Vector2;
use serde::Serialize;
use swimmer_files::Reflectors;
use swimmer_model::Swimmer;

use crate::cycles::{Cycles, Phase};
use crate::poses::PoseTrack;
use crate::prediction::JointPath;
use crate::sides::Sides;
use crate::tracks::TrackFile;
use curve::AngleCurve;
pub use servo::combined;
pub use side::{SideFollower, SideSighting};

/// A value with its standard error.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Measured {
    /// The value.
    pub value: f64,
    /// Its standard error; NaN if it is unknown.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub error: f64,
}

/// Response of a servo: φ follows gain · command(t − lag) + offset, with a play of the dead band either way.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct MeasuredServo {
    /// Angle per commanded angle.
    pub gain: Measured,
    /// Half of its play \[rad\].
    #[serde(rename = "dead_band_rad")]
    pub dead_band: Measured,
    /// The joint's angle at command 0 \[rad\].
    #[serde(rename = "offset_rad")]
    pub offset: Measured,
    /// Lag \[s\]; `None` if the cycles were timed by the heading, which cannot distinguish a lag from a later start.
    #[serde(rename = "lag_s")]
    pub lag: Option<Measured>,
}

/// The joint angles of a run.
#[derive(Debug, Clone, PartialEq)]
pub struct MeasuredJoints {
    /// Samples of the cycles that count in which the angle was seen, front and back, as a share.
    pub seen: [f64; 2],
    /// Root mean square distance of the samples from the mean curves, front and back \[rad\].
    pub scatter: [f64; 2],
    /// Responses of the servos; `None` if the gait does not determine them.
    pub servos: Option<[MeasuredServo; 2]>,
    /// The mean curves.
    pub(crate) path: JointPath,
    /// The same without each cycle.
    pub(crate) without: Vec<JointPath>,
    pub(crate) sides: Sides,
}

/// Points of a mean curve that becomes a path: chords cut off 2e-5 of its area.
const PIECES: usize = 512;

/// The joint angles of a run's cycles, where its reflectors show them in enough of their samples.
pub(crate) fn measure(
    track: &TrackFile,
    poses: &PoseTrack,
    cycles: &Cycles,
    reflectors: &Reflectors,
    swimmer: &Swimmer<f64>,
    command: impl Fn(f64) -> Vector2<f64>,
) -> Option<MeasuredJoints> {
    let sides = Sides::of(reflectors, swimmer)?;
    let period = cycles.period_s;
    let expected = cycles.cycles.len() as f64 * period * poses.rate_hz;
    let of_joint = |angles: Vec<(f64, f64)>| {
        let in_cycle = |(time, angle): &(f64, f64)| {
            let after = cycles.cycles.partition_point(|c| c.start_s <= *time);
            let index = after.checked_sub(1)?;
            let u = (time - cycles.cycles.get(index)?.start_s) / period;
            (u < 1.0).then_some((index, u, *angle))
        };
        let samples: Vec<(usize, f64, f64)> = angles.iter().filter_map(in_cycle).collect();
        let seen = samples.len() as f64 / expected;
        let fitted = curve::fit(&samples, cycles.cycles.len(), period * poses.rate_hz)?;
        Some((seen, fitted))
    };
    let [front, back] = follow::angles(track, poses, reflectors, sides.half).map(of_joint);
    let ((front_seen, front), (back_seen, back)) = (front?, back?);
    let path = |front: &AngleCurve, back: &AngleCurve| {
        let place = |i: usize| i as f64 / PIECES as f64;
        let vertex = |u: f64| (u, Vector2::new(front.at(u), back.at(u)));
        JointPath::Played((0..=PIECES).map(place).map(vertex).collect())
    };
    let known = !matches!(
        cycles.phase,
        Phase::Heading | Phase::LogAndHeading | Phase::Reported
    );
    let servo = |joint: usize, fitted: &curve::Fitted| {
        servo::of(fitted, |u| command(u)[joint], known.then_some(period))
    };
    let pairs = front.without.iter().zip(&back.without);
    Some(MeasuredJoints {
        seen: [front_seen, back_seen],
        scatter: [front.scatter, back.scatter],
        servos: servo(0, &front)
            .zip(servo(1, &back))
            .map(|(front, back)| [front, back]),
        path: path(&front.curve, &back.curve),
        without: pairs.map(|(front, back)| path(front, back)).collect(),
        sides,
    })
}
