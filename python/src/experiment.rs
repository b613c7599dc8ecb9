//! Experiments: the outputs of `swimmer experiment` as values. `python/swimmer/experiment.py` makes the public functions of them.

use std::path::PathBuf;

use pyo3::prelude::*;
use pythonize::pythonize;
use serde::Serialize;
use swimmer_command::{Experiment, Reply};

use crate::computation::in_thread;
use crate::robot::{RobotSettings, WithNotes, value};
use crate::signals::Signals;

fn of_thread<T: Serialize + Send + 'static>(
    py: Python<'_>,
    work: impl FnOnce() -> Reply<T> + Send + 'static,
) -> PyResult<WithNotes<'_>> {
    let (output, notes) = value(in_thread(py, None, work)?)?;
    Ok((pythonize(py, &output)?, notes))
}

/// Computes the gaits of a spec, and fixes the order of the trials.
#[pyfunction]
pub(crate) fn experiment_plan(
    py: Python<'_>,
    spec: PathBuf,
    folder: Option<PathBuf>,
) -> PyResult<WithNotes<'_>> {
    let experiment = Experiment { spec, folder };
    of_thread(py, move || experiment.plan())
}

/// Plays the trials that are left. Ctrl-C stops the robot, and the same call goes on.
#[pyfunction]
pub(crate) fn experiment_run<'py>(
    py: Python<'py>,
    spec: PathBuf,
    folder: Option<PathBuf>,
    robot: PyRef<'_, RobotSettings>,
) -> PyResult<WithNotes<'py>> {
    let experiment = Experiment { spec, folder };
    let options = robot.options.clone();
    drop(robot);
    let signals = Signals::default();
    let polled = signals.clone();
    // In this thread: only the interpreter's main thread handles signals.
    let reply = py.detach(|| experiment.run(&options, Box::new(move || polled.poll())));
    signals.raised()?;
    let (output, notes) = value(reply)?;
    Ok((pythonize(py, &output)?, notes))
}

/// Progress by the journal.
#[pyfunction]
pub(crate) fn experiment_status(
    py: Python<'_>,
    spec: PathBuf,
    folder: Option<PathBuf>,
) -> PyResult<WithNotes<'_>> {
    let experiment = Experiment { spec, folder };
    of_thread(py, move || experiment.status())
}

/// Compares the gaits, and writes report.json and report.html.
#[pyfunction]
pub(crate) fn experiment_report(
    py: Python<'_>,
    spec: PathBuf,
    folder: Option<PathBuf>,
) -> PyResult<WithNotes<'_>> {
    let experiment = Experiment { spec, folder };
    of_thread(py, move || experiment.report())
}
