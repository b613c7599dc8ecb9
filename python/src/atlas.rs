//! All local optima, and gaits that are followed as a parameter changes.

use operations::atlas::{self, Aim, Output, continuation};
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;

use crate::arguments::SwimmerArgument;
use crate::computation::{compute, context};
use crate::errors::BadInput;
use crate::gait::Gait;
use crate::keywords::Keywords;
use crate::optimize::{OPTIMA, WithGaits};
use crate::swimmer::Swimmer;

/// Largest number of starts, and of steps.
const MOST_STARTS: u64 = 100_000;
const MOST_STEPS: u64 = 10_000;

/// Document, gaits of the optima, swimmer and messages.
#[pyfunction]
#[pyo3(name = "atlas")]
pub(crate) fn all_optima<'py>(
    py: Python<'py>,
    swimmer: &Bound<'py, PyAny>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithGaits<'py>> {
    let swimmer = SwimmerArgument::of(swimmer)?;
    let keywords = Keywords(keywords);
    let aims = [
        ("displacement", Aim::Displacement),
        ("efficiency", Aim::Efficiency),
        ("speed", Aim::Speed),
    ];
    let missing = || BadInput::new_err("objective is displacement, efficiency or speed");
    let objective = keywords.word("objective", &aims)?.ok_or_else(missing)?;
    let starts = keywords.count("starts", 1, MOST_STARTS)?;
    let mut request = atlas::Request {
        max_rate: keywords.rates("max_rate")?,
        bounds: keywords.bounds()?,
        seed: keywords.count("seed", 0, u64::MAX)?.unwrap_or(atlas::SEED),
        continuation: followed(&keywords)?,
        ..atlas::Request::new("".into(), objective)
    };
    if let Some(starts) = starts {
        request.starts = count(starts);
    }
    let ((output, file), notes) = compute(py, context(), move |context| {
        let file = swimmer.load(context)?;
        request.swimmer = file.clone().into();
        Ok((atlas::run(&request, context)?, file))
    })?;
    let gait = |optimal: &gait_optimizer::OptimalGait| Gait::of_file(optimal.gait_file(&file.name));
    let gaits: PyResult<Vec<Gait>> = match &output {
        Output::Atlas(found) => found.optima.iter().map(|one| gait(&one.optimal)).collect(),
        Output::Speed(found) => found.optima.iter().map(|one| gait(&one.optimal)).collect(),
        Output::Followed(_) => Ok(Vec::new()),
    };
    Ok((pythonize(py, &output)?, gaits?, Swimmer::of(file)?, notes))
}

/// Parameter along which gaits are followed.
fn followed(keywords: &Keywords<'_>) -> PyResult<Option<continuation::Request>> {
    let gaits = keywords.words("gait", "choose \"small\", \"large\" or both", |word| {
        let named = OPTIMA.iter().find(|(name, _)| *name == word);
        named.map(|(_, optimum)| *optimum)
    })?;
    let steps = keywords.count("steps", 1, MOST_STEPS)?;
    let Some(range) = keywords.parsed::<continuation::Range>("continue_")? else {
        let alone = "this belongs to gaits that are followed: also give continue_";
        if !gaits.is_empty() {
            keywords.refuse("gait", alone)?;
        }
        keywords.refuse("steps", alone)?;
        return Ok(None);
    };
    Ok(Some(continuation::Request {
        parameter: range.parameter,
        from: range.from,
        to: range.to,
        steps: count(steps.unwrap_or(u64::from(continuation::STEPS))),
        gaits,
    }))
}

fn count(number: u64) -> usize {
    usize::try_from(number).unwrap_or(usize::MAX)
}
