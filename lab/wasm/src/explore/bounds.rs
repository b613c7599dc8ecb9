//! Bounds and objective, with the names of the command line.

use gait_optimizer::{Bounds, Objective};
use serde::Deserialize;

/// Bounds on shapes, with the names of the command line's options.
#[derive(Debug, Clone, Copy, Default, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub(super) struct BoundsAsked {
    max_angle: Option<f64>,
    min_angle: Option<f64>,
    sector: bool,
    no_overlap: bool,
    clearance: f64,
}

impl From<BoundsAsked> for Bounds {
    fn from(asked: BoundsAsked) -> Self {
        Self {
            max_angle: asked.max_angle,
            min_angle: asked.min_angle,
            sector: asked.sector,
            no_overlap: asked.no_overlap || asked.clearance > 0.0,
            clearance: asked.clearance,
        }
    }
}

/// Objective by its word. Returns `None` for the objective stored in the file.
pub(super) fn objective(word: Option<&str>) -> Result<Option<Objective>, String> {
    word.map(|word| {
        word.parse()
            .map_err(|_| format!("`{word}` is no objective of a gait"))
    })
    .transpose()
}
