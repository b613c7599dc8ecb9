//! Experiment without an operator: gaits × repeats in randomised blocks, run, resumed and compared.
//!
//! ```text
//!  Spec ──► Plan ──► Run ──► Journal ──► Comparison
//!  (TOML)  (order)  (poses and events in, requests out)
//! ```
//!
//! In an adaptive campaign ([`AdaptiveSpec`]) the plan names the gaits, and the journal the trials: [`crate::adaptive`] chooses each one by
//! those before.
//!
//! - [`Spec`]: the gaits, repeats, start pose and stop rules, as a person writes them.
//! - [`Plan`]: the ordered list of [`Trial`]s. The same spec and seed give the same plan.
//! - [`Run`]: the state machine of one trial after the other.
//! - [`Journal`]: the events so far, one JSON line each. It decides which trials are left.
//! - [`compare`]: measured against predicted displacement, and each optimum against its neighbours.

mod compare;
mod journal;
mod plan;
mod run;
mod spec;

pub use compare::{Better, Comparison, GaitSummary, Measure, compare};
pub use journal::{Entry, Journal, JournalError, MeasuredCycle, Record, TrialQuantities};
pub use plan::{LeftOut, Plan, PlannedGait, Trial, randomised};
pub use run::{Request, Run, RunEnding};
pub use spec::{AdaptiveSpec, GaitSource, Spec, SpecGait, SpecPeriod, StartPose, StopRules};
