//! Assessment as a document: the part of `swimmer calibrate --json` about the quality of the fit, which the lab page shows as well.

use std::path::Path;

use serde::Serialize;

use super::{
    Assessment, BudgetLine, CommonDeviation, Explanation, Misfit, Nuisance, Repeats, RunGoodness,
    SignTest, Unforeseen,
};
use crate::evidence::Pair;
use crate::{CampaignFit, Intervals};

/// Assessment of a fit: the verdict and its reasons.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct AssessmentDocument {
    /// `trust`, `caution` or `do not use`.
    pub verdict: &'static str,
    /// Reasons; empty if nothing speaks against the fit.
    pub reasons: Vec<String>,
    /// χ² by the cycles' own scatter over the degrees of freedom; null if cycles show no scatter.
    pub reduced_chi2: Option<f64>,
    /// Left out where the runs are too few for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intervals_with_systematics: Option<Intervals>,
    /// The answer that is recommended.
    pub headline: HeadlinePart,
    /// Goodness of fit.
    pub goodness: GoodnessPart,
    /// Left out where the runs are too few for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub systematics: Option<SystematicsPart>,
    /// Sensitivity of r_s and χ to the assumptions.
    pub budget: Vec<BudgetLine>,
    /// Alternative explanations of the runs, the most likely first.
    pub explanations: Vec<Explanation>,
    /// Runs that were not fitted.
    pub excluded: Vec<ExcludedPart>,
}

/// The answer that is recommended.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct HeadlinePart {
    /// `paper` or `systematics`.
    pub by: &'static str,
    /// r_s \[m\] and χ.
    #[serde(flatten)]
    pub estimate: Pair,
}

/// Goodness of fit.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct GoodnessPart {
    /// Values less parameters.
    pub freedom: usize,
    /// Null if there are too few runs, or if they show no scatter.
    pub reduced_chi2_with_systematics: Option<f64>,
    /// Signs of the residuals at the likeliest r_s and χ.
    pub signs: Vec<SignTest>,
    /// Run by run.
    pub runs: Vec<RunPart>,
    /// Y and net turn that all runs have beyond the model.
    pub common: Vec<CommonDeviation>,
    /// Deviations that nothing explains; null if scatter does.
    pub misfit: Option<Misfit>,
    /// Runs that repeat a gait; left out if none does.
    #[serde(skip_serializing_if = "Vec::is_empty")]
    pub repeats: Vec<RepeatsPart>,
}

/// Runs that repeat a gait.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RepeatsPart {
    /// Their files.
    pub files: Vec<String>,
    /// Their scatter.
    #[serde(flatten)]
    pub repeats: Repeats,
}

/// Fit of one run by itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunPart {
    /// Its file.
    pub file: String,
    /// Goodness of the run's fit.
    #[serde(flatten)]
    pub goodness: RunGoodness,
}

/// The estimate with systematic errors.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct SystematicsPart {
    /// r_s \[m\] and χ.
    #[serde(flatten)]
    pub estimate: Pair,
    /// Parameters with a prior, and their estimates.
    pub parameters: Vec<Nuisance>,
    /// A better explanation of the runs.
    pub unforeseen: Vec<Unforeseen>,
    /// Values that were left out.
    pub outliers: Vec<OutlierPart>,
}

/// A value that was left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct OutlierPart {
    /// The run's file.
    pub file: String,
    /// X, ΔY or Δθ.
    pub quantity: &'static str,
}

/// A run that was not fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct ExcludedPart {
    /// Its file.
    pub file: String,
    /// Why: as the campaign says, or because of its sign.
    pub reason: String,
}

impl Assessment {
    /// The document; `name` returns the name of a run's file for people.
    pub fn document(
        &self,
        found: &CampaignFit,
        name: impl Fn(&Path) -> String,
    ) -> AssessmentDocument {
        let file = |run: usize| {
            let run = found.runs.get(run);
            run.map_or_else(String::new, |run| name(&run.file))
        };
        let systematics = self.systematics.as_ref();
        let runs = self.goodness.runs.iter().enumerate();
        AssessmentDocument {
            verdict: self.verdict.word(),
            reasons: self.reasons.clone(),
            reduced_chi2: self.goodness.reduced_chi2,
            intervals_with_systematics: systematics.map(|found| found.intervals),
            headline: HeadlinePart {
                by: self.headline.by,
                estimate: self.headline.estimate,
            },
            goodness: GoodnessPart {
                freedom: self.goodness.freedom,
                reduced_chi2_with_systematics: systematics.and_then(|found| found.reduced_chi2),
                signs: self.goodness.signs.clone(),
                runs: runs
                    .map(|(run, goodness)| RunPart {
                        file: file(run),
                        goodness: *goodness,
                    })
                    .collect(),
                common: self.goodness.common.clone(),
                misfit: self.goodness.misfit,
                repeats: self
                    .goodness
                    .repeats
                    .iter()
                    .map(|repeats| RepeatsPart {
                        files: repeats.runs.iter().map(|run| file(*run)).collect(),
                        repeats: repeats.clone(),
                    })
                    .collect(),
            },
            systematics: systematics.map(|found| SystematicsPart {
                estimate: found.estimate,
                parameters: found.nuisances.clone(),
                unforeseen: found.unforeseen.clone(),
                outliers: found
                    .outliers
                    .iter()
                    .map(|(run, quantity)| OutlierPart {
                        file: file(*run),
                        quantity,
                    })
                    .collect(),
            }),
            budget: self.budget.clone(),
            explanations: self.explanations.clone(),
            excluded: found
                .excluded
                .iter()
                .map(|run| ExcludedPart {
                    file: name(&run.file),
                    reason: run.reason.clone(),
                })
                .collect(),
        }
    }
}
