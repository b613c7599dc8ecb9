//! The whole `swimmer` command.

use std::ffi::OsString;

use pyo3::prelude::*;

/// The whole `swimmer` command, the program's name first; gives its exit status.
#[pyfunction]
pub(crate) fn run(py: Python<'_>, words: Vec<OsString>) -> u8 {
    py.detach(|| swimmer_command::run(words))
}
