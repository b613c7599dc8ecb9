//! `swimmer optimize sideways`: the gait that moves most across its heading, without turning.

use gait_optimizer::{SidewaysError, SidewaysProblem, sideways};

use super::answer::say_if_beyond;
use super::{Found, Objective, Task};
use crate::bounds::WholeBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::quantity;
use crate::threads;

/// Find the simple closed gait of most displacement across the heading at its first sample, without net rotation
///
/// The first sample is free to choose, so it is part of what is optimised: either the heading there is square to the
/// displacement, or as near to it as the loop gets. Bridges to another start do not count, so a wider bound can lower the
/// answer: where a loop can no longer run into the corner that it starts from, only a bridge would lead there.
#[derive(Debug, clap::Args)]
pub(crate) struct Sideways {
    #[command(flatten)]
    bounds: WholeBounds,
}

impl Objective for Sideways {
    const WRITES: &'static str = "Write the gait, at constant power, as a gait file";

    fn search(&self, task: &Task) -> Outcome<Found> {
        let problem = SidewaysProblem {
            bounds: self.bounds.of(&task.file),
            threads: threads::available(),
            ..SidewaysProblem::new(task.file.swimmer)
        };
        let found = task.watched("looking for loops", |watch| sideways(&problem, watch))?;
        let gait = &found.gait;
        say_if_beyond(task, gait);
        let signed = |value: f64| (value * 1e9).round() / 1e9 + 0.0;
        let mut answer = Document::new(format!(
            "{}, a local optimum of displacement sideways",
            task.file.name
        ));
        answer
            // Across the heading at the first sample, positive, and along it.
            .key("lateral_over_length", found.lateral_over_length)
            .key("displacement_over_length", gait.displacement_over_length)
            // What bridges to another start, which do not count, would come near to; null where nobody knows how far gaits carry.
            .key(
                "bridged_supremum_over_length",
                found.bridged_supremum_over_length,
            )
            // Of a known gait that moves farther across and is no optimum.
            .key_if("outdone_over_length", found.outdone_over_length)
            // Null: these gaits do not rotate, and what bridges would bring is the length above.
            .key("bridged_supremum_rad", None::<f64>)
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
            .row(
                "with bridges",
                found.bridged_supremum_over_length.map_or_else(
                    || "nobody knows how far: gaits that are no optima carry farther than every loop found".to_owned(),
                    |supremum| format!("up to |Y|/L = {supremum:.9}"),
                ),
            )
            .row("net rotation", quantity::angle(gait.rotation));
        if let Some(farther) = found.outdone_over_length {
            answer.row(
                "outdone",
                format!(
                    "|Y|/L = {farther:.9} by a gait that touches its own image, which is no optimum"
                ),
            );
        }
        answer.row("arcs", gait.arcs.len().to_string()).row(
            "best of",
            format!(
                "the {} simple loops found, each with its best first sample; `swimmer optimize displacement` finds gaits of \
                 other kinds",
                found.loops
            ),
        );
        Ok(Found::gait(answer, task, gait, None))
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
