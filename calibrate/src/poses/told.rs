//! What poses have to say besides themselves: why there are none, and what to know about them.

use std::fmt;

use super::Jump;

/// Why a track gave no poses.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum PoseError {
    /// A reflector's point is not in the file.
    #[error(
        "the {reflector} reflector is called `{wanted}`, but the points in the track are {points}; change `point` in the campaign"
    )]
    NoPoint {
        /// `front` or `back`.
        reflector: &'static str,
        /// The name that was asked for.
        wanted: String,
        /// The names that are there.
        points: String,
    },
    /// Nobody said how long the track's unit is.
    #[error(
        "the track's lengths are in `{unit}`; say how many metres that is (`scale` under [tracks] in the campaign, or --scale){}",
        scale.map_or(String::new(), |scale| format!("; by the reflectors' distance it is {scale:.6e}"))
    )]
    NoScale {
        /// The unit.
        unit: crate::Unit,
        /// The scale at which the reflectors' distance is right, where they can be told.
        scale: Option<f64>,
    },
    /// Both reflectors are at the same place on the link.
    #[error("both reflectors sit at the same place of the link, so they show no heading")]
    SamePlace,
    /// No two points ever have the right distance.
    #[error(
        "no two points are {expected_m:.5} m apart (within {tolerance_m:.5} m) in any of {frames} frames; check `at` of both \
         reflectors, the unit and the points' names"
    )]
    NoPair {
        /// Distance by `at` of the campaign \[m\].
        expected_m: f64,
        /// Tolerance \[m\].
        tolerance_m: f64,
        /// Rows that were searched.
        frames: usize,
    },
    /// Front and back are one and the same point.
    #[error(
        "front and back both name `{point}`: it is at no distance from itself; name another point for one of them in the campaign"
    )]
    SamePoint {
        /// The point's name.
        point: String,
    },
    /// The named points have another distance than `at` says.
    #[error(
        "the reflectors are {measured_m:.5} m apart in the track but {expected_m:.5} m by `at`; if the track is in other units, a \
         scale of {scale:.6} makes them agree"
    )]
    Distance {
        /// Median distance in the track \[m\].
        measured_m: f64,
        /// Distance by `at` \[m\].
        expected_m: f64,
        /// Expected over measured.
        scale: f64,
    },
}

/// What made the poses less than perfect.
#[derive(Debug, Clone, PartialEq)]
pub enum PoseWarning {
    /// The reflectors' distance differs from what `at` says by more than 2 %.
    Distance {
        /// Mean in the track \[m\].
        measured_m: f64,
        /// By `at` \[m\].
        expected_m: f64,
    },
    /// Points leave the plane by more than 2 % of the reflectors' distance or 5 mm.
    OutOfPlane {
        /// Root mean square distance from the plane \[m\].
        rms_m: f64,
    },
    /// The points lie nearly on a line, so the plane is an axis plane of the file rather than a fitted one.
    PlaneAssumed,
    /// After a gap nobody could tell front from back; the rows before or after it are left out.
    AmbiguousGaps {
        /// Segments that were left out.
        segments: usize,
        /// Rows in them.
        rows: usize,
    },
    /// Both reflectors were held while others moved on: copies, which count as missing.
    Frozen {
        /// Stretches of copies.
        stretches: usize,
        /// Rows in them.
        rows: usize,
    },
    /// The pose jumps as no robot can.
    Jumps(Vec<Jump>),
}

/// Jumps that are told one by one.
const MOST_JUMPS: usize = 3;

impl fmt::Display for PoseWarning {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Distance {
                measured_m,
                expected_m,
            } => write!(
                f,
                "the reflectors are {measured_m:.5} m apart in the track, {expected_m:.5} m by `at`: lengths may be off by {:.1} %",
                100.0 * (measured_m / expected_m - 1.0)
            ),
            Self::OutOfPlane { rms_m } => {
                write!(
                    f,
                    "the reflectors leave their plane by {:.2} mm (rms); the camera may be tilted",
                    1e3 * rms_m
                )
            }
            Self::PlaneAssumed => f.write_str(
                "the reflectors moved along a line only: the plane is the file's own, not fitted",
            ),
            Self::AmbiguousGaps { segments, rows } => write!(
                f,
                "{segments} stretches ({rows} rows) come after gaps too long to tell front from back; they are left out"
            ),
            Self::Frozen { stretches, rows } => write!(
                f,
                "{rows} rows in {stretches} stretches repeat the row before them, digit for digit, for both reflectors: they are copies, \
                 not measurements, and count as missing; record without filling gaps"
            ),
            Self::Jumps(jumps) => {
                f.write_str("the pose jumps as no robot can")?;
                for (i, jump) in jumps.iter().take(MOST_JUMPS).enumerate() {
                    write!(
                        f,
                        "{} at {:.2} s by {:.1} mm and {:+.1}°",
                        if i == 0 { "," } else { ";" },
                        jump.after_s,
                        1e3 * jump.moved_m,
                        jump.turned_rad.to_degrees()
                    )?;
                }
                if jumps.len() > MOST_JUMPS {
                    write!(f, "; and {} times more", jumps.len() - MOST_JUMPS)?;
                }
                f.write_str(
                    ": was the frame of the cameras moved, or the robot? No step and no cycle across it is used",
                )
            }
        }
    }
}
