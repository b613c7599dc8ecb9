//! `swimmer experiment report`: measured against predicted, optima against their neighbours.

use std::fmt;

use experiment::adaptive::CampaignAdvice;
use experiment::unattended::{Comparison, Measure, compare};
use serde::Serialize;
use swimmer_files::write_atomically;

use super::adaptive::{Campaign, in_words};
use super::folder::{Folder, PAGE, REPORT};
use super::{ExperimentPaths, campaign};
use crate::failure::Outcome;
use crate::output::{Output, document};
use crate::report::experiment::page;

/// Compare the measured gaits with the prediction, and each optimum with its neighbours
///
/// Writes report.json, report.html (one page, with figures) and campaign.toml (for `swimmer calibrate`) into the folder of the
/// experiment; also while trials are missing.
/// Intervals are Student's over the repeats. An optimum is compared with each neighbour within blocks, one-sided, and the p-values
/// are corrected for the number of comparisons (Holm).
#[derive(Debug, clap::Args)]
pub(crate) struct ReportPlan {
    #[command(flatten)]
    paths: ExperimentPaths,
}

/// Comparison of an experiment.
#[derive(Debug, Serialize)]
pub(crate) struct ReportOutput {
    #[serde(flatten)]
    comparison: Comparison,
    report: String,
    /// Fit of an adaptive campaign.
    #[serde(skip_serializing_if = "Option::is_none")]
    adaptive: Option<CampaignAdvice>,
    /// Campaign of the finished trials for `swimmer calibrate`; `null` without one.
    campaign: Option<String>,
}

impl ReportPlan {
    pub(super) fn run(self, output: Output) -> Outcome {
        output.print(&report(&self.paths)?);
        Ok(())
    }
}

/// Compares the gaits of an experiment, and writes report.json and report.html.
///
/// # Errors
/// A folder or a journal that cannot be read, and a disk that refuses.
pub(crate) fn report(paths: &ExperimentPaths) -> Outcome<ReportOutput> {
    let folder = Folder::of(paths)?;
    let journal = folder.journal()?;
    let comparison = compare(&folder.plan, &journal);
    let advice = Campaign::of(&folder)?
        .map(|campaign| campaign.advice(&folder, &journal))
        .transpose()?;
    let fit = advice.as_ref().map(in_words);
    let html = page(&folder.plan, &folder.swimmer.name, &comparison, fit)?;
    let path = folder.path.join(PAGE);
    write_atomically(&path, html.as_bytes())?;
    write_atomically(&folder.path.join(REPORT), document(&comparison).as_bytes())?;
    let campaign = campaign::write(&folder, &journal)?;
    Ok(ReportOutput {
        comparison,
        adaptive: advice,
        report: path.display().to_string(),
        campaign: campaign.map(|path| path.display().to_string()),
    })
}

impl fmt::Display for ReportOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let of = &self.comparison;
        writeln!(f, "{} of {} trials are finished.", of.done, of.runs)?;
        writeln!(
            f,
            "  {:14} {:>12} {:>20}",
            "gait", "predicted", "measured [mm]"
        )?;
        for gait in &of.gaits {
            let measured = match (gait.measured_m, gait.interval_m) {
                (Some(mean), Some(half)) => format!("{:.3} ± {:.3}", mean * 1e3, half * 1e3),
                (Some(mean), None) => format!("{:.3}", mean * 1e3),
                (None, _) => "–".to_owned(),
            };
            writeln!(
                f,
                "  {:14} {:>12.3} {measured:>20}",
                gait.gait,
                gait.predicted_m * 1e3
            )?;
        }
        for one in &of.comparisons {
            let (difference, unit) = match one.measure {
                Measure::Displacement => (one.difference_m, "mm per cycle"),
                Measure::Speed => (one.difference_m_per_s, "mm/s"),
            };
            let difference = difference.map_or_else(
                || "not measured".to_owned(),
                |difference| format!("{:+.3} {unit}", difference * 1e3),
            );
            let p = one.p.map_or_else(|| "–".to_owned(), |p| format!("{p:.2e}"));
            let verdict = if one.shown {
                "beats"
            } else {
                "is not shown to beat"
            };
            writeln!(
                f,
                "  {} {verdict} {}: {difference}, p = {p}",
                one.better, one.than
            )?;
        }
        if let Some(advice) = &self.adaptive {
            writeln!(f, "{}", in_words(advice))?;
        }
        write!(f, "The report is {}.", self.report)?;
        if let Some(campaign) = &self.campaign {
            write!(
                f,
                "\n`swimmer calibrate {campaign}` fits the drag model to these trials."
            )?;
        }
        Ok(())
    }
}
