//! Gaits of a swimmer without the paper's symmetries: the closed-curve search of the atlas in place of the quarter solvers.

use gait_optimizer::{Arc, AtlasProblem, Bounds, Objective, OptimalGait, Optimum, atlas_watched};
use serde::Serialize;
use swimmer_files::SwimmerFile;

use super::searched;
use crate::context::{Stage, Timed};
use crate::{Context, Error};

/// Number of random starts.
pub const STARTS: usize = 48;

/// Displacement and arcs of the best certified gait of the closed-curve search.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ClosedCurve {
    /// Displacement along the heading at the first sample, over the total length.
    pub displacement_over_length: f64,
    /// Displacement along the heading at the first sample \[m\].
    pub displacement_m: f64,
    /// Displacement across that heading, over the total length.
    pub lateral_over_length: f64,
    /// Net displacement in any direction, over the total length.
    pub distance_over_length: f64,
    /// The gait has the paper's symmetries.
    pub symmetric: bool,
    /// Arcs in order.
    pub arcs: Vec<Arc>,
    /// Net rotation \[rad\], for text output.
    #[serde(skip)]
    pub rotation: f64,
    /// Objective, for text output.
    #[serde(skip)]
    pub objective: Objective,
    /// Number of certified gaits among which it is the best, for text output.
    #[serde(skip)]
    pub count: usize,
}

/// Best gait of the closed-curve search.
pub(super) struct Found {
    optimum: Optimum,
    count: usize,
}

impl Found {
    /// Searches within bounds. `is_playable` holds the gait within what the robot can play.
    ///
    /// # Errors
    /// The problem is invalid, or no start leads to a certified gait.
    pub(super) fn search(
        file: &SwimmerFile,
        objective: Objective,
        bounds: Bounds,
        is_playable: bool,
        context: &Context,
    ) -> Timed<Result<Self, Error>> {
        let problem = AtlasProblem {
            starts: STARTS,
            threads: context.threads,
            ..AtlasProblem::new(file.swimmer, objective)
        };
        context.timed(Stage::ClosedCurves, |watch| {
            let search = |bounds| {
                let mut optima = atlas_watched(&AtlasProblem { bounds, ..problem }, watch)?.optima;
                if optima.is_empty() {
                    return Err(Error::unsuccessful(format!(
                        "the side links differ, and none of {STARTS} closed curves led to a certified gait of most {objective}; \
                         `swimmer atlas --starts` takes more of them, and a bound on the angles helps"
                    )));
                }
                let count = optima.len();
                let optimum = optima.swap_remove(0);
                Ok(Self { optimum, count })
            };
            searched(file, is_playable, bounds, Self::gait, search)
        })
    }

    /// The gait.
    pub(super) fn gait(&self) -> &OptimalGait {
        &self.optimum.gait
    }

    /// Its description.
    pub(super) fn describe(&self, objective: Objective) -> ClosedCurve {
        let gait = self.gait();
        ClosedCurve {
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            lateral_over_length: gait.lateral_over_length,
            distance_over_length: self.optimum.distance_over_length,
            symmetric: gait.symmetric,
            arcs: gait.arcs.clone(),
            rotation: gait.rotation,
            objective,
            count: self.count,
        }
    }
}
