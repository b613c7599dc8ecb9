//! Recordings: what they hold, their cycles, and the fit of a campaign.

use std::path::{Path, PathBuf};

use calibrate::NuisanceParameter;
use operations::calibrate::campaign::{self, Request};
use operations::calibrate::{LEVEL, MiddleLink, RunsOutput, StatedGait, single};
use operations::tracks;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use pythonize::pythonize;
use swimmer_command::ResultsFolder;
use swimmer_files::AnyGait;

use crate::arguments::{GaitArgument, SwimmerArgument};
use crate::computation::{compute, context};
use crate::errors::{BadInput, of_operation};
use crate::keywords::Keywords;
use crate::robot::WithNotes;
use crate::swimmer::Swimmer;

/// Document, fitted swimmer and messages.
type Fit<'py> = (Bound<'py, PyAny>, Option<Swimmer>, Vec<String>);

/// Survey of a tracking file.
#[pyfunction]
#[pyo3(name = "tracks")]
pub(crate) fn survey<'py>(
    py: Python<'py>,
    file: PathBuf,
    keywords: Bound<'py, PyDict>,
) -> PyResult<WithNotes<'py>> {
    let recording = Keywords(keywords).recording()?;
    let request = tracks::Request { file, recording };
    let (output, notes) = compute(py, context(), move |context| tracks::run(&request, context))?;
    Ok((pythonize(py, &output)?, notes))
}

/// The fit of a campaign, or the cycles of a recording.
#[pyfunction]
#[pyo3(name = "calibrate")]
pub(crate) fn fit<'py>(
    py: Python<'py>,
    file: PathBuf,
    gait: Option<Bound<'py, PyAny>>,
    swimmer: Option<Bound<'py, PyAny>>,
    keywords: Bound<'py, PyDict>,
) -> PyResult<Fit<'py>> {
    let keywords = Keywords(keywords);
    let is_campaign = file
        .extension()
        .is_some_and(|extension| extension.eq_ignore_ascii_case("toml"));
    if is_campaign {
        for (name, given) in [("gait", gait.is_some()), ("swimmer", swimmer.is_some())] {
            if given {
                return Err(BadInput::new_err(format!("{name}: {OF_CAMPAIGN}")));
            }
        }
        of_campaign(py, file, &keywords)
    } else {
        of_run(py, file, gait.as_ref(), swimmer.as_ref(), &keywords)
    }
}

/// Refusal of keywords of a single recording.
const OF_CAMPAIGN: &str = "this goes with a single tracking file; a campaign names all that itself";
/// Keywords of a single recording.
const OF_RUN: [&str; 8] = [
    "period",
    "front",
    "back",
    "body",
    "scale",
    "rate",
    "axes",
    "likelihood",
];

fn of_campaign<'py>(
    py: Python<'py>,
    file: PathBuf,
    keywords: &Keywords<'py>,
) -> PyResult<Fit<'py>> {
    for name in OF_RUN {
        keywords.refuse(name, OF_CAMPAIGN)?;
    }
    let words = NuisanceParameter::ALL
        .map(NuisanceParameter::word)
        .join(", ");
    let form = format!("choose from {words}");
    let request = Request {
        level: keywords.share("level")?.unwrap_or(LEVEL),
        fit_also: keywords.words("fit_also", &form, NuisanceParameter::of_word)?,
        advise: keywords.flag("advise")?,
        ..Request::new(file)
    };
    let folder = keywords.path("output")?;
    let folder = folder.map(|path| ResultsFolder::start(&path));
    let folder = folder.transpose().map_err(of_operation)?;
    let (calibrated, notes) = compute(py, context(), move |context| {
        let calibrated = campaign::run(&request, context, |_| ())?;
        if let Some(folder) = folder {
            folder.write_calibration(&calibrated, &request.file)?;
        }
        Ok(calibrated)
    })?;
    let swimmer = Swimmer::of(calibrated.recommended())?;
    let document = pythonize(py, &calibrated.fitted.output)?;
    Ok((document, Some(swimmer), notes))
}

fn of_run<'py>(
    py: Python<'py>,
    file: PathBuf,
    gait: Option<&Bound<'py, PyAny>>,
    swimmer: Option<&Bound<'py, PyAny>>,
    keywords: &Keywords<'py>,
) -> PyResult<Fit<'py>> {
    let (Some(gait), Some(period_s), Some(swimmer)) = (gait, keywords.seconds("period")?, swimmer)
    else {
        return Err(BadInput::new_err(format!(
            "{} is no campaign (.toml), so name the gait: gait, period and swimmer",
            file.display()
        )));
    };
    let of_fit = "this goes with a campaign: a single run is not fitted";
    for name in ["output", "fit_also"] {
        keywords.refuse(name, of_fit)?;
    }
    if keywords.flag("advise")? {
        keywords.refuse("advise", of_fit)?;
    }
    let (swimmer, gait) = (SwimmerArgument::of(swimmer)?, GaitArgument::of(gait)?);
    let link = MiddleLink {
        front: keywords.parsed("front")?,
        back: keywords.parsed("back")?,
        body: keywords.text("body")?,
    };
    if link.body.is_some() && (link.front.is_some() || link.back.is_some()) {
        return Err(BadInput::new_err(
            "body is the middle link instead of two reflectors: leave out front and back",
        ));
    }
    let options = keywords.recording()?.options();
    let (output, notes) = compute(py, context(), move |context| {
        let swimmer = swimmer.load(context)?;
        let gait = match gait.into_spec()? {
            Ok(spec) => StatedGait::load(&spec)?,
            Err(samples) => {
                let curve = AnyGait::from_file(&samples);
                let curve = curve.map_err(|error| operations::Error::bad_input(&error))?;
                StatedGait::unnamed(curve)
            }
        };
        let path: &Path = &file;
        let run = single(path, &gait, period_s, &swimmer, &options, &link)?;
        Ok(RunsOutput {
            runs: vec![run.output],
            warnings: run.warnings,
        })
    })?;
    Ok((pythonize(py, &output)?, None, notes))
}
