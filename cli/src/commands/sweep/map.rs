//! `swimmer sweep map`: a finished grid over two of its axes, drawn, exported, and looked over for odd designs.

use std::fmt;
use std::path::PathBuf;

use clap::ValueEnum;
use serde::Serialize;
use sweep::{Doubt, DoubtKind, Field, Map as Found, Plan, Slice, doubts, map};
use swimmer_files::write_atomically;

use super::picture;
use super::shown;
use crate::failure::{Failure, Outcome};
use crate::new_file::may_be_written;
use crate::output::{Output, document};
use crate::picture_file::Kind;
use crate::quantity::{Rows, Table};

/// Draw a finished grid over two of its axes, with lines where the kind of gait changes
///
/// Also listed are designs that their neighbours cast doubt on: a tighter bound does better, both neighbours have a gait, or
/// what is best jumps. Designs without a gait stay white.
#[derive(Debug, clap::Args)]
pub(crate) struct Map {
    /// The folder of the plan
    folder: PathBuf,
    /// The axis to the right; by default the first one
    #[arg(long, value_name = "AXIS", value_parser = field)]
    across: Option<Field>,
    /// The axis upwards; by default the second one
    #[arg(long, value_name = "AXIS", value_parser = field)]
    up: Option<Field>,
    /// Value on another axis, as drag.chi=2 or objective=speed: the nearest one is taken; by default the first one
    #[arg(long, value_name = "AXIS=VALUE", value_parser = at)]
    at: Vec<(Field, f64)>,
    /// Quantity of the map
    #[arg(long, value_enum, default_value_t = MapQuantity::Displacement)]
    quantity: MapQuantity,
    /// Write the picture: .svg, .png in pixels, or .pdf for print
    #[arg(short, long, value_name = "FILE.svg|.png|.pdf")]
    output: Option<PathBuf>,
    /// Write the map's numbers as JSON, which the lab page reads
    #[arg(long, value_name = "FILE.json")]
    export: Option<PathBuf>,
}

/// Quantity of the map.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(super) enum MapQuantity {
    /// X/L of the best gait
    Displacement,
    /// Lighthill's efficiency
    Efficiency,
    /// Fastest, under the servos' rates of the spec
    Speed,
    /// Largest joint angle
    Amplitude,
    /// Rotation of a cycle
    Rotation,
    /// Y/L of a cycle
    Lateral,
    /// Arcs of the gait
    Structure,
    /// Speed against efficiency of all designs that no other one beats in both
    Pareto,
}

#[derive(Debug, Serialize)]
struct MapOutput {
    plan: String,
    tasks: u64,
    done: u64,
    failed: u64,
    /// Of the slice.
    designs: usize,
    without_gait: usize,
    uncertified: usize,
    /// Number of kinds of gait, by their arcs.
    kinds: usize,
    folds: usize,
    pareto: usize,
    /// Of the whole plan.
    doubts: Vec<Doubt>,
    picture: Option<PathBuf>,
    export: Option<PathBuf>,
}

impl Map {
    pub(super) fn run(self, output: Output) -> Outcome {
        let kind = match &self.output {
            Some(path) => {
                may_be_written(path)?;
                Some(Kind::of(path, &[Kind::Svg, Kind::Png, Kind::Pdf])?)
            }
            None => None,
        };
        if let Some(path) = &self.export {
            may_be_written(path)?;
        }
        let plan = Plan::load(&self.folder)?;
        let slice = self.slice(&plan)?;
        let found = map(&plan, &self.folder, &slice)?;
        let doubts = doubts(&plan, &self.folder)?;
        if let (Some(path), Some(kind)) = (&self.output, kind) {
            kind.write(path, &picture::drawn(&found, self.quantity)?)?;
        }
        if let Some(path) = &self.export {
            write_atomically(path, document(&found).as_bytes())?;
        }
        output.print(&MapOutput::new(
            &plan,
            &found,
            doubts,
            self.output,
            self.export,
        ));
        Ok(())
    }

    fn slice(&self, plan: &Plan) -> Outcome<Slice> {
        let mut slice = Slice::first(plan).ok_or_else(|| {
            Failure::BadInput(
                "a map needs a grid of two axes or more; read the merged table instead".to_owned(),
            )
        })?;
        let place = |field: Field| {
            let mut axes = plan.axes().iter();
            axes.position(|axis| axis.name == field).ok_or_else(|| {
                let all: Vec<_> = plan.axes().iter().map(|axis| axis.name.name()).collect();
                Failure::BadInput(format!(
                    "{field} is no axis of this plan, which has {}",
                    all.join(", ")
                ))
            })
        };
        let given = [self.across, self.up].map(|field| field.map(place).transpose());
        let [across, up] = given;
        let (across, up) = (across?, up?);
        let other = |taken: usize| usize::from(taken == 0);
        slice.axes = match (across, up) {
            (Some(across), Some(up)) => [across, up],
            (Some(across), None) => [across, other(across)],
            (None, Some(up)) => [other(up), up],
            (None, None) => slice.axes,
        };
        for (field, value) in &self.at {
            let axis = place(*field)?;
            let values = &plan.axes()[axis];
            let off = |index: &u64| (values.value(*index) - value).abs();
            let nearest = (0..values.count()).min_by(|a, b| off(a).total_cmp(&off(b)));
            slice.at[axis] = nearest.unwrap_or(0);
        }
        Ok(slice)
    }
}

impl MapOutput {
    fn new(
        plan: &Plan,
        found: &Found,
        doubts: Vec<Doubt>,
        picture: Option<PathBuf>,
        export: Option<PathBuf>,
    ) -> Self {
        let is = |word: &str| {
            found
                .status
                .iter()
                .flatten()
                .filter(|one| **one == word)
                .count()
        };
        let kinds: std::collections::BTreeSet<_> =
            found.structure.iter().flatten().flatten().collect();
        Self {
            plan: plan.hash(),
            tasks: plan.tasks(),
            done: plan.tasks(),
            failed: found.designs_without_gait,
            designs: found.status.iter().map(Vec::len).sum(),
            without_gait: is("none"),
            uncertified: is("uncertified"),
            kinds: kinds.len(),
            folds: found.folds.len(),
            pareto: found.pareto.len(),
            doubts,
            picture,
            export,
        }
    }
}

/// Largest number of doubts that are listed singly.
const TOLD: usize = 12;

impl fmt::Display for MapOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let count = |kind| {
            self.doubts
                .iter()
                .filter(|doubt| doubt.kind == kind)
                .count()
        };
        let mut rows = Rows::default();
        rows.row("designs drawn", self.designs.to_string())
            .row("without a gait", self.without_gait.to_string())
            .row("not certified", self.uncertified.to_string())
            .row("kinds of gait", self.kinds.to_string())
            .row(
                "not beaten in speed and efficiency",
                self.pareto.to_string(),
            )
            .row(
                "unlike their neighbours",
                format!(
                    "{} beaten by a tighter bound, {} lost, {} jumps",
                    count(DoubtKind::Beaten),
                    count(DoubtKind::Lost),
                    count(DoubtKind::Jump)
                ),
            );
        for (what, path) in [("picture", &self.picture), ("numbers", &self.export)] {
            if let Some(path) = path {
                rows.row(what, shown(path));
            }
        }
        write!(f, "{rows}")?;
        if self.doubts.is_empty() {
            return Ok(());
        }
        let mut table = Table::new(["look at", "what", "its neighbour", "better by"]);
        for doubt in self.doubts.iter().take(TOLD) {
            table.line([
                doubt.key.to_string(),
                match doubt.kind {
                    DoubtKind::Beaten => "beaten",
                    DoubtKind::Lost => "lost",
                    DoubtKind::Jump => "jump",
                }
                .to_owned(),
                doubt.neighbour.to_string(),
                doubt
                    .share
                    .map_or_else(String::new, |share| format!("{:.3} %", 100.0 * share)),
            ]);
        }
        write!(f, "\n\n{table}")?;
        if self.doubts.len() > TOLD {
            write!(
                f,
                "\n  and {} more (--json lists all)",
                self.doubts.len() - TOLD
            )?;
        }
        Ok(())
    }
}

fn field(text: &str) -> Result<Field, String> {
    let all = Field::ALL.map(Field::name);
    Field::ALL
        .into_iter()
        .find(|field| field.name() == text)
        .ok_or_else(|| format!("an axis is one of {}", all.join(", ")))
}

fn at(text: &str) -> Result<(Field, f64), String> {
    let (name, value) = text
        .split_once('=')
        .ok_or_else(|| "write an axis and its value, as drag.chi=2".to_owned())?;
    let field = field(name)?;
    let value = field
        .parse(value)
        .ok_or_else(|| format!("{value} is no value of {field}"))?;
    Ok((field, value))
}
