//! `swimmer sweep plan`: a spec becomes an immutable plan in a folder.

use std::path::PathBuf;

use operations::sweep::{self as operation, PlanOutput};

use super::shown;
use crate::failure::Outcome;
use crate::output::Output;
use crate::quantity::Rows;

/// Make a plan of a spec, as a rule: a hundred million designs plan as quickly as ten
///
/// The plan never changes; made again of the same spec it is the same. `status` then says how far it is.
#[derive(Debug, clap::Args)]
pub(crate) struct PlanSpec {
    /// The spec: a swimmer, an objective, [bounds] and one [[axis]] or more
    spec: PathBuf,
    /// The folder of the plan and of all that is found
    #[arg(short, long, value_name = "DIR")]
    output: PathBuf,
}

impl PlanSpec {
    pub(super) fn run(self, output: Output) -> Outcome {
        let planned = operation::plan(&self.spec, &self.output)?;
        output.rendered(&planned, &text(&planned));
        Ok(())
    }
}

/// Output as text.
fn text(output: &PlanOutput) -> Rows {
    let mut rows = Rows::default();
    rows.row("plan", output.plan.get(..16).unwrap_or_default())
        .row("objective", &output.objective)
        .row("designs", output.tasks.to_string());
    for axis in &output.axes {
        let values = match axis.count {
            0 => "drawn".to_owned(),
            count => format!("{count} values"),
        };
        rows.row("axis", format!("{}, {values}", axis.name));
    }
    rows.row(
        "blocks",
        format!("{} of {} designs", output.blocks, output.block_size),
    )
    .row(
        "next",
        format!("swimmer sweep run {}", shown(&output.folder)),
    );
    rows
}
