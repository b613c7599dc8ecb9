//! `swimmer sweep plan`: a spec becomes an immutable plan in a folder.

use std::fmt;
use std::path::{Path, PathBuf};

use serde::Serialize;
use sweep::{Aim, Design, Plan};
use swimmer_files::FileError;

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

#[derive(Debug, Serialize)]
struct PlanOutput {
    plan: String,
    folder: PathBuf,
    objective: String,
    tasks: u64,
    done: u64,
    failed: u64,
    blocks: u64,
    block_size: u64,
    axes: Vec<AxisOutput>,
}

#[derive(Debug, Serialize)]
struct AxisOutput {
    name: &'static str,
    unit: &'static str,
    /// Number of points of a grid; 0 in the other designs.
    count: u64,
}

impl PlanSpec {
    pub(super) fn run(self, output: Output) -> Outcome {
        let text = std::fs::read_to_string(&self.spec).map_err(|source| FileError::Read {
            path: self.spec.clone(),
            source,
        })?;
        let plan = Plan::of_spec(&text, &self.spec)?;
        plan.save(&self.output)?;
        output.print(&PlanOutput::new(&plan, &self.output));
        Ok(())
    }
}

impl PlanOutput {
    fn new(plan: &Plan, folder: &Path) -> Self {
        Self {
            plan: plan.hash(),
            folder: folder.to_path_buf(),
            objective: {
                let words: Vec<_> = plan.objectives().into_iter().map(Aim::word).collect();
                words.join(", ")
            },
            tasks: plan.tasks(),
            done: 0,
            failed: 0,
            blocks: plan.blocks(),
            block_size: plan.block_size(),
            axes: plan
                .axes()
                .iter()
                .map(|axis| AxisOutput {
                    name: axis.name.name(),
                    unit: axis.name.unit(),
                    count: if plan.design() == Design::Grid {
                        axis.count()
                    } else {
                        0
                    },
                })
                .collect(),
        }
    }
}

impl fmt::Display for PlanOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row("plan", self.plan.get(..16).unwrap_or_default())
            .row("objective", &self.objective)
            .row("designs", self.tasks.to_string());
        for axis in &self.axes {
            let values = match axis.count {
                0 => "drawn".to_owned(),
                count => format!("{count} values"),
            };
            rows.row("axis", format!("{}, {values}", axis.name));
        }
        rows.row(
            "blocks",
            format!("{} of {} designs", self.blocks, self.block_size),
        )
        .row("next", format!("swimmer sweep run {}", shown(&self.folder)));
        write!(f, "{rows}")
    }
}
