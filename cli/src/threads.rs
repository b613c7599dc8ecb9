//! Number of threads of a search; results never depend on it.

use std::num::NonZero;

/// Number of threads that the machine runs at once; one if it is unknown.
pub(crate) fn available() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}
