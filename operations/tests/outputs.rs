//! Outputs of the operations: their contracts, and their values against independent evaluations.

#[path = "outputs/cancelled.rs"]
mod cancelled;
#[path = "outputs/contracts/mod.rs"]
mod contracts;
#[path = "outputs/efficiency.rs"]
mod efficiency;
#[path = "outputs/plan.rs"]
mod plan;
