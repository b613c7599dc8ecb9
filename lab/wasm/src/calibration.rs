//! Calls of the page's Calibrate tab: `tracks` and `calibrate`, like the commands of those names, for files dropped on the page. A
//! campaign is fitted in separate steps, because each takes long: fit, evidence, assessment, advice on the next measurement, and
//! additional parameters.

mod data;
mod outputs;

use std::path::Path;

use calibrate::{EvidenceOptions, NuisanceParameter, TrackOptions, survey_tracks};
use operations::calibrate::{Fitted, LEVEL};
use serde::Deserialize;

use crate::calls::{Call, Lab, Outcome, json, parsed};
use data::Dropped;
use outputs::{EvidenceOutput, FitOutput, NuisanceOutput};

/// Calls by name.
pub(crate) const CALLS: &[(&str, Call)] = &[
    ("tracks", tracks),
    ("calibrate", fit),
    ("calibrate evidence", evidence),
    ("calibrate assessment", assessment),
    ("calibrate further", further),
    ("calibrate advice", advice),
    ("calibrate close", close),
];

#[derive(Deserialize)]
struct Numbered {
    number: u32,
}

/// Summary of one tracking file, with the keys of `swimmer tracks --json`. Takes [`Dropped`] files.
fn tracks(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let dropped = Dropped::read(bytes)?;
    let (name, file) = dropped.only()?;
    let survey = survey_tracks(file, name.as_ref(), &TrackOptions::default())
        .map_err(|why| why.to_string())?;
    json(&survey)
}

/// Fits the campaign among dropped files and stores the fit under the returned number.
fn fit(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let dropped = Dropped::read(bytes)?;
    let campaign = dropped.campaign()?;
    let data = dropped.data(&campaign)?;
    let fitted = Fitted::new(campaign, &data, LEVEL, Path::new(""))?;
    let number = lab.kept.keep(fitted);
    json(&FitOutput::new(lab.kept.get(number)?, number))
}

/// Likelihood, profiles, ridge and curves of a fit.
fn evidence(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    let runs = fitted.output.runs.iter();
    let names: Vec<String> = runs.map(|run| run.file.clone()).collect();
    let evidence = fitted.weigh_evidence(EvidenceOptions::default())?;
    json(&EvidenceOutput::new(evidence, &names))
}

/// Assessment of a fit.
fn assessment(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    fitted.assess(|file| file.display().to_string())?;
    json(&fitted.output.assessment)
}

/// Number of a fit, and the words of `--fit-also`.
#[derive(Deserialize)]
struct FitAlsoRequest {
    number: u32,
    also: Vec<String>,
}

/// Fits parameters in addition to `r_s` and χ.
fn further(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let FitAlsoRequest { number, also } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    let of_word = |word: &String| {
        NuisanceParameter::of_word(word)
            .ok_or_else(|| format!("fitting `{word}` also: there is no such word"))
    };
    let wanted = also.iter().map(of_word).collect::<Result<Vec<_>, _>>()?;
    json(&NuisanceOutput::new(fitted.fit_also(&wanted)?))
}

/// Advice on the next measurement.
fn advice(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    json(fitted.advise()?)
}

/// Releases a fit.
fn close(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    lab.kept.drop(number);
    json(&())
}
