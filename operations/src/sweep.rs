//! Best gaits of many designs: a plan in a folder, its run block by block, and tables and maps of the results.

use std::path::{Path, PathBuf};

use serde::Serialize;
use sweep::{
    Aim, Design, Doubt, Field, Map, Merged, Plan, Ran, Running, Shard, Slice, Status, SweepError,
};
use swimmer_files::{FileError, hash_of};

use crate::context::Stage;
use crate::{Context, Error};

/// Largest table that is hashed, in bytes: a table that does not fit into memory is not read again.
const LARGEST_HASHED: u64 = 1 << 28;

/// A plan. The JSON document of `swimmer sweep plan`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepPlanOutput")
)]
pub struct PlanOutput {
    /// Hash of the plan.
    pub plan: String,
    /// Folder of the plan and of its results.
    pub folder: PathBuf,
    /// Objectives, separated by commas.
    pub objective: String,
    /// Number of designs.
    pub tasks: u64,
    /// Number of solved designs.
    pub done: u64,
    /// Number of designs without a gait.
    pub failed: u64,
    /// Number of blocks.
    pub blocks: u64,
    /// Number of designs of a block.
    pub block_size: u64,
    /// Axes.
    pub axes: Vec<AxisOutput>,
}

/// An axis of a plan.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepAxisOutput")
)]
pub struct AxisOutput {
    /// Name.
    pub name: &'static str,
    /// Unit.
    pub unit: &'static str,
    /// Number of points of a grid; 0 in other plans.
    pub count: u64,
}

/// Makes a plan of a spec and saves it in a folder.
///
/// # Errors
/// The spec cannot be read or is invalid, or the folder has another plan.
pub fn plan(spec: &Path, folder: &Path) -> Result<PlanOutput, Error> {
    let text = std::fs::read_to_string(spec).map_err(|source| FileError::Read {
        path: spec.to_owned(),
        source,
    })?;
    let plan = Plan::of_spec(&text, spec)?;
    plan.save(folder)?;
    let objectives: Vec<_> = plan.objectives().into_iter().map(Aim::word).collect();
    let axes = plan.axes().iter().map(|axis| AxisOutput {
        name: axis.name.name(),
        unit: axis.name.unit(),
        count: if plan.design() == Design::Grid {
            axis.count()
        } else {
            0
        },
    });
    Ok(PlanOutput {
        plan: plan.hash(),
        folder: folder.to_owned(),
        objective: objectives.join(", "),
        tasks: plan.tasks(),
        done: 0,
        failed: 0,
        blocks: plan.blocks(),
        block_size: plan.block_size(),
        axes: axes.collect(),
    })
}

/// A finished run of a shard. The JSON document of `swimmer sweep run`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepRunOutput")
)]
pub struct RunOutput {
    /// Hash of the plan.
    pub plan: String,
    /// Shard, as `2/7`.
    pub shard: String,
    /// Number of designs of the plan.
    pub tasks: u64,
    /// Counts of the shard.
    #[serde(flatten)]
    pub ran: Ran,
    /// Duration \[s\]; 0 if the front end has no clock.
    pub seconds: f64,
}

/// Solves the designs of a shard that are not solved yet.
///
/// # Errors
/// The plan cannot be read, or a result cannot be written.
pub fn run(folder: &Path, shard: Shard, context: &Context) -> Result<RunOutput, Error> {
    let plan = Plan::load(folder)?;
    let blocks = shard.blocks(&plan);
    let clock = context.clock;
    let timed = context.timed(Stage::Blocks, |watch| {
        sweep::run(
            &plan,
            folder,
            &Running {
                shard,
                threads: context.threads,
                seconds: &|| clock.map_or(0.0, |clock| clock()),
                watch: &|ran| watch(ran.done as f64 / blocks.max(1) as f64),
            },
        )
    });
    Ok(RunOutput {
        plan: plan.hash(),
        shard: shard.to_string(),
        tasks: plan.tasks(),
        ran: timed.result?,
        seconds: timed.seconds.unwrap_or(0.0),
    })
}

/// Reports the progress of all shards. Its output is the JSON document of `swimmer sweep status`.
///
/// # Errors
/// The plan cannot be read.
pub fn status(folder: &Path) -> Result<Status, Error> {
    Ok(sweep::status(&Plan::load(folder)?, folder)?)
}

/// A job array for a scheduler. The JSON document of `swimmer sweep submit`; the front end writes the script.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepSubmitOutput")
)]
pub struct SubmitOutput {
    /// Number of designs of the plan.
    pub tasks: u64,
    /// Number of solved designs.
    pub done: u64,
    /// Number of designs without a gait.
    pub failed: u64,
    /// Number of shards, each a task of the job array.
    pub shards: u64,
    /// Number of cores of each task.
    pub cores: u64,
    /// Time limit of each task \[min\].
    pub minutes: u64,
    /// Script of the job array.
    pub script: PathBuf,
    /// Number of the job array; null if it was not submitted.
    pub job: Option<String>,
}

/// A table of all designs. The JSON document of `swimmer sweep merge`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepMergeOutput")
)]
pub struct MergeOutput {
    /// Hash of the plan.
    pub plan: String,
    /// Number of designs of the plan.
    pub tasks: u64,
    /// Counts of the table.
    #[serde(flatten)]
    pub merged: Merged,
    /// The table.
    pub table: PathBuf,
    /// Its size in bytes.
    pub bytes: u64,
    /// Its hash; null for tables above 256 MiB.
    pub sha256: Option<String>,
}

/// Writes all designs of a finished sweep as one Parquet table.
///
/// # Errors
/// The plan or a result cannot be read, the sweep is not finished, or the table cannot be written.
pub fn merge(folder: &Path, table: &Path) -> Result<MergeOutput, Error> {
    let plan = Plan::load(folder)?;
    let merged = sweep::merge(&plan, folder, table)?;
    let read = |source| FileError::Read {
        path: table.to_owned(),
        source,
    };
    let bytes = std::fs::metadata(table).map_err(read)?.len();
    let sha256 = if bytes <= LARGEST_HASHED {
        Some(hash_of(table)?)
    } else {
        None
    };
    Ok(MergeOutput {
        plan: plan.hash(),
        tasks: plan.tasks(),
        merged,
        table: table.to_owned(),
        bytes,
        sha256,
    })
}

/// Slice of a grid over two of its axes.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct MapRequest {
    /// Folder of the plan.
    pub folder: PathBuf,
    /// Axis to the right; `None` for the first one.
    pub across: Option<Field>,
    /// Axis upwards; `None` for the second one.
    pub up: Option<Field>,
    /// Values on other axes, of which the nearest is taken; the first one if none is given.
    pub at: Vec<(Field, f64)>,
}

/// A map of a finished grid. The JSON document of `swimmer sweep map`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "SweepMapOutput")
)]
pub struct MapOutput {
    /// Hash of the plan.
    pub plan: String,
    /// Number of designs of the plan.
    pub tasks: u64,
    /// Number of solved designs: all.
    pub done: u64,
    /// Number of designs of the plan without a gait.
    pub failed: u64,
    /// Number of designs of the slice.
    pub designs: usize,
    /// Number of these without a gait.
    pub without_gait: usize,
    /// Number of these whose certificate does not pass.
    pub uncertified: usize,
    /// Number of kinds of gait in the slice, by their arcs.
    pub kinds: usize,
    /// Number of lines at which the kind of gait changes.
    pub folds: usize,
    /// Number of designs on the Pareto front of the plan.
    pub pareto: usize,
    /// Designs of the plan that differ from their neighbours.
    pub doubts: Vec<Doubt>,
    /// Picture, if the front end drew one.
    pub picture: Option<PathBuf>,
    /// File of the map's numbers, if the front end wrote one.
    pub export: Option<PathBuf>,
    /// The map, for pictures and files.
    #[serde(skip)]
    pub map: Map,
}

/// Evaluates a slice of a finished grid.
///
/// # Errors
/// The plan or a result cannot be read, the plan has no such axes, or the sweep is not finished.
pub fn map(request: &MapRequest) -> Result<MapOutput, Error> {
    let plan = Plan::load(&request.folder)?;
    let slice = request.slice(&plan)?;
    let map = sweep::map(&plan, &request.folder, &slice)?;
    let doubts = sweep::doubts(&plan, &request.folder)?;
    let statuses = || map.status.iter().flatten();
    let count = |word: &str| statuses().filter(|status| **status == word).count();
    let kinds: std::collections::BTreeSet<_> = map.structure.iter().flatten().flatten().collect();
    Ok(MapOutput {
        plan: plan.hash(),
        tasks: plan.tasks(),
        done: plan.tasks(),
        failed: map.designs_without_gait,
        designs: statuses().count(),
        without_gait: count("none"),
        uncertified: count("uncertified"),
        kinds: kinds.len(),
        folds: map.folds.len(),
        pareto: map.pareto.len(),
        doubts,
        picture: None,
        export: None,
        map,
    })
}

impl MapRequest {
    fn slice(&self, plan: &Plan) -> Result<Slice, Error> {
        let mut slice = Slice::first(plan).ok_or_else(|| {
            Error::refused("a map needs a grid of two axes or more; read the merged table instead")
        })?;
        let place = |field: Field| {
            let mut axes = plan.axes().iter();
            axes.position(|axis| axis.name == field).ok_or_else(|| {
                let all: Vec<_> = plan.axes().iter().map(|axis| axis.name.name()).collect();
                Error::refused(format!(
                    "{field} is no axis of this plan, which has {}",
                    all.join(", ")
                ))
            })
        };
        let [across, up] = [self.across, self.up].map(|field| field.map(place).transpose());
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

/// Axis by its name.
///
/// # Errors
/// There is no such axis; the message lists all.
pub fn field(name: &str) -> Result<Field, String> {
    let all = Field::ALL.map(Field::name);
    let found = Field::ALL.into_iter().find(|field| field.name() == name);
    found.ok_or_else(|| format!("an axis is one of {}", all.join(", ")))
}

impl From<SweepError> for Error {
    /// A spec, plan or request that makes no sense is bad input; everything else is a failure.
    fn from(error: SweepError) -> Self {
        if error.is_bad_input() {
            Self::bad_input(&error)
        } else {
            Self::failed(&error)
        }
    }
}
