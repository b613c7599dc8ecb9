//! Calls of the page's Calibrate tab: `tracks` and `calibrate`, like the commands of those names, for files dropped on the page. A
//! campaign is fitted in separate steps, because each takes long: fit, evidence, assessment, advice on the next measurement, and
//! additional parameters.

mod data;
mod outputs;

use calibrate::{
    Assessment, CampaignFit, Evidence, EvidenceOptions, FitOptions, NuisanceParameter,
    TrackOptions, advise, assess, calibrate_campaign, fit_nuisance, survey_tracks, weigh_evidence,
};
use serde::Deserialize;
use swimmer_files::Campaign;

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

/// Fit with the results of its later steps.
struct Fitted {
    campaign: Campaign,
    found: CampaignFit,
    evidence: Option<Evidence>,
}

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
    let found = calibrate_campaign(&campaign, &data, FitOptions::default())
        .map_err(|why| why.to_string())?;
    let output = FitOutput::new(&found, &campaign, &data);
    let number = lab.kept.keep(Fitted {
        campaign,
        found,
        evidence: None,
    });
    json(&output.numbered(number))
}

/// Likelihood, profiles, ridge and curves of a fit.
fn evidence(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    let weighed =
        weigh_evidence(&fitted.found, EvidenceOptions::default()).map_err(|why| why.to_string())?;
    let runs = fitted.found.runs.iter();
    let names: Vec<String> = runs.map(|run| run.file.display().to_string()).collect();
    let weighed = fitted.evidence.insert(weighed);
    json(&EvidenceOutput::new(weighed, &names))
}

/// Assessment of a fit.
fn assessment(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    let assessed: Assessment =
        assess(&fitted.found, fitted.evidence.as_ref()).map_err(|why| why.to_string())?;
    json(&assessed.document(&fitted.found, |file| file.display().to_string()))
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
    let fit = fit_nuisance(&fitted.found, &wanted).map_err(|why| why.to_string())?;
    json(&NuisanceOutput::new(&fit))
}

/// Advice on the next measurement.
fn advice(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    json(&advise(&fitted.campaign, &fitted.found).map_err(|why| why.to_string())?)
}

/// Releases a fit.
fn close(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    lab.kept.drop(number);
    json(&())
}
