//! Sweeps over thousands of designs: the best gait of each, computed on any number of machines, as one table.
//!
//! A *spec* (TOML) names a swimmer, an objective and axes. [`Plan::of_spec`] converts it to a *plan*, which is immutable and has a
//! hash of its content. The plan is a rule, not a list, so 10⁸ tasks need no more memory than ten. A *task* is one design. Its
//! key is its number, and [`Plan::point`] returns the values of its axes. Tasks run in *blocks* of consecutive keys; a block is
//! run, skipped and written as a whole. Within a block, neighbours start from each other's gaits (`warm`) in an order that the
//! keys determine. A result therefore depends neither on the number of machines nor on threads. A finished block is a *part*, one
//! file with its hash; [`merge`] writes one Parquet file of all parts, sorted by key.
//!
//! | module | contents |
//! |---|---|
//! | `spec` | reader of the spec |
//! | `plan` | plan: the rule from a key to a point |
//! | `field` | parameters that an axis can vary |
//! | `objective` | solution of one design, by a search or from a neighbour's gait |
//! | `warm` | solution of a block: its order, and the check of warm starts |
//! | `row` | result of a design |
//! | `part` | file of a finished block |
//! | `run` | execution of blocks over shards and threads |
//! | `status` | progress of all shards, and time per design |
//! | `merge` | Parquet file of all parts |
//! | `map` | data of a map over two axes; folds, Pareto set, doubtful designs |
//! | `slurm` | script of a job array |
//!
//! ```
//! use sweep::{Plan, Running, Shard, Slice, doubts, map, merge, run, status, time_limit};
//!
//! # let folder = tempfile::tempdir().unwrap();
//! # let folder = folder.path();
//! let spec = r#"
//! swimmer = "purcell"
//! objective = "displacement"
//! [[axis]]
//! name = "drag.chi"
//! values = [1.9, 2.0]
//! [[axis]]
//! name = "sphere.radius"
//! values = [0.0, 0.1]
//! "#;
//! let plan = Plan::of_spec(spec, "spec.toml".as_ref()).unwrap();
//! assert_eq!(plan.tasks(), 4);
//! plan.save(folder)?;
//! run(&plan, folder, &Running { shard: Shard::WHOLE, threads: 1, seconds: &|| 0.0, watch: &|_| () })?;
//! let found = status(&plan, folder)?;
//! assert_eq!((found.done, found.failed), (4, 0));
//! assert_eq!(time_limit(&found, 1, 1), Some(5), "nothing is left to do");
//! merge(&plan, folder, &folder.join("all.parquet"))?;
//! let drawn = map(&plan, folder, &Slice::first(&plan).unwrap())?;
//! assert_eq!(drawn.axes[1].values, [0.0, 0.1]);
//! assert!(doubts(&plan, folder)?.is_empty());
//! # Ok::<(), sweep::SweepError>(())
//! ```

mod error;
mod field;
mod map;
mod merge;
mod objective;
mod part;
mod plan;
mod row;
mod run;
mod slurm;
mod spec;
mod status;
mod warm;

pub use error::SweepError;
pub use field::Field;
pub use map::{Doubt, DoubtKind, Map, MapAxis, Pareto, PlanAxis, Quantity, Slice, doubts, map};
pub use merge::{Merged, merge};
pub use objective::Aim;
pub use plan::{Axis, Design, Plan, Scale, Values};
pub use row::Row;
pub use run::{Ran, Running, Shard, run};
pub use slurm::{Slurm, time_limit};
pub use status::{Status, status};
