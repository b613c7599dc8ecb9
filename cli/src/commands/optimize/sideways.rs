//! `swimmer optimize sideways`: the gait that moves most across its heading, without turning.

use operations::optimize::GaitOutput;
use operations::optimize::sideways::{self, Output, Request};
use operations::{Context, SwimmerSource};

use super::Objective;
use super::text::{add_gait, titled};
use crate::bounds::CycleBounds;
use crate::failure::Outcome;
use crate::quantity::{self, Rows};

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

    type Output = Output;

    fn search(&self, swimmer: SwimmerSource, context: &mut Context) -> Outcome<Output> {
        let bounds = self.bounds.into();
        Ok(sideways::run(&Request { swimmer, bounds }, context)?)
    }

    fn gait(output: &mut Output) -> &mut GaitOutput {
        &mut output.gait
    }

    fn text(output: &Output) -> String {
        let signed = |value: f64| (value * 1e9).round() / 1e9 + 0.0;
        let mut rows = Rows::default();
        rows.row(
            "sideways",
            format!("|Y|/L = {:.9}", output.lateral_over_length),
        )
        .row(
            "along the heading",
            format!("X/L = {:.9}", signed(output.displacement_over_length)),
        )
        .row("net rotation", quantity::angle(output.rotation_rad))
        .row("arcs", output.arcs.len().to_string())
        .row(
            "best of",
            format!(
                "the {} simple loops found, each with its best first sample; `swimmer optimize displacement` finds gaits of \
                 other kinds",
                output.loops
            ),
        );
        add_gait(&mut rows, &output.gait);
        let title = format!("{}, a local optimum of displacement sideways", output.name);
        titled(&title, &rows)
    }
}
