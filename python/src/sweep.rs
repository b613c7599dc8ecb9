//! Sweeps over many designs: plan, run, status, table and maps.

use std::path::PathBuf;

use ::sweep::Shard;
use operations::sweep::{self, MapRequest, field};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use swimmer_command::{MapQuantity, NewMap, check_new_file, shard_of_job_array};

use crate::computation::{compute, context};
use crate::errors::of_operation;
use crate::keywords::Keywords;
use crate::robot::WithNotes;

/// Largest number of threads.
const MOST_THREADS: u64 = 1024;
/// Quantities of a map by name.
const QUANTITIES: [(&str, MapQuantity); 8] = [
    ("displacement", MapQuantity::Displacement),
    ("efficiency", MapQuantity::Efficiency),
    ("speed", MapQuantity::Speed),
    ("amplitude", MapQuantity::Amplitude),
    ("rotation", MapQuantity::Rotation),
    ("lateral", MapQuantity::Lateral),
    ("structure", MapQuantity::Structure),
    ("pareto", MapQuantity::Pareto),
];

/// Makes a plan of a spec.
#[pyfunction]
pub(crate) fn sweep_plan(
    py: Python<'_>,
    spec: PathBuf,
    folder: PathBuf,
) -> PyResult<WithNotes<'_>> {
    let (output, notes) = compute(py, context(), move |_| sweep::plan(&spec, &folder))?;
    Ok((pythonize(py, &output)?, notes))
}

/// Solves the designs of a shard that are not solved yet. Ctrl-C ends it after the blocks in work, and the same call goes on.
#[pyfunction]
pub(crate) fn sweep_run<'py>(
    py: Python<'py>,
    folder: PathBuf,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithNotes<'py>> {
    let keywords = Keywords(keywords);
    let shard = match keywords.parsed("shard")? {
        Some(shard) => shard,
        None => shard_of_job_array()
            .map_err(of_operation)?
            .unwrap_or(Shard::WHOLE),
    };
    let threads = keywords.count("threads", 1, MOST_THREADS)?;
    let mut context = context();
    if let Some(threads) = threads.and_then(|threads| usize::try_from(threads).ok()) {
        context.threads = threads;
    }
    let (output, notes) = compute(py, context, move |context| {
        sweep::run(&folder, shard, context)
    })?;
    Ok((pythonize(py, &output)?, notes))
}

/// Progress of all shards.
#[pyfunction]
pub(crate) fn sweep_status(py: Python<'_>, folder: PathBuf) -> PyResult<WithNotes<'_>> {
    let (output, notes) = compute(py, context(), move |_| sweep::status(&folder))?;
    Ok((pythonize(py, &output)?, notes))
}

/// Writes all designs of a finished sweep as one Parquet table.
#[pyfunction]
pub(crate) fn sweep_merge(
    py: Python<'_>,
    folder: PathBuf,
    table: PathBuf,
) -> PyResult<WithNotes<'_>> {
    check_new_file(&table).map_err(of_operation)?;
    let (output, notes) = compute(py, context(), move |_| sweep::merge(&folder, &table))?;
    Ok((pythonize(py, &output)?, notes))
}

/// Maps a finished grid over two of its axes, and writes its files.
#[pyfunction]
pub(crate) fn sweep_map<'py>(
    py: Python<'py>,
    folder: PathBuf,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithNotes<'py>> {
    let keywords = Keywords(keywords);
    let quantity = keywords.word("quantity", &QUANTITIES)?;
    let files = NewMap::new(
        quantity.unwrap_or(MapQuantity::Displacement),
        keywords.path("output")?,
        keywords.width("output")?,
        keywords.path("export")?,
    );
    let files = files.map_err(of_operation)?;
    let request = MapRequest {
        folder,
        across: keywords.parsed_by("across", field)?,
        up: keywords.parsed_by("up", field)?,
        at: keywords.axis_values("at")?,
    };
    let (output, notes) = compute(py, context(), move |_| {
        let mut output = sweep::map(&request)?;
        files.write(&mut output)?;
        Ok(output)
    })?;
    Ok((pythonize(py, &output)?, notes))
}
