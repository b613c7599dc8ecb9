//! Assessment of a fit. The intervals of a fit contain the random scatter, not an error that all cycles of all runs share. This module
//! looks for such errors: goodness of fit (`goodness.rs`), alternative explanations (`explanations.rs`), sensitivity of r_s and χ to
//! the values in the files (`budget.rs`), and an estimate in which every parameter with a prior varies within it
//! (`systematics.rs`). The verdict (`verdict.rs`) sums up, with its reasons.

mod agreement;
mod budget;
mod document;
mod explanations;
mod goodness;
mod known;
mod modes;
mod repeats;
mod systematics;
mod verdict;

pub use budget::BudgetLine;
pub use document::{
    AssessmentDocument, ExcludedPart, GoodnessPart, HeadlinePart, OutlierPart, RepeatsPart,
    RunPart, SystematicsPart,
};
pub use explanations::{Explained, Explanation};
pub use goodness::{CommonDeviation, Goodness, Misfit, RunGoodness, SignTest};
pub use repeats::Repeats;
pub use systematics::{Nuisance, Systematics, Unforeseen};
pub use verdict::{Headline, Verdict};

use std::fmt;

use crate::error::FitError;
use crate::evidence::Evidence;
use crate::fit::CampaignFit;
use crate::fit::likelihood::Estimate;
use crate::fit::parameter::Parameter;
use crate::fit::run_model::RunModel;
use crate::fit::run_values::RunValues;
use crate::fit::tangent::Tangent;
use crate::least_squares::Model as _;

/// Assessment of a fit's errors.
#[derive(Debug, Clone, PartialEq)]
pub struct Assessment {
    /// Recommendation for the use of the fit.
    pub verdict: Verdict,
    /// Reasons; empty if nothing speaks against the fit.
    pub reasons: Vec<String>,
    /// Recommended estimate.
    pub headline: Headline,
    /// Goodness of fit.
    pub goodness: Goodness,
    /// r_s and χ with every parameter that has a prior varying within it; `None` if there are too few runs.
    pub systematics: Option<Systematics>,
    /// Sensitivity of r_s and χ to the assumptions.
    pub budget: Vec<BudgetLine>,
    /// Alternative explanations of the runs, the most likely first.
    pub explanations: Vec<Explanation>,
}

/// The plain model of r_s and χ, and where its likelihood is largest.
struct Plain {
    /// All values, with Y and net turn.
    data: RunValues,
    model: RunModel,
    /// By X, ΔY and Δθ.
    telling: Estimate,
    /// By all values.
    all: Estimate,
}

impl Plain {
    fn of(found: &CampaignFit) -> Result<Self, FitError> {
        let data = found.values()?;
        let model = found.model(&data, vec![Parameter::SphereRadius, Parameter::Chi])?;
        let undetermined = || FitError::Undetermined {
            parameters: "r_s, chi".to_owned(),
        };
        let at = found.optimum();
        let estimate = |data: &RunValues| {
            let even = data.weights(|_| 1.0);
            Some(Tangent::estimate(&model, data, &at, &even)?.0)
        };
        let telling = estimate(&data).ok_or_else(undetermined)?;
        let data = data.with_all();
        let all = estimate(&data).ok_or_else(undetermined)?;
        Ok(Self {
            data,
            model,
            telling,
            all,
        })
    }

    /// The same with more parameters, and what the files say of these.
    fn with(&self, more: &[Parameter], values: &[f64]) -> (RunModel, Vec<f64>) {
        let parameters = [self.model.parameters.as_slice(), more].concat();
        let at = [self.all.at.as_slice(), values].concat();
        (self.model.with(parameters), at)
    }

    /// The tangent of a model with more parameters, at the values that the files say: the derivatives by r_s and χ are known.
    fn tangent_with(&self, model: &RunModel, start: &[f64]) -> Option<Tangent> {
        let mut jacobian = self.all.jacobian.clone();
        let values: Vec<f64> = self
            .all
            .residuals
            .iter()
            .zip(&self.data.values)
            .map(|(residual, measured)| residual + measured)
            .collect();
        for column in self.all.at.len()..start.len() {
            let place = jacobian.ncols();
            jacobian = jacobian.insert_column(place, 0.0);
            jacobian.set_column(place, &model.column(start, column, None)?);
        }
        Some(Tangent::new(start, values, jacobian, model.bounds()))
    }

    /// L \[m\].
    fn length(&self) -> f64 {
        self.model.start.swimmer.total_length()
    }

    /// Value of a parameter by the files.
    fn value_in_files(&self, parameter: Parameter) -> f64 {
        match parameter {
            Parameter::DeadBand => self.model.start.servo.map_or(0.0, |servo| servo.dead_band),
            _ => 0.0,
        }
    }
}

/// Estimate of r_s and χ with every prior. [`assess`] and [`advise`](crate::advise) start from it; it takes longer than the rest of them,
/// so it is computed once for both.
pub struct JointEstimate {
    plain: Plain,
    priors: Vec<known::Known>,
    /// `None` if the runs do not suffice for it.
    joint: Option<systematics::Joint>,
}

impl fmt::Debug for JointEstimate {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("JointEstimate").finish_non_exhaustive()
    }
}

impl JointEstimate {
    /// Computes the estimate of a finished fit.
    ///
    /// # Errors
    /// [`FitError`]: the runs do not determine r_s and χ.
    pub fn of(found: &CampaignFit) -> Result<Self, FitError> {
        let plain = Plain::of(found)?;
        let priors = known::priors(found, &plain.model);
        let joint = systematics::Joint::of(&plain, &priors);
        Ok(Self {
            plain,
            priors,
            joint,
        })
    }

    /// The model of the recommended intervals, with all that may move, and its estimate: that with systematic errors if the runs
    /// suffice for it, else that of r_s and χ alone.
    pub(crate) fn recommended(&self) -> (RunModel, &Estimate) {
        let model = &self.plain.model;
        let (parameters, estimate) = match &self.joint {
            Some(joint) => (&joint.parameters, &joint.estimate),
            None => (&model.parameters, &self.plain.telling),
        };
        (model.with(parameters.clone()), estimate)
    }
}

/// Assesses a finished fit by its joint estimate, with its `evidence` if that was computed.
pub fn assess(
    found: &CampaignFit,
    estimate: &JointEstimate,
    evidence: Option<&Evidence>,
) -> Assessment {
    let JointEstimate {
        plain,
        priors,
        joint,
    } = estimate;
    let joint = joint.as_ref();
    let systematics = joint.and_then(|joint| joint.systematics(plain, found.fit.intervals.level));
    let goodness = goodness::goodness(found, plain, joint);
    let explanations = explanations::explanations(plain);
    let budget = budget::budget(plain, priors);
    let agreement = joint.and_then(|joint| agreement::agreement(found, plain, joint));
    let headline = verdict::headline(found, evidence, systematics.as_ref(), agreement);
    let (verdict, reasons) = verdict::verdict(
        found,
        evidence,
        &goodness,
        systematics.as_ref(),
        &explanations,
        &headline,
        agreement,
    );
    Assessment {
        verdict,
        reasons,
        headline,
        goodness,
        systematics,
        budget,
        explanations,
    }
}
