//! Events of robot and cameras.

use crate::{Evaluated, Pose};

/// Event of robot and cameras. Times are on the clock of the poses.
#[derive(Debug, Clone, PartialEq)]
pub enum Event {
    /// A tracked pose.
    Pose(Pose),
    /// The requested play began; the first set-point of its first cycle was at this time \[s\].
    Began(f64),
    /// The robot came to rest with straight joints \[s\].
    AtRest(f64),
    /// The evaluation of a cycle is done.
    Evaluated(Box<Evaluated>),
    /// Something that ends the run.
    Interrupted(Interruption),
}

/// Event that ends a run. Another run goes on.
#[derive(Debug, Clone, PartialEq)]
pub enum Interruption {
    /// The operator stopped.
    Operator,
    /// The robot stopped by itself, was e-stopped or refused, for this reason: battery, brown-out, e-stop.
    Robot(String),
    /// The link to the robot was lost, for this reason.
    Link(String),
}
