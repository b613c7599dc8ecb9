//! Why a track gave no cycles.

use super::periodicity::Periodicity;

/// Why a track gave no cycles.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum CycleError {
    /// The robot never moves.
    #[error("the robot does not move in this track")]
    NoMotion,
    /// The track holds less than two cycles of this period.
    #[error(
        "the track is {track_s:.2} s long, less than two cycles of {period_s} s; check period_s, or record longer"
    )]
    TooShort {
        /// From the first to the last sample \[s\].
        track_s: f64,
        /// The period \[s\].
        period_s: f64,
    },
    /// A cycle of this period is over within a few samples.
    #[error(
        "the cameras took {samples:.2} samples in a cycle of {period_s} s, too few to see one; check period_s (it is in seconds)"
    )]
    TooQuick {
        /// Rows in one period.
        samples: f64,
        /// The period \[s\].
        period_s: f64,
    },
    /// Not one whole cycle.
    #[error(
        "the robot moves for {active_s:.2} s, from {from_s:.2} s on, and no cycle of {period_s:.3} s in it is whole and clean \
         ({left_out} left out); check period_s, or record longer"
    )]
    NoCycle {
        /// From when it moves \[s\].
        from_s: f64,
        /// How long it moves \[s\].
        active_s: f64,
        /// The period \[s\].
        period_s: f64,
        /// Cycles that were left out.
        left_out: usize,
    },
    /// The heading does not swing, so nothing tells where a cycle starts.
    #[error(
        "the heading does not swing with the period of {period_s:.3} s; check period_s and the gait"
    )]
    NoPhase {
        /// The period \[s\].
        period_s: f64,
    },
    /// The heading repeats, but with another period.
    #[error("{0}")]
    OtherPeriod(Periodicity),
}
