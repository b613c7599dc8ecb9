//! JSON documents of `swimmer calibrate`.

use std::path::Path;

use calibrate::assessment::AssessmentDocument;
use calibrate::evidence::Likelihood;
use calibrate::{
    Advice, CampaignData, CampaignFit, Intervals, MeasuredServo, NuisanceFit, Origin, RunResult,
    Stretch, c_t_form,
};
use serde::Serialize;
use swimmer_files::{Campaign, GaitSpec};

use super::doubts;

/// The cycles of one run and their means. The deviation of a single cycle is NaN, in JSON null.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunOutput {
    /// File of the track, relative to the campaign.
    pub file: String,
    /// Gait.
    pub gait: String,
    /// Number of valid cycles; null for reported results without it.
    pub cycles: Option<usize>,
    /// Mean displacement along the heading per cycle \[m\].
    pub x_m: f64,
    /// Standard deviation of the displacement \[m\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub x_sd_m: f64,
    /// Mean displacement across the heading per cycle \[m\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub y_m: f64,
    /// Mean lateral sway within a cycle \[m\].
    pub delta_y_m: f64,
    /// Standard deviation of the sway \[m\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub delta_y_sd_m: f64,
    /// Mean oscillation of the heading within a cycle \[rad\].
    pub delta_theta_rad: f64,
    /// Standard deviation of the oscillation \[rad\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub delta_theta_sd_rad: f64,
    /// Mean net rotation per cycle \[rad\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub turn_rad: f64,
    /// Mean period \[s\].
    pub period_s: f64,
    /// Further statistics of the cycles.
    #[serde(flatten)]
    pub spreads: Spreads,
    /// Rule that distinguished front and back: label, place or travel; null without a track.
    pub front_rule: Option<&'static str>,
    /// Source of the starts of cycles: heading, flash, log or log-and-heading; `told` without a track.
    pub phase: &'static str,
    /// Whole cycles that do not count.
    pub left_out: Vec<LeftOutOutput>,
    /// Its joint angles, if reflectors on the side links measured them.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joints: Option<RunJoints>,
    /// Times at which the names of both reflectors were exchanged, and corrected.
    pub swaps: Vec<Stretch>,
    /// Times of points that are not reflectors.
    pub ghosts: Vec<Stretch>,
    /// Remarks on its track and its cycles.
    pub diagnoses: Vec<String>,
    /// Frames by their use.
    pub samples: Samples,
    /// Rule that distinguished front and back, for text output.
    #[serde(skip)]
    pub front_words: String,
}

/// Standard deviations, standard errors and lag-1 correlations of a run's cycles, except for those in [`RunOutput`].
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Spreads {
    /// Standard error of the displacement \[m\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub x_se_m: f64,
    /// Correlation of successive displacements.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub x_lag1: f64,
    /// Standard deviation of the displacement across the heading \[m\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub y_sd_m: f64,
    /// Its standard error \[m\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub y_se_m: f64,
    /// Its correlation from cycle to cycle.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub y_lag1: f64,
    /// Standard error of the sway \[m\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub delta_y_se_m: f64,
    /// Correlation of successive sways.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub delta_y_lag1: f64,
    /// Standard error of the oscillation of the heading \[rad\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub delta_theta_se_rad: f64,
    /// Its correlation from cycle to cycle.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub delta_theta_lag1: f64,
    /// Standard deviation of the net rotation \[rad\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub turn_sd_rad: f64,
    /// Its standard error \[rad\].
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub turn_se_rad: f64,
    /// Its correlation from cycle to cycle.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub turn_lag1: f64,
}

/// A whole cycle that does not count.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct LeftOutOutput {
    /// Start \[s\].
    pub start_s: f64,
    /// Reason.
    pub reason: String,
}

/// Counts of a track's frames by their use.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Samples {
    /// All frames.
    pub frames: usize,
    /// Frames in which the points were seen.
    pub seen: usize,
    /// Seen, but next to a gap too long to be filled: plotted, not used.
    pub tails: usize,
    /// Seen next to a filled gap, and replaced by its cubic.
    pub smoothed: usize,
    /// In short gaps.
    pub filled: usize,
}

/// The cycles of all runs, and the parameters that explain them. The JSON document of `swimmer calibrate` for a campaign.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "CalibrateOutput")
)]
pub struct Output {
    /// Fitted runs.
    pub runs: Vec<RunOutput>,
    /// Radius of the sphere \[m\].
    pub sphere_radius_m: f64,
    /// Drag ratio.
    pub chi: f64,
    /// Root mean square error with the paper's weights.
    pub rmse: f64,
    /// Intervals of both parameters.
    pub intervals: Intervals,
    /// Correlation of both parameters.
    pub correlation: f64,
    /// Form of the tangential drag coefficient.
    pub c_t_form: String,
    /// Estimate by likelihood: each value weighted by its own variance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub likelihood: Option<Likelihood>,
    /// Response of the servos to their commands, if the joint angles were measured: the mean of the runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub joints: Option<JointsOutput>,
    /// Warnings about the runs and the fit.
    pub warnings: Vec<String>,
    /// Assessment of the fit, with reasons.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub assessment: Option<AssessmentDocument>,
    /// Fit with nuisance parameters.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub further: Option<NuisanceFit>,
    /// Possible further runs, the most useful first.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub advice: Option<Advice>,
}

/// The cycles of a single run. The JSON document of `swimmer calibrate` for a tracking file.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunsOutput {
    /// The run.
    pub runs: Vec<RunOutput>,
    /// Warnings about its track, and doubts about its gait.
    pub warnings: Vec<String>,
}

/// Servos of one run, or the mean of all runs.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct JointsOutput {
    /// Front servo.
    pub front: MeasuredServo,
    /// Back servo.
    pub back: MeasuredServo,
}

/// Joint angles of one run.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct RunJoints {
    /// Share of the samples of valid cycles in which each angle was seen.
    pub seen: [f64; 2],
    /// Scatter of samples about the mean course, of each angle \[rad\].
    pub scatter_rad: [f64; 2],
    /// Response of the servos to the command; null if the gait does not determine it.
    pub servos: Option<JointsOutput>,
}

impl From<[MeasuredServo; 2]> for JointsOutput {
    fn from([front, back]: [MeasuredServo; 2]) -> Self {
        Self { front, back }
    }
}

impl RunJoints {
    fn of(run: &RunResult) -> Option<Self> {
        let joints = run.joints.as_ref()?;
        Some(Self {
            seen: joints.seen,
            scatter_rad: joints.scatter,
            servos: joints.servos.map(Into::into),
        })
    }
}

impl Output {
    /// Describes a fit, without the later steps.
    pub(super) fn new(
        campaign: &Campaign,
        data: &CampaignData,
        found: &CampaignFit,
        folder: &Path,
    ) -> Self {
        let runs = found
            .runs
            .iter()
            .map(|run| RunOutput::new(run, &campaign.runs[run.index].gait, folder))
            .collect();
        let fit = &found.fit;
        let of_runs = found.runs.iter().flat_map(|run| run_warnings(run, folder));
        let of_gaits = doubts::of_campaign(campaign, data, &found.runs, &found.swimmer);
        Self {
            runs,
            sphere_radius_m: fit.sphere_radius,
            chi: fit.chi,
            rmse: fit.rmse,
            intervals: fit.intervals,
            correlation: fit.correlation,
            c_t_form: c_t_form(&fit.c_t_form),
            likelihood: None,
            joints: found.servos().map(Into::into),
            warnings: of_runs
                .chain(of_gaits)
                .chain(fit.warnings.iter().map(ToString::to_string))
                .collect(),
            assessment: None,
            further: None,
            advice: None,
        }
    }
}

/// Warnings of reader, poses and cycles of a run, each with the name of its file.
pub(super) fn run_warnings(run: &RunResult, folder: &Path) -> Vec<String> {
    let file = run.file.strip_prefix(folder).unwrap_or(&run.file).display();
    run.warnings
        .iter()
        .map(|warning| format!("{file}: {warning}"))
        .collect()
}

impl RunOutput {
    /// Paths are relative to the campaign's folder, as in the campaign.
    pub(super) fn new(run: &RunResult, gait: &GaitSpec, folder: &Path) -> Self {
        let cycles = &run.cycles;
        let relative = |path: &Path| path.strip_prefix(folder).unwrap_or(path).to_owned();
        let gait = match gait {
            GaitSpec::File { path, reversed } => GaitSpec::File {
                path: relative(path),
                reversed: *reversed,
            },
            closed_form => closed_form.clone(),
        };
        Self {
            file: relative(&run.file).display().to_string(),
            gait: gait.readable(),
            cycles: cycles.count(),
            x_m: cycles.x.mean,
            x_sd_m: cycles.x.sd,
            y_m: cycles.y.mean,
            delta_y_m: cycles.delta_y.mean,
            delta_y_sd_m: cycles.delta_y.sd,
            delta_theta_rad: cycles.delta_theta.mean,
            delta_theta_sd_rad: cycles.delta_theta.sd,
            turn_rad: cycles.rotation.mean,
            period_s: cycles.period_s,
            spreads: Spreads {
                x_se_m: cycles.x.se,
                x_lag1: cycles.x.lag1,
                y_sd_m: cycles.y.sd,
                y_se_m: cycles.y.se,
                y_lag1: cycles.y.lag1,
                delta_y_se_m: cycles.delta_y.se,
                delta_y_lag1: cycles.delta_y.lag1,
                delta_theta_se_rad: cycles.delta_theta.se,
                delta_theta_lag1: cycles.delta_theta.lag1,
                turn_sd_rad: cycles.rotation.sd,
                turn_se_rad: cycles.rotation.se,
                turn_lag1: cycles.rotation.lag1,
            },
            front_rule: (!run.is_reported()).then(|| run.poses.front.word()),
            phase: cycles.phase.word(),
            left_out: cycles
                .left_out
                .iter()
                .map(|(start_s, why)| LeftOutOutput {
                    start_s: *start_s,
                    reason: why.to_string(),
                })
                .collect(),
            joints: RunJoints::of(run),
            swaps: run.poses.report.swaps.clone(),
            ghosts: run.poses.report.ghosts.clone(),
            diagnoses: run.diagnoses(),
            samples: Samples {
                frames: run.poses.frames,
                seen: run.poses.seen().count(),
                tails: run.poses.with(Origin::Tail).count(),
                smoothed: run.poses.with(Origin::Smoothed).count(),
                filled: run.poses.samples.iter().filter(|s| s.is_filled()).count(),
            },
            front_words: if run.is_reported() {
                String::new()
            } else {
                run.poses.front.to_string()
            },
        }
    }
}
