//! Warnings about poses.

use std::fmt;

use super::{Jump, Stretch};

/// Warning about poses.
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
    /// After a gap front and back could not be distinguished; the rows before or after it are left out.
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
    /// The rigid body was tipped over, as by a solver that lost a marker; those rows are left out.
    Tipped {
        /// Rows.
        rows: usize,
    },
    /// The pose jumps as no robot can.
    Jumps(Vec<Jump>),
    /// The names of front and back are exchanged in such a share of the run that the right ones are undetermined.
    LabelsContested {
        /// Rows of the stretches that fewer rows have.
        stretches: Vec<Stretch>,
        /// Their share of the rows that have names.
        share: f64,
    },
}

/// Jumps that are listed one by one.
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
            Self::Tipped { rows } => write!(
                f,
                "the rigid body is tipped by more than 15° in {rows} rows, as by a solver that lost a marker; they count as missing"
            ),
            Self::Frozen { stretches, rows } => write!(
                f,
                "{rows} rows in {stretches} stretches repeat the row before them, digit for digit, for both reflectors: they are copies, \
                 not measurements, and count as missing; record without filling gaps"
            ),
            Self::LabelsContested { stretches, share } => {
                write!(
                    f,
                    "the names of the front and the back reflector are exchanged in {:.0} % of the rows (",
                    100.0 * share
                )?;
                for (i, stretch) in stretches.iter().take(MOST_JUMPS).enumerate() {
                    let (from, until) = (stretch.from_s, stretch.until_s);
                    write!(
                        f,
                        "{}{from:.2} s to {until:.2} s",
                        if i == 0 { "" } else { ", " }
                    )?;
                }
                f.write_str(
                    "): the reflectors were followed by where they are, and the direction of travel was taken for forwards",
                )
            }
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
