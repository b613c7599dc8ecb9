//! The gait file: one cycle of an optimised gait, with what it was optimised for, as plain text that any plotting program
//! reads.
//!
//! The format is documented at the top of every file that [`GaitFile::to_text`] writes.

mod bounds;
mod curve;
mod read;
mod write;

use std::fmt;
use std::path::Path;
use std::str::FromStr;

pub use bounds::Bounds;
use nalgebra::Vector2;

use crate::file_error::read_text;
use crate::{FileError, GaitSpring, SwimmerHash, write_atomically};

/// Objective that a gait was optimised for.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Default)]
pub enum Objective {
    /// Net displacement in x (paper section IV).
    Displacement,
    /// Lighthill's efficiency (paper section V).
    Efficiency,
    /// Net rotation.
    Turning,
    /// Net displacement across the heading, without net rotation.
    Sideways,
    /// Net displacement per unit of time under servos' rates, without net rotation.
    Speed,
    /// Speed along the mean heading, of the gaits that begin and end at the first sample's shape.
    JoinedForward,
    /// Speed across the mean heading, of these.
    JoinedSideways,
    /// Net rotation per unit of time, of these.
    JoinedTurning,
    /// Nothing that is known: a gait from elsewhere.
    #[default]
    Unspecified,
}

/// Kind of an arc of an optimal gait.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename_all = "lowercase")
)]
pub enum ArcKind {
    /// Free, with the control from `Ḧ_u = 0` (paper, `u₂* = −(A/B) u₁*`).
    Singular,
    /// Along the upper bound `|φᵢ| = φ_max`.
    Upper,
    /// Along the lower bound `|φᵢ| = φ_min`.
    Lower,
    /// Along a side of the quarter-gait sector, `φ₂ = ±φ₁`.
    Diagonal,
    /// Along the bound that keeps the side links apart, or on the least distance between them.
    Clearance,
    /// Free, with the control from `H_u = 0` (efficiency).
    Regular,
    /// Both servos at full rate (speed).
    Extreme,
}

/// One arc of the cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct GaitArc {
    /// Kind of the arc.
    pub kind: ArcKind,
    /// Start, as a fraction of the period.
    pub from: f64,
    /// End, as a fraction of the period.
    pub to: f64,
}

/// A gait file's content.
///
/// `u` and `phi` are the samples of one cycle: `u` rises strictly from 0 to 1, and the last shape is the first one again.
/// Each corner is one of the `u` below 1.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GaitFile {
    /// Objective that the gait was optimised for.
    pub objective: Objective,
    /// Name of the swimmer it was made for, where known.
    pub swimmer_name: Option<String>,
    /// Fingerprint of the swimmer it was made for, where known.
    pub swimmer_hash: Option<SwimmerHash>,
    /// The bounds it was optimised under.
    pub bounds: Bounds,
    /// Period \[s\] in which a gait for speed is the farthest; `None` if it is the fastest of any period.
    pub optimal_period: Option<f64>,
    /// The passive joint, if the gait is the response of a spring; `None` if both joints are driven.
    pub passive: Option<GaitSpring>,
    /// Its arcs in order, where known.
    pub arcs: Vec<GaitArc>,
    /// Fractions of the period at which the direction in the (φ₁, φ₂) plane jumps.
    pub corners: Vec<f64>,
    /// Fractions of the period.
    pub u: Vec<f64>,
    /// Joint angles \[rad\] at each `u`.
    pub phi: Vec<Vector2<f64>>,
}

impl GaitFile {
    /// The format version that this code writes; it reads this one and older.
    pub const VERSION: u32 = 1;
    /// Fewest samples of a gait file.
    pub const FEWEST_SAMPLES: usize = 9;
    /// The last shape may differ from the first by this much \[rad\].
    pub const CLOSURE: f64 = 1e-9;

    /// Reads a gait file.
    ///
    /// # Errors
    /// [`FileError`] with line and column.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        Self::parse(&read_text(path)?, path)
    }

    /// Reads a gait file's text; `path` is only for the errors.
    ///
    /// # Errors
    /// [`FileError`] with line and column.
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        read::gait_file(text, path)
    }

    /// The file's text, which reads back to the same numbers bit for bit.
    pub fn to_text(&self) -> String {
        write::gait_text(self)
    }

    /// Writes the file whole.
    ///
    /// # Errors
    /// [`FileError::Write`]; what was there before stays.
    pub fn save(&self, path: &Path) -> Result<(), FileError> {
        write_atomically(path, self.to_text().as_bytes())
    }
}

impl Objective {
    const ALL: [Self; 9] = [
        Self::Displacement,
        Self::Efficiency,
        Self::Turning,
        Self::Sideways,
        Self::Speed,
        Self::JoinedForward,
        Self::JoinedSideways,
        Self::JoinedTurning,
        Self::Unspecified,
    ];

    /// `true` for a gait that is the best of those that begin and end at its first sample's shape.
    pub fn is_joined(self) -> bool {
        matches!(
            self,
            Self::JoinedForward | Self::JoinedSideways | Self::JoinedTurning
        )
    }

    /// The word in files.
    pub fn word(self) -> &'static str {
        match self {
            Self::Displacement => "displacement",
            Self::Efficiency => "efficiency",
            Self::Turning => "turning",
            Self::Sideways => "sideways",
            Self::Speed => "speed",
            Self::JoinedForward => "joined-forward",
            Self::JoinedSideways => "joined-sideways",
            Self::JoinedTurning => "joined-turning",
            Self::Unspecified => "unspecified",
        }
    }
}

impl serde::Serialize for ArcKind {
    fn serialize<S: serde::Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.serialize_str(self.word())
    }
}

impl ArcKind {
    const ALL: [Self; 7] = [
        Self::Singular,
        Self::Upper,
        Self::Lower,
        Self::Diagonal,
        Self::Clearance,
        Self::Regular,
        Self::Extreme,
    ];

    /// The word in files and in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::Singular => "singular",
            Self::Upper => "upper",
            Self::Lower => "lower",
            Self::Diagonal => "diagonal",
            Self::Clearance => "clearance",
            Self::Regular => "regular",
            Self::Extreme => "extreme",
        }
    }
}

macro_rules! word_in_text {
    ($type:ty, $problem:literal) => {
        impl fmt::Display for $type {
            fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
                f.write_str(self.word())
            }
        }

        impl FromStr for $type {
            type Err = &'static str;

            fn from_str(text: &str) -> Result<Self, Self::Err> {
                Self::ALL
                    .into_iter()
                    .find(|one| one.word() == text)
                    .ok_or($problem)
            }
        }
    };
}

word_in_text!(
    Objective,
    "an objective is one of displacement, efficiency, turning, sideways, speed, joined-forward, joined-sideways, joined-turning, \
     unspecified"
);
word_in_text!(
    ArcKind,
    "an arc is one of singular, upper, lower, diagonal, clearance, regular, extreme"
);
