//! TOML with places: what serde finds wrong is reported with file, line and column.

use std::path::Path;

use serde::de::DeserializeOwned;

use crate::FileError;

/// Reads a TOML text into a type; unknown keys, wrong types and syntax errors come with their place.
pub(crate) fn parse<T: DeserializeOwned>(text: &str, path: &Path) -> Result<T, FileError> {
    toml::from_str(text).map_err(|error| {
        let offset = error.span().map_or(0, |span| span.start);
        FileError::at_offset(path, text, offset, error.message())
    })
}
