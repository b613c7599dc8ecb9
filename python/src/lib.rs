//! `swimmer._swimmer`, base of the Python package `swimmer`: the model over arrays, gaits, and the outputs of the operations.
//!
//! No physics and no schema of its own lives here. Numbers come from `swimmer-model`, files from `swimmer-files`, and outputs from
//! `operations` as the JSON documents of the command line. `swimmer_command` writes the commands' files and drives the robot.

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
mod plan;
mod robot;
mod signals;
mod sweep;
mod swimmer;

/// The extension module; `python/swimmer/_swimmer.pyi` says what is in it.
#[pyo3::pymodule]
mod _swimmer {
    #[pymodule_export]
    use super::atlas::all_optima;
    #[pymodule_export]
    use super::calibrate::{fit, survey};
    #[pymodule_export]
    use super::commands::run;
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
    use super::plan::to_target;
    #[pymodule_export]
    use super::robot::{RobotLink, RobotSettings};
    #[pymodule_export]
    use super::sweep::{sweep_map, sweep_merge, sweep_plan, sweep_run, sweep_status};
    #[pymodule_export]
    use super::swimmer::Swimmer;
    #[pymodule_export]
    #[allow(non_upper_case_globals)] // Python's name
    const __version__: &str = env!("CARGO_PKG_VERSION");
}
