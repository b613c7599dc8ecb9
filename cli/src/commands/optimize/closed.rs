//! Gaits of a swimmer without the paper's symmetries: the closed-curve search of `swimmer atlas` in place of the quarter solvers.

use gait_optimizer::{AtlasProblem, Bounds, Objective, OptimalGait, Optimum, atlas_watched};

use super::Task;
use super::output::add_arcs;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::playable::searched;
use crate::quantity;
use crate::threads;

/// Number of random starts.
const STARTS: usize = 48;

/// Best certified gait of the closed-curve search.
pub(super) struct Closed {
    optimum: Optimum,
    /// Number of certified gaits among which it is the best.
    count: usize,
}

impl Closed {
    /// Searches within bounds. `is_playable` holds the gait within what the robot can play.
    ///
    /// # Errors
    /// The problem is invalid, or no start leads to a certified gait.
    pub(super) fn search(
        task: &Task,
        objective: Objective,
        bounds: Bounds,
        is_playable: bool,
    ) -> Outcome<Self> {
        let problem = AtlasProblem {
            starts: STARTS,
            threads: threads::available(),
            ..AtlasProblem::new(task.file.swimmer, objective)
        };
        task.watched("looking for closed curves", |watch| {
            let search = |bounds| {
                let mut optima = atlas_watched(&AtlasProblem { bounds, ..problem }, watch)?.optima;
                if optima.is_empty() {
                    return Err(Failure::Tried(format!(
                        "the side links differ, and none of {STARTS} closed curves led to a certified gait of most {objective}; \
                         `swimmer atlas --starts` takes more of them, and a bound on the angles helps"
                    )));
                }
                let count = optima.len();
                let optimum = optima.swap_remove(0);
                Ok(Self { optimum, count })
            };
            let robot = (&task.file, is_playable);
            searched(robot, bounds, |found: &Self| found.gait(), search)
        })
    }

    /// The gait.
    pub(super) fn gait(&self) -> &OptimalGait {
        &self.optimum.gait
    }

    /// Adds displacement, arcs and the class of gaits.
    pub(super) fn add(&self, document: &mut Document, objective: Objective) {
        let gait = self.gait();
        document
            .key("displacement_over_length", gait.displacement_over_length)
            .key("displacement_m", gait.displacement)
            .key("lateral_over_length", gait.lateral_over_length)
            .key("distance_over_length", self.optimum.distance_over_length)
            .key("symmetric", gait.symmetric)
            .row(
                "displacement",
                format!(
                    "|d|/L = {:.10}   X/L = {:.10}   Y/L = {:.10}",
                    self.optimum.distance_over_length,
                    gait.displacement_over_length,
                    gait.lateral_over_length
                ),
            )
            .row("net rotation", quantity::angle(gait.rotation));
        add_arcs(document, &gait.arcs);
        document.row(
            "best of",
            format!(
                "{} certified closed curves from {STARTS} starts: the side links differ, so no gait has the paper's symmetries; \
                 `swimmer atlas --objective {objective}` lists them all",
                self.count
            ),
        );
    }
}
