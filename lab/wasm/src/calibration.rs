//! What the page's Calibrate calls: `tracks` and `calibrate`, as the commands of those names, from files that were dropped on the
//! page. A campaign comes in steps, because each takes long: the fit, its evidence, its assessment, what to measure next, and what is
//! asked to be fitted also.

mod answers;
mod data;

use calibrate::{
    Assessment, CampaignFit, Evidence, EvidenceOptions, FitOptions, Further, TrackOptions, advise,
    assess, calibrate_campaign, fit_further, survey_tracks, weigh_evidence,
};
use serde::Deserialize;
use swimmer_files::Campaign;

use crate::calls::{Call, Lab, Outcome, json, parsed};
use answers::{EvidenceAnswer, FitAnswer, FurtherAnswer};
use data::Dropped;

/// The calls, by name.
pub(crate) const CALLS: &[(&str, Call)] = &[
    ("tracks", tracks),
    ("calibrate", fit),
    ("calibrate evidence", evidence),
    ("calibrate assessment", assessment),
    ("calibrate further", further),
    ("calibrate advice", advice),
    ("calibrate close", close),
];

/// A fit, and what was found out about it.
struct Fitted {
    campaign: Campaign,
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
    let answer = FitAnswer::new(&found, &campaign, &data);
    let number = lab.kept.keep(Fitted {
        campaign,
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

/// A fit, and the words of `--fit-also`.
#[derive(Deserialize)]
struct Asked {
    number: u32,
    also: Vec<String>,
}

/// Fits more than `r_s` and χ.
fn further(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Asked { number, also } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    let of_word = |word: &String| {
        Further::of_word(word)
            .ok_or_else(|| format!("fitting `{word}` also: there is no such word"))
    };
    let wanted = also.iter().map(of_word).collect::<Result<Vec<_>, _>>()?;
    let fit = fit_further(&fitted.found, &wanted).map_err(|why| why.to_string())?;
    json(&FurtherAnswer::new(&fit))
}

/// What to measure next.
fn advice(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    let fitted: &mut Fitted = lab.kept.get(number)?;
    json(&advise(&fitted.campaign, &fitted.found).map_err(|why| why.to_string())?)
}

/// Lets go of a fit.
fn close(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let Numbered { number } = parsed(bytes)?;
    lab.kept.drop(number);
    json(&())
}
