//! How many threads a search may use: an answer never depends on it.

use std::num::NonZero;

/// As many as the machine runs at once; one where it does not tell.
pub(crate) fn available() -> usize {
    std::thread::available_parallelism().map_or(1, NonZero::get)
}
