//! `swimmer optimize sideways`: the gait that moves most across its heading, without turning.

use gait_optimizer::{SidewaysError, SidewaysProblem, sideways};

use super::output::say_if_beyond;
use super::{Objective, SearchResult, Task};
use crate::bounds::CycleBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::playable::searched;
use crate::quantity;
use crate::threads;

/// Find the simple closed gait of most displacement across the heading at its first sample, without net rotation
///
/// The first sample is free to choose, so it is part of what is optimised: either the heading there is square to the
/// displacement, or as near to it as the loop gets. Only simple loops count, so a wider bound can lower the displacement: a loop
/// that no longer runs into the corner that it starts from is lost.
#[derive(Debug, clap::Args)]
pub(crate) struct Sideways {
    #[command(flatten)]
    bounds: CycleBounds,
}

impl Objective for Sideways {
    const WRITES: &'static str = "Write the gait, at constant power, as a gait file";

    fn search(&self, task: &Task) -> Outcome<SearchResult> {
        let problem = SidewaysProblem {
            bounds: self.bounds.of(&task.file),
            threads: threads::available(),
            ..SidewaysProblem::new(task.file.swimmer)
        };
        let robot = (&task.file, self.bounds.playable());
        let found = task.watched("looking for loops", |watch| {
            let search = |bounds| Ok(sideways(&SidewaysProblem { bounds, ..problem }, watch)?);
            searched(
                robot,
                problem.bounds,
                |found: &gait_optimizer::Sideways| &found.gait,
                search,
            )
        })?;
        let gait = &found.gait;
        say_if_beyond(task, gait);
        let signed = |value: f64| (value * 1e9).round() / 1e9 + 0.0;
        let mut document = Document::new(format!(
            "{}, a local optimum of displacement sideways",
            task.file.name
        ));
        document
            // Across the heading at the first sample, positive, and along it.
            .key("lateral_over_length", found.lateral_over_length)
            .key("displacement_over_length", gait.displacement_over_length)
            .key("rotation_rad", gait.rotation)
            .key("heading_rad", gait.heading())
            .key("loops", found.loops)
            .key("arcs", gait.arcs.clone())
            .row(
                "sideways",
                format!("|Y|/L = {:.9}", found.lateral_over_length),
            )
            .row(
                "along the heading",
                format!("X/L = {:.9}", signed(gait.displacement_over_length)),
            )
            .row("net rotation", quantity::angle(gait.rotation))
            .row("arcs", gait.arcs.len().to_string())
            .row(
            "best of",
            format!(
                "the {} simple loops found, each with its best first sample; `swimmer optimize displacement` finds gaits of \
                 other kinds",
                found.loops
            ),
        );
        Ok(SearchResult::gait(document, task, gait, None))
    }
}

impl From<SidewaysError> for Failure {
    /// A problem that makes no sense is bad input; one without an optimum was tried.
    fn from(error: SidewaysError) -> Self {
        match error {
            SidewaysError::Problem(_) => Self::bad_input(&error),
            SidewaysError::NoOptimum { .. } => Self::tried(&error),
        }
    }
}
