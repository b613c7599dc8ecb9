//! Outputs of the operations against independent evaluations.

#[path = "outputs/efficiency.rs"]
mod efficiency;
#[path = "outputs/plan.rs"]
mod plan;
