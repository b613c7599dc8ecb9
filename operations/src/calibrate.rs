//! Calibration: fits r_s and χ to the tracked runs of a campaign, and describes the cycles of single runs.

// Formulas in the docs read like the paper's: r_s.
#![allow(clippy::doc_markdown)]

pub mod campaign;
mod doubts;
mod output;

use std::path::Path;

use calibrate::{
    Advice, Assessment, CalibrateError, CampaignData, CampaignFit, Evidence, EvidenceOptions,
    FitError, FitOptions, JointEstimate, NuisanceFit, NuisanceParameter, RunResult, TrackError,
    TrackOptions, UsedPoints, advise, assess, calibrate_campaign, calibrate_run, fit_nuisance,
    load_run_of, usual_reflectors, weigh_evidence,
};
use swimmer_files::{
    AnyGait, Campaign, GaitSpec, PointName, Reflector, Reflectors, RigidBody, SwimmerFile,
};

pub use self::output::{
    JointsOutput, LeftOutOutput, Output, RunJoints, RunOutput, RunsOutput, Samples, Spreads,
};
use crate::{Context, Error};

/// Level of the intervals, unless the user sets one.
pub const LEVEL: f64 = 0.95;

/// A fitted campaign. The later steps, each of which takes seconds, add their results to its output.
#[derive(Debug)]
pub struct Fitted {
    /// The campaign.
    pub campaign: Campaign,
    /// The fit.
    pub result: CampaignFit,
    /// Likelihood, profiles and bootstrap, after [`Fitted::weigh_evidence`].
    pub evidence: Option<Evidence>,
    /// Joint estimate, computed by the first of the steps that start from it.
    estimate: Option<JointEstimate>,
    /// The output so far.
    pub output: Output,
}

impl Fitted {
    /// Fits a campaign. The output names files relative to `folder`, as the campaign does.
    ///
    /// # Errors
    /// The runs do not determine the parameters.
    pub fn new(
        campaign: Campaign,
        data: &CampaignData,
        level: f64,
        folder: &Path,
    ) -> Result<Self, Error> {
        let result = calibrate_campaign(&campaign, data, FitOptions { level })?;
        let output = Output::new(&campaign, data, &result, folder);
        Ok(Self {
            campaign,
            result,
            evidence: None,
            estimate: None,
            output,
        })
    }

    /// Reads a campaign with all that it names, and fits it. Warns if its swimmer file is outdated.
    ///
    /// # Errors
    /// A file cannot be read, or as [`Fitted::new`].
    pub fn load(path: &Path, level: f64, context: &mut Context) -> Result<Self, Error> {
        let campaign = Campaign::load(path)?;
        if let Some(swimmer) = &campaign.swimmer_path {
            crate::warn_if_outdated(swimmer, context)?;
        }
        let data = CampaignData::load(&campaign)?;
        let folder = path.parent().unwrap_or_else(|| Path::new(""));
        Self::new(campaign, &data, level, folder)
    }

    /// Computes likelihood, profiles and bootstrap. A failure also becomes a warning of the output.
    ///
    /// # Errors
    /// The likelihood has no maximum.
    pub fn weigh_evidence(&mut self, options: EvidenceOptions) -> Result<&Evidence, Error> {
        match weigh_evidence(&self.result, options) {
            Ok(evidence) => {
                self.output.likelihood = Some(evidence.likelihood.clone());
                Ok(self.evidence.insert(evidence))
            }
            Err(cause) => {
                let warning = format!("no estimate by likelihood: {cause}");
                self.output.warnings.push(warning);
                Err(cause.into())
            }
        }
    }

    /// Assesses the fit, with the evidence if there is any. `name` gives each file its name in the output.
    ///
    /// # Errors
    /// The fit with systematics fails.
    pub fn assess(&mut self, name: impl Fn(&Path) -> String) -> Result<Assessment, Error> {
        let estimate = joint_estimate(&mut self.estimate, &self.result)?;
        let assessed = assess(&self.result, estimate, self.evidence.as_ref());
        self.output.assessment = Some(assessed.document(&self.result, name));
        Ok(assessed)
    }

    /// Fits nuisance parameters in addition to r_s and χ.
    ///
    /// # Errors
    /// The runs do not determine them.
    pub fn fit_also(&mut self, parameters: &[NuisanceParameter]) -> Result<&NuisanceFit, Error> {
        let fit = fit_nuisance(&self.result, parameters)?;
        Ok(self.output.further.insert(fit))
    }

    /// Ranks possible further runs by how much each would narrow the intervals.
    ///
    /// # Errors
    /// A candidate cannot be predicted.
    pub fn advise(&mut self) -> Result<&Advice, Error> {
        let estimate = joint_estimate(&mut self.estimate, &self.result)?;
        let advice = advise(&self.campaign, &self.result, estimate)?;
        Ok(self.output.advice.insert(advice))
    }
}

/// Returns the joint estimate of a fit, and computes it if that was not done yet.
fn joint_estimate<'a>(
    place: &'a mut Option<JointEstimate>,
    result: &CampaignFit,
) -> Result<&'a JointEstimate, FitError> {
    let estimate = match place.take() {
        Some(estimate) => estimate,
        None => JointEstimate::of(result)?,
    };
    Ok(place.insert(estimate))
}

/// Names of the middle link's points or body in the file of a single run.
#[derive(Debug, Default)]
pub struct MiddleLink {
    /// The front reflector.
    pub front: Option<PointName>,
    /// The back reflector.
    pub back: Option<PointName>,
    /// The rigid body, in place of reflectors.
    pub body: Option<String>,
}

impl MiddleLink {
    /// Reflectors at the ends of a link of this length \[m\], or its rigid body; `None` if nothing is named.
    fn reflectors(&self, length: f64) -> Option<Reflectors> {
        if self.front.is_none() && self.back.is_none() && self.body.is_none() {
            return None;
        }
        // A user who names one end does not mean the other one by its usual name.
        let end = |name: &Option<PointName>, along: f64| Reflector {
            point: name.clone().unwrap_or(PointName::Auto),
            at: [along, 0.0],
        };
        Some(Reflectors {
            front: end(&self.front, length / 2.0),
            back: end(&self.back, -length / 2.0),
            body: self.body.clone().map(RigidBody::named),
            sides: None,
        })
    }
}

/// One run's cycles.
#[derive(Debug)]
pub struct Run {
    /// Poses and cycles.
    pub result: RunResult,
    /// Their description.
    pub output: RunOutput,
    /// Warnings about the track, and doubts about the gait, each with the name of the file.
    pub warnings: Vec<String>,
}

/// Gait that a single run is said to have.
#[derive(Debug, Clone)]
pub struct StatedGait {
    spec: GaitSpec,
    curve: AnyGait,
}

impl StatedGait {
    /// Loads a gait.
    ///
    /// # Errors
    /// The gait file cannot be read.
    pub fn load(spec: &GaitSpec) -> Result<Self, Error> {
        Ok(Self {
            curve: spec.load()?,
            spec: spec.clone(),
        })
    }

    /// A gait that has no file.
    pub fn unnamed(curve: AnyGait) -> Self {
        let spec = GaitSpec::File {
            path: "the gait".into(),
            reversed: false,
        };
        Self { spec, curve }
    }
}

/// Reads the track of a single run and evaluates its cycles.
///
/// # Errors
/// The track cannot be read, or has no cycles; or the swimmer is no robot.
pub fn single(
    track: &Path,
    gait: &StatedGait,
    period_s: f64,
    swimmer: &SwimmerFile,
    options: &TrackOptions,
    link: &MiddleLink,
) -> Result<Run, Error> {
    let mut options = options.clone();
    for end in [&link.front, &link.back].into_iter().flatten() {
        if let PointName::Columns(x, y) = end {
            options.pairs.push([x.clone(), y.clone()]);
        }
    }
    crate::check_robots_drag(swimmer)?;
    let length = swimmer.swimmer.links.middle;
    options.used = Some(link.reflectors(length).map_or_else(
        || UsedPoints::usual(length),
        |reflectors| UsedPoints::of(&reflectors),
    ));
    let name = gait.spec.to_string();
    let data = load_run_of(track, gait.curve.clone(), name, period_s, &options)?;
    let reflectors = link
        .reflectors(length)
        .unwrap_or_else(|| usual_reflectors(&data.track, &swimmer.swimmer));
    let result = calibrate_run(&data, &reflectors, swimmer)?;
    let mut warnings = output::run_warnings(&result, Path::new(""));
    let doubts = doubts::of_single(&result, gait, period_s, swimmer);
    let file = track.display();
    warnings.extend(doubts.into_iter().map(|doubt| format!("{file}: {doubt}")));
    Ok(Run {
        output: RunOutput::new(&result, &gait.spec, Path::new("")),
        result,
        warnings,
    })
}

impl From<FitError> for Error {
    fn from(error: FitError) -> Self {
        CalibrateError::from(error).into()
    }
}

impl From<CalibrateError> for Error {
    /// Runs that cannot be read or used are bad input; a fit that does not converge is a failure.
    fn from(error: CalibrateError) -> Self {
        if error.is_bad_input() {
            Self::bad_input(&error)
        } else {
            Self::failed(&error)
        }
    }
}

impl From<TrackError> for Error {
    /// A tracking file that cannot be read is bad input.
    fn from(error: TrackError) -> Self {
        Self::bad_input(&error)
    }
}
