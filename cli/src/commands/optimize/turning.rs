//! `swimmer optimize turning`: the simple closed gait of most rotation per cycle.

use operations::optimize::GaitOutput;
use operations::optimize::turning::{self, Output, Request};
use operations::{Context, SwimmerSource};

use super::Objective;
use super::text::{add_arcs, add_gait, titled};
use crate::bounds::CycleBounds;
use crate::failure::Outcome;
use crate::quantity::{self, Rows};

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

    type Output = Output;

    fn search(&self, swimmer: SwimmerSource, context: &mut Context) -> Outcome<Output> {
        let bounds = self.bounds.into();
        Ok(turning::run(&Request { swimmer, bounds }, context)?)
    }

    fn gait(output: &mut Output) -> &mut GaitOutput {
        &mut output.gait
    }

    fn text(output: &Output) -> String {
        let mut rows = Rows::default();
        rows.row(
            "rotation",
            format!(
                "{} per cycle, {:.10} rad",
                quantity::angle(output.rotation_rad),
                output.rotation_rad
            ),
        )
        .row(
            "displacement",
            format!(
                "X/L = {:.8}, Y/L = {:.8}",
                output.displacement_over_length, output.lateral_over_length
            ),
        );
        add_arcs(&mut rows, &output.arcs);
        let regions = match output.regions {
            1 => "the one region of positive θ curvature".to_owned(),
            count => format!("each of the {count} regions of positive θ curvature"),
        };
        rows.row(
            "best of",
            format!(
                "simple loops, round {regions}: no other simple loop within one region turns more"
            ),
        );
        add_gait(&mut rows, &output.gait);
        let title = format!("{}, most rotation, {}", output.name, output.bounds);
        titled(&title, &rows)
    }
}
