//! Height function of a swimmer: its zero-level curves, and the area rule for gaits.

use std::path::PathBuf;

use gait_optimizer::{AreaRule, Convergence, HeightMap, HeightMapError, LevelCurve, Row};
use serde::{Deserialize, Serialize};
use swimmer_files::AnyGait;

use crate::Error;

/// A component of the displacement.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
#[serde(rename_all = "lowercase")]
pub enum Component {
    /// Along the swimmer, over L.
    X,
    /// Across the swimmer, over L.
    Y,
    /// Rotation.
    Theta,
}

impl Component {
    /// Row of the curvature.
    pub fn row(self) -> Row {
        match self {
            Self::X => Row::X,
            Self::Y => Row::Y,
            Self::Theta => Row::Theta,
        }
    }
}

/// A named gait over the map.
#[derive(Debug, Clone)]
pub struct NamedGait {
    /// Name that the user gave it.
    pub name: String,
    /// The gait.
    pub gait: AnyGait,
}

/// Area rule of one gait: x and y over L, θ in radians.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GaitArea {
    /// Name of the gait.
    pub gait: String,
    /// ∬ H over the enclosed area, transformed to the middle link at the gait's start.
    pub area: [f64; 3],
    /// Net displacement of one cycle.
    pub swum: [f64; 3],
    /// `area` − `swum`.
    pub deviation: [f64; 3],
}

impl GaitArea {
    fn new(gait: String, rule: &AreaRule) -> Self {
        Self {
            gait,
            area: rule.area.into(),
            swum: rule.swum.into(),
            deviation: rule.deviation().into(),
        }
    }
}

/// One component of the height function. The JSON document of `swimmer height-map`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "HeightMapOutput")
)]
pub struct Output {
    /// Component.
    pub row: Component,
    /// D: the map covers |φᵢ| ≤ D, and its frame is the best over this square \[rad\].
    pub max_angle_rad: f64,
    /// Height at the straight shape, x and y over L; for the rotation \[rad/rad²\].
    pub at_origin_over_length: f64,
    /// φ₂ of the first zero with φ₁ = φ₂ > 0 \[rad\].
    pub zero_on_diagonal: Option<f64>,
    /// φ₂ of the first zero with −φ₁ = φ₂ > 0 \[rad\].
    pub zero_on_antidiagonal: Option<f64>,
    /// φ₂ of all zeros with φ₁ = φ₂ > 0 \[rad\].
    pub zeros_on_diagonal: Vec<f64>,
    /// φ₂ of all zeros with −φ₁ = φ₂ > 0 \[rad\].
    pub zeros_on_antidiagonal: Vec<f64>,
    /// Change of the frame at the last increase of the order.
    pub convergence: Convergence,
    /// Zero-level curves.
    pub zero_curves: Vec<LevelCurve>,
    /// Area rule of each gait.
    pub gaits: Vec<GaitArea>,
    /// Figure or table, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub written: Option<PathBuf>,
}

/// Describes a component of a map, and holds the area rule against what each gait swims.
///
/// # Errors
/// A gait leaves the map.
pub fn run(map: &HeightMap, component: Component, gaits: &[NamedGait]) -> Result<Output, Error> {
    let row = component.row();
    let zeros_on_diagonal = map.zeros_on_diagonal(row);
    let zeros_on_antidiagonal = map.zeros_on_antidiagonal(row);
    let gaits = gaits
        .iter()
        .map(|NamedGait { name, gait }| Ok(GaitArea::new(name.clone(), &map.area_rule(gait)?)))
        .collect::<Result<_, Error>>()?;
    Ok(Output {
        row: component,
        max_angle_rad: map.half_width(),
        at_origin_over_length: map.height(row, &[0.0, 0.0].into()),
        zero_on_diagonal: zeros_on_diagonal.first().copied(),
        zero_on_antidiagonal: zeros_on_antidiagonal.first().copied(),
        zeros_on_diagonal,
        zeros_on_antidiagonal,
        convergence: map.convergence(),
        zero_curves: map.zero_curves(row),
        gaits,
        written: None,
    })
}

impl From<HeightMapError> for Error {
    /// A swimmer, square or gait that makes no sense is bad input; a frame that does not converge is a failure.
    fn from(error: HeightMapError) -> Self {
        match error {
            HeightMapError::NotConverged { .. } => Self::failed(&error),
            _ => Self::bad_input(&error),
        }
    }
}
