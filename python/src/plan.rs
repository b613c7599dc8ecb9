//! Motion plans to a target.

use operations::optimize::steer;
use operations::plan::{self, Request};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use swimmer_command::NewPlaylist;

use crate::arguments::SwimmerArgument;
use crate::computation::{compute, context};
use crate::errors::{BadInput, of_operation};
use crate::keywords::Keywords;
use crate::robot::WithNotes;

/// Gaits that lead to a target one after the other: document and messages.
#[pyfunction]
#[pyo3(name = "plan")]
pub(crate) fn to_target<'py>(
    py: Python<'py>,
    swimmer: &Bound<'py, PyAny>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithNotes<'py>> {
    let swimmer = SwimmerArgument::of(swimmer)?;
    let keywords = Keywords(keywords);
    let playlist = keywords.path("output")?.map(NewPlaylist::new);
    let playlist = playlist.transpose().map_err(of_operation)?;
    let gaits = keywords.path("gaits")?;
    if gaits.is_some() {
        keywords.refuse(
            "shape",
            "the gaits of a folder have their shape: leave it out, or gaits",
        )?;
    }
    let missing = || BadInput::new_err("to is the target: give (x, y) or (x, y, heading)");
    let mut request = Request {
        // Replaced by the loaded swimmer.
        swimmer: "".into(),
        steer: steer::Options {
            max_rate: keywords.rates("max_rate")?,
            bounds: keywords.bounds()?,
            shape: keywords.shape("shape")?,
        },
        gaits,
        from: keywords.place("from_")?.unwrap_or_default(),
        to: keywords.place("to")?.ok_or_else(missing)?,
        tank: keywords.tank("tank")?,
        margin_m: keywords.length("margin")?.unwrap_or(plan::MARGIN_M),
    };
    let (output, notes) = compute(py, context(), move |context| {
        request.swimmer = swimmer.load(context)?.into();
        let mut output = plan::run(&request, context)?;
        if let Some(playlist) = playlist {
            playlist.write(&mut output)?;
        }
        Ok(output)
    })?;
    Ok((pythonize(py, &output)?, notes))
}
