//! Objective of a gait, by its word.

use gait_optimizer::Objective;

/// Objective by its word. Returns `None` for the objective stored in the file.
pub(super) fn parse(word: Option<&str>) -> Result<Option<Objective>, String> {
    word.map(|word| {
        word.parse()
            .map_err(|_| format!("`{word}` is no objective of a gait"))
    })
    .transpose()
}
