//! The assessment as a document: what `swimmer calibrate --json` tells of its own answer, and the lab page shows.

use std::path::Path;

use serde::Serialize;

use super::{
    Assessment, BudgetLine, CommonDeviation, Explanation, Misfit, Nuisance, Repeats, RunGoodness,
    SignTest, Unforeseen,
};
use crate::evidence::Pair;
use crate::{CampaignFit, Intervals};

/// Whether the answer can be used, and why.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct AssessmentDocument {
    /// `trust`, `caution` or `do not use`.
    pub verdict: &'static str,
    /// Why; empty where there is nothing against it.
    pub reasons: Vec<String>,
    /// χ² by the cycles' own scatter over the degrees of freedom; null where cycles tell of none.
    pub reduced_chi2: Option<f64>,
    /// Left out where the runs are too few for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub intervals_with_systematics: Option<Intervals>,
    /// The answer that is recommended.
    pub headline: HeadlinePart,
    /// How well the model explains the runs.
    pub goodness: GoodnessPart,
    /// Left out where the runs are too few for it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub systematics: Option<SystematicsPart>,
    /// How r_s and χ move with what is taken for granted.
    pub budget: Vec<BudgetLine>,
    /// What explains the runs beside r_s and χ, the likeliest first.
    pub explanations: Vec<Explanation>,
    /// Runs that were not fitted.
    pub excluded: Vec<ExcludedPart>,
}

/// The answer that is recommended.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct HeadlinePart {
    /// `paper` or `systematics`.
    pub by: &'static str,
    /// r_s \[m\] and χ.
    #[serde(flatten)]
    pub estimate: Pair,
}

/// How well the model explains the runs.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct GoodnessPart {
    /// Values less parameters.
    pub freedom: usize,
    /// Null where the runs are too few for it, or tell of no scatter.
    pub reduced_chi2_with_systematics: Option<f64>,
    /// Of what the likeliest r_s and χ leave.
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
pub struct RepeatsPart {
    /// Their files.
    pub files: Vec<String>,
    /// Their scatter.
    #[serde(flatten)]
    pub repeats: Repeats,
}

/// What one run says by itself.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct RunPart {
    /// Its file.
    pub file: String,
    /// What it says.
    #[serde(flatten)]
    pub goodness: RunGoodness,
}

/// The estimate with systematic errors.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct SystematicsPart {
    /// r_s \[m\] and χ.
    #[serde(flatten)]
    pub estimate: Pair,
    /// What is known by halves, and what the runs make of it.
    pub parameters: Vec<Nuisance>,
    /// What explains the runs better still.
    pub unforeseen: Vec<Unforeseen>,
    /// Values that were left out.
    pub outliers: Vec<OutlierPart>,
}

/// A value that was left out.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct OutlierPart {
    /// The run's file.
    pub file: String,
    /// X, ΔY or Δθ.
    pub quantity: &'static str,
}

/// A run that was not fitted.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct ExcludedPart {
    /// Its file.
    pub file: String,
    /// Why: as the campaign says, or because of its sign.
    pub reason: String,
}

impl Assessment {
    /// The document; `name` tells a run's file as people know it.
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
