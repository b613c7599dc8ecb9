//! Errors of the sideways search.

use swimmer_files::Bounds;

use crate::atlas::AtlasError;

/// Error of the sideways search.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum SidewaysError {
    /// The problem makes no sense.
    #[error("cannot look for a gait that moves sideways: {0}")]
    Problem(#[from] AtlasError),
    /// None was found and certified.
    #[error(
        "no gait that moves sideways under these bounds ({bounds}): of {loops} loops of most displacement none can \
         be certified with another start, and no loop with its start on a bound meets the conditions; give a bound on the \
         joint angles"
    )]
    NoOptimum {
        /// The bounds.
        bounds: Bounds,
        /// Loops of most displacement that were found.
        loops: usize,
    },
}
