//! Reasons for the end of a run.

use std::fmt;

use crate::monitor::Likeness;

/// Reason for the end of a run.
#[derive(Debug, Clone, PartialEq)]
pub enum Ending {
    /// The last target is reached.
    Reached,
    /// All cycles are done, and the heading was held.
    Held {
        /// Largest angle from the heading at a rest \[rad\].
        worst_rad: f64,
    },
    /// The robot was not seen.
    TrackingLost {
        /// Duration \[s\].
        seconds: f64,
    },
    /// The robot came nearer to a wall than the margin.
    OutsideMargin,
    /// No chain of cycles leads to the target within the walls.
    NoWay,
    /// The target is not reached after the most cycles.
    TooManyCycles(u32),
    /// The robot does not do what it is requested to.
    Departed(Likeness),
    /// The robot would refuse the next cycle, for this reason.
    Refused(String),
    /// The operator stopped.
    StoppedByOperator,
    /// The robot stopped by itself or was lost, for this reason.
    RobotStopped(String),
}

impl Ending {
    /// Returns `true` if the goal is reached.
    pub fn is_success(&self) -> bool {
        matches!(self, Self::Reached | Self::Held { .. })
    }
}

impl fmt::Display for Ending {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Reached => f.write_str("the target is reached"),
            Self::Held { worst_rad } => write!(
                f,
                "the heading was held within {:.2}°",
                worst_rad.to_degrees()
            ),
            Self::TrackingLost { seconds } => write!(
                f,
                "the robot was not seen for {seconds:.1} s; check the cameras, then start again"
            ),
            Self::OutsideMargin => f.write_str(
                "the robot came nearer to a wall than the margin; move it away by hand, then start again",
            ),
            Self::NoWay => f.write_str(
                "no chain of cycles leads to the target within the walls; name a target farther from the walls or a larger tank",
            ),
            Self::TooManyCycles(cycles) => write!(
                f,
                "the target is not reached after {cycles} cycles; calibrate the swimmer, or allow more with --within"
            ),
            Self::Departed(likeness) => write!(f, "the robot departs from the prediction: {likeness}"),
            Self::Refused(reason) => f.write_str(reason),
            Self::StoppedByOperator => f.write_str("the operator stopped"),
            Self::RobotStopped(reason) => write!(f, "the robot stopped: {reason}"),
        }
    }
}
