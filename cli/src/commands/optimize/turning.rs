//! `swimmer optimize turning`: the simple closed gait of most rotation per cycle.

use gait_optimizer::{TurningError, TurningProblem, turning};

use super::output::{add_arcs, say_if_beyond};
use super::{Objective, SearchResult, Task};
use crate::bounds::CycleBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::playable::searched;
use crate::quantity;

/// Find the simple closed gait that turns the swimmer most per cycle, with its certificate
///
/// It runs counter-clockwise round one connected region of the θ curvature and turns the swimmer to the left; reversed, to
/// the right. Without a bound the joints stay within half a turn, where a side link lies folded on the middle one.
#[derive(Debug, clap::Args)]
pub(crate) struct Turning {
    #[command(flatten)]
    bounds: CycleBounds,
}

impl Objective for Turning {
    const WRITES: &'static str = "Write the gait, at constant power, as a gait file";

    fn search(&self, task: &Task) -> Outcome<SearchResult> {
        let swimmer = task.file.swimmer;
        let search = |bounds| Ok(turning(&TurningProblem { swimmer, bounds })?);
        let robot = (&task.file, self.bounds.playable());
        let bounds = self.bounds.of(&task.file);
        let found = task.timed(|| {
            searched(
                robot,
                bounds,
                |found: &gait_optimizer::Turning| &found.gait,
                search,
            )
        })?;
        let gait = &found.gait;
        say_if_beyond(task, gait);
        let mut document = Document::new(format!(
            "{}, most rotation, {}",
            task.file.name, gait.bounds
        ));
        document
            .key("rotation_rad", gait.rotation)
            // Connected, of that sign.
            .key("regions", found.regions)
            .key("displacement_over_length", gait.displacement_over_length)
            .key("lateral_over_length", gait.lateral_over_length)
            .row(
                "rotation",
                format!(
                    "{} per cycle, {:.10} rad",
                    quantity::angle(gait.rotation),
                    gait.rotation
                ),
            )
            .row(
                "displacement",
                format!(
                    "X/L = {:.8}, Y/L = {:.8}",
                    gait.displacement_over_length, gait.lateral_over_length
                ),
            );
        add_arcs(&mut document, &gait.arcs);
        let regions = match found.regions {
            1 => "the one region of positive θ curvature".to_owned(),
            count => format!("each of the {count} regions of positive θ curvature"),
        };
        document.row(
            "best of",
            format!(
                "simple loops, round {regions}: no other simple loop within one region turns more"
            ),
        );
        Ok(SearchResult::gait(document, task, gait, None))
    }
}

impl From<TurningError> for Failure {
    /// A problem that makes no sense is bad input; one without a gait was tried.
    fn from(error: TurningError) -> Self {
        match error {
            TurningError::Problem(_) => Self::bad_input(&error),
            _ => Self::tried(&error),
        }
    }
}
