//! Errors of the fastest-gait search.

use swimmer_files::Bounds;
use swimmer_model::InvalidSwimmer;

use crate::immobile::Immobile;

/// Failure of the fastest-gait search.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SpeedError {
    /// The swimmer's parameters are out of range.
    #[error("cannot look for the fastest gait of this swimmer: {0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// No gait moves the swimmer.
    #[error("{0}")]
    Immobile(Immobile),
    /// A rate is not positive and finite.
    #[error("servos cannot turn by at most {rate} rad/s; give a rate above 0")]
    Rate {
        /// The given value.
        rate: f64,
    },
    /// A period is not positive and finite.
    #[error("a gait cannot take {period} s; give a period above 0")]
    Period {
        /// The given value.
        period: f64,
    },
    /// Bounds that hold for a quarter of a gait only.
    #[error(
        "the fastest gait is looked for over whole cycles, which min-angle and sector do not bound ({bounds}); leave them out"
    )]
    OfQuarters {
        /// The bounds.
        bounds: Bounds,
    },
    /// Fewer corners than a closed curve has.
    #[error("a gait has at least 3 corners, not {corners}")]
    Corners {
        /// The given value.
        corners: usize,
    },
    /// A common shape is not well within the bounds.
    #[error(
        "gaits cannot join at ({:.4}, {:.4}) rad, which lies not 0.02 rad within the bounds; name another shape, or none", shape[0], shape[1]
    )]
    Shape {
        /// The given shape \[rad\].
        shape: [f64; 2],
    },
    /// No steering gait of one kind was found.
    #[error(
        "no fastest {kind} gait to steer by under these bounds ({bounds}): {starts} starts led to {chains} certified gaits of this \
         kind, and none through a common shape; try wider bounds or another shape"
    )]
    NoJoinedGait {
        /// The kind.
        kind: &'static str,
        /// The bounds.
        bounds: Bounds,
        /// Closed curves from which the search started.
        starts: usize,
        /// Certified gaits of this kind that do not join.
        chains: usize,
    },
    /// No gait was found and certified.
    #[error(
        "no fastest gait under these bounds ({bounds}): {starts} starts led to {chains} chains of arcs, none of which can be \
         certified{}; try wider bounds",
        uncertified.map_or_else(String::new, |speed| format!(" (the fastest swims {speed:.6} L a second)"))
    )]
    NoGait {
        /// The bounds.
        bounds: Bounds,
        /// Closed curves from which the search started.
        starts: usize,
        /// Chains found from them.
        chains: usize,
        /// Speed over L of the fastest uncertified chain \[1/s\].
        uncertified: Option<f64>,
    },
}

impl From<Immobile> for SpeedError {
    fn from(error: Immobile) -> Self {
        Self::Immobile(error)
    }
}
