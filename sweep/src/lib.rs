//! Thousands of designs: the best gait of each, on as many machines as there are, as one table.
//!
//! A *spec* (TOML) names a swimmer, an objective and axes. [`Plan::of_spec`] makes a *plan* of it: immutable, with a hash of its
//! content, and a rule instead of a list, so that 10⁸ tasks cost no more than ten. A *task* is one design; its key is its number,
//! and [`Plan::point`] gives the values of its axes. Tasks run in *blocks* of consecutive keys: a block is what is run, skipped
//! and written as a whole. Inside a block neighbours start from each other's gaits (`warm`), in an order that the block's keys
//! fix, so that an answer depends neither on the split over machines nor on threads. A finished block is a *part*, one file with
//! its hash; [`merge`] makes one Parquet file of all parts, sorted by key.
//!
//! | module | what lives there |
//! |---|---|
//! | `spec` | what people write |
//! | `plan` | what it becomes: the rule from a key to a point |
//! | `field` | what an axis can change |
//! | `objective` | one design solved, from nothing or from its neighbour's gait |
//! | `warm` | a block: its order, and when a neighbour's gait is trusted |
//! | `row` | what is kept of a design |
//! | `part` | a finished block on the disk |
//! | `run` | blocks over shards and threads |
//! | `status` | how far all shards are, and what a design cost |
//! | `merge` | all parts as one Parquet file |
//! | `map` | two axes of a grid as a picture's numbers; folds, the Pareto set, designs that their neighbours beat |
//! | `slurm` | the script of a job array |
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
pub use map::{Doubt, DoubtKind, Map, MapAxis, Pareto, Quantity, Slice, doubts, map};
pub use merge::{Merged, merge};
pub use objective::Aim;
pub use plan::{Axis, Design, Plan, Scale, Values};
pub use row::Row;
pub use run::{Ran, Running, Shard, run};
pub use slurm::{Slurm, time_limit};
pub use status::{Status, status};
