//! What the page's Calibrate calls: `tracks` and `calibrate`, as the commands of those names, from files that were dropped on the
//! page. A campaign comes in three steps, because each takes longer than the one before: the fit, its evidence, its assessment.

mod answers;
mod data;

use calibrate::{
    Assessment, CampaignFit, Evidence, EvidenceOptions, FitOptions, TrackOptions, assess,
    calibrate_campaign, survey_tracks, weigh_evidence,
};
use serde::Deserialize;

use crate::calls::{Call, Lab, Outcome, json, parsed};
use answers::{EvidenceAnswer, FitAnswer};
use data::Dropped;

/// The calls, by name.
pub(crate) const CALLS: &[(&str, Call)] = &[
    ("tracks", tracks),
    ("calibrate", fit),
    ("calibrate evidence", evidence),
    ("calibrate assessment", assessment),
    ("calibrate close", close),
];

/// A fit, and what was found out about it.
struct Fitted {
    found: CampaignFit,
    evidence: Option<Evidence>,
}

#[derive(Deserialize)]
struct Numbered {
    number: u32,
}

/// What one tracking file holds, under the keys of `swimmer tracks --json`. Takes [`Dropped`] files.
fn tracks(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let dropped = Dropped::read(bytes)?;
    let (name, file) = dropped.only()?;
    let survey = survey_tracks(file, name.as_ref(), &TrackOptions::default())
        .map_err(|why| why.to_string())?;
    json(&survey)
}

/// Fits the campaign among dropped files, and keeps the fit under the number in the answer.
fn fit(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let dropped = Dropped::read(bytes)?;
    let campaign = dropped.campaign()?;
    let data = dropped.data(&campaign)?;
    let found = calibrate_campaign(&campaign, &data, FitOptions::default())
        .map_err(|why| why.to_string())?;
    let answer = FitAnswer::new(&found, &campaign);
    let number = lab.kept.keep(Fitted {
        found,
        evidence: None,
    });
    json(&answer.numbered(number))
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
    json(&EvidenceAnswer::new(weighed, &names))
}

/// What to make of a fit.
fn assessment(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    let assessed: Assessment =
        assess(&fitted.found, fitted.evidence.as_ref()).map_err(|why| why.to_string())?;
    json(&assessed.document(&fitted.found, |file| file.display().to_string()))
}

/// Lets go of a fit.
fn close(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    lab.kept.drop(number);
    json(&())
}
