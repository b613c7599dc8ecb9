//! `swimmer._swimmer`, what the Python package `swimmer` stands on: the model over arrays, gaits, and the commands' answers.
//!
//! No physics and no schema of its own lives here. Numbers come from `swimmer-model`, files from `swimmer-files`, and an answer is
//! the JSON document of the command line, from `swimmer_command`.

// The docs are Python's help, which shows no Markdown, and Python hands its arguments over by value.
#![allow(clippy::doc_markdown, clippy::needless_pass_by_value)]

mod arguments;
mod arrays;
mod atlas;
mod calibrate;
mod commands;
mod computation;
mod errors;
mod experiment;
mod gait;
mod keywords;
mod operations;
mod optimize;
mod robot;
mod signals;
mod swimmer;

/// The extension module; `python/swimmer/_swimmer.pyi` says what is in it.
#[pyo3::pymodule]
mod _swimmer {
    #[pymodule_export]
    use super::atlas::all_optima;
    #[pymodule_export]
    use super::calibrate::{fit, survey};
    #[pymodule_export]
    use super::commands::{run, run_captured};
    #[pymodule_export]
    use super::errors::{BadInput, Error, Failed};
    #[pymodule_export]
    use super::experiment::{
        experiment_plan, experiment_report, experiment_run, experiment_status,
    };
    #[pymodule_export]
    use super::gait::Gait;
    #[pymodule_export]
    use super::operations::{certify, height_map, simulate};
    #[pymodule_export]
    use super::optimize::{best_gait, passive_waveform, steer_gaits};
    #[pymodule_export]
    use super::robot::{RobotLink, RobotSettings};
    #[pymodule_export]
    use super::swimmer::Swimmer;
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // Python's name
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
