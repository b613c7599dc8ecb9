//! Whole calibration of a campaign: the fit and every later step, in their order.

use std::path::{Path, PathBuf};

use calibrate::{Assessment, EvidenceOptions, NuisanceParameter};
use swimmer_files::SwimmerFile;

use super::{Fitted, LEVEL};
use crate::{Context, Error};

/// Calibration of a campaign.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// Path of the campaign.
    pub file: PathBuf,
    /// Level of the intervals.
    pub level: f64,
    /// Nuisance parameters to fit in addition to r_s and χ.
    pub fit_also: Vec<NuisanceParameter>,
    /// Rank possible further runs.
    pub advise: bool,
}

impl Request {
    /// Calibration with the usual level, and without the optional steps.
    pub fn new(file: PathBuf) -> Self {
        Self {
            file,
            level: LEVEL,
            fit_also: Vec::new(),
            advise: false,
        }
    }
}

/// Step of a calibration.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Step {
    /// Reading the tracks, and the fit.
    Fit,
    /// Fit of nuisance parameters.
    FitFurther,
    /// Ranking of further runs.
    Advise,
    /// Likelihood, profiles and bootstrap.
    WeighEvidence,
    /// Systematics and verdict.
    Assess,
}

/// A calibrated campaign.
#[derive(Debug)]
pub struct Calibrated {
    /// The fit, with all steps in its output.
    pub fitted: Fitted,
    /// Systematics and verdict.
    pub assessment: Assessment,
    /// Options of the evidence.
    pub options: EvidenceOptions,
    /// Failure of the evidence, which is a warning of the output.
    pub without_evidence: Option<Error>,
}

impl Calibrated {
    /// The swimmer with the recommended drag.
    pub fn recommended(&self) -> SwimmerFile {
        let Fitted { result, output, .. } = &self.fitted;
        output.assessment.as_ref().map_or_else(
            || result.swimmer.clone(),
            |assessment| {
                let estimate = &assessment.headline.estimate;
                result.start.fitted(estimate.sphere_radius, estimate.chi)
            },
        )
    }
}

/// Calibrates a campaign. `begin` is called before each step. Warns if its swimmer file is outdated.
///
/// # Errors
/// A file cannot be read, the runs do not determine the parameters, or a step fails.
pub fn run(
    request: &Request,
    context: &mut Context,
    mut begin: impl FnMut(Step),
) -> Result<Calibrated, Error> {
    let cancel = context.cancel.clone();
    let mut begin = |step| {
        cancel.check();
        begin(step);
    };
    begin(Step::Fit);
    let mut fitted = Fitted::load(&request.file, request.level, context)?;
    if !request.fit_also.is_empty() {
        begin(Step::FitFurther);
        fitted.fit_also(&request.fit_also)?;
    }
    if request.advise {
        begin(Step::Advise);
        fitted.advise()?;
    }
    begin(Step::WeighEvidence);
    let options = EvidenceOptions::default();
    let without_evidence = fitted.weigh_evidence(options).err();
    begin(Step::Assess);
    let folder = request.file.parent().unwrap_or_else(|| Path::new(""));
    let assessment = fitted.assess(|file| {
        let path = file.strip_prefix(folder).unwrap_or(file);
        path.display().to_string()
    })?;
    cancel.check();
    Ok(Calibrated {
        fitted,
        assessment,
        options,
        without_evidence,
    })
}
