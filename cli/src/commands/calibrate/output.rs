//! Output of `swimmer calibrate`: JSON keys and lines for people.

use std::fmt;
use std::path::Path;

use calibrate::evidence::{Likelihood, Pair};
use calibrate::{Intervals, Origin, RunResult, Stretch};
use serde::Serialize;
use swimmer_files::GaitSpec;

use super::assessment::AssessmentOutput;
use super::beyond_fit::{BeyondFitOutput, ResultTable};
use super::joints::{JointsOutput, RunJoints};
use crate::quantity::{self, Rows, Table};

/// The cycles of one run and their means. The deviation of a single cycle is NaN, in JSON null.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct RunOutput {
    pub(crate) file: String,
    pub(crate) gait: String,
    /// Null for reported results without it.
    pub(crate) cycles: Option<usize>,
    pub(crate) x_m: f64,
    pub(crate) x_sd_m: f64,
    pub(crate) y_m: f64,
    pub(crate) delta_y_m: f64,
    pub(crate) delta_y_sd_m: f64,
    pub(crate) delta_theta_rad: f64,
    pub(crate) delta_theta_sd_rad: f64,
    pub(crate) turn_rad: f64,
    pub(crate) period_s: f64,
    #[serde(flatten)]
    spreads: Spreads,
    /// Rule that distinguished front and back: label, place or travel; null without a track.
    front_rule: Option<&'static str>,
    /// Source of the starts of cycles: heading, flash, log or log-and-heading; `told` without a track.
    phase: &'static str,
    left_out: Vec<LeftOutOutput>,
    /// Its joint angles, if reflectors on the side links measured them.
    #[serde(skip_serializing_if = "Option::is_none")]
    joints: Option<RunJoints>,
    /// Times at which the names of both reflectors were exchanged, and corrected.
    swaps: Vec<Stretch>,
    /// Times of points that are not reflectors.
    ghosts: Vec<Stretch>,
    /// Remarks on its track and its cycles.
    pub(crate) diagnoses: Vec<String>,
    pub(crate) samples: Samples,
    #[serde(skip)]
    pub(crate) front_words: String,
}

/// Standard deviations, standard errors and lag-1 correlations of a run's cycles, except for those in [`RunOutput`].
#[derive(Debug, Clone, Serialize)]
struct Spreads {
    x_se_m: f64,
    x_lag1: f64,
    y_sd_m: f64,
    y_se_m: f64,
    y_lag1: f64,
    delta_y_se_m: f64,
    delta_y_lag1: f64,
    delta_theta_se_rad: f64,
    delta_theta_lag1: f64,
    turn_sd_rad: f64,
    turn_se_rad: f64,
    turn_lag1: f64,
}

/// A whole cycle that does not count.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct LeftOutOutput {
    pub(crate) start_s: f64,
    pub(crate) reason: String,
}

/// Counts of a track's frames by their use.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct Samples {
    pub(crate) frames: usize,
    pub(crate) seen: usize,
    /// Seen, but next to a gap too long to be filled: drawn, not used.
    pub(crate) tails: usize,
    /// Seen next to a filled gap, and replaced by its cubic.
    pub(crate) smoothed: usize,
    /// In short gaps.
    pub(crate) filled: usize,
}

/// The cycles of all runs, and the parameters that explain them.
#[derive(Debug, Clone, Serialize)]
pub(crate) struct FitOutput {
    pub(crate) runs: Vec<RunOutput>,
    pub(crate) sphere_radius_m: f64,
    pub(crate) chi: f64,
    pub(crate) rmse: f64,
    pub(crate) intervals: Intervals,
    /// Between both.
    pub(crate) correlation: f64,
    pub(crate) c_t_form: String,
    /// The estimate by likelihood: each value weighed by its own variance.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(super) likelihood: Option<Likelihood>,
    /// Response of the servos to their commands, if the joint angles were measured: the mean of the runs.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub(crate) joints: Option<JointsOutput>,
    /// Warnings about the runs and the fit.
    pub(crate) warnings: Vec<String>,
    /// Assessment of the result, with reasons.
    #[serde(flatten, skip_serializing_if = "Option::is_none")]
    pub(crate) assessment: Option<AssessmentOutput>,
    #[serde(flatten)]
    pub(crate) beyond: BeyondFitOutput,
}

/// Output for a single run: its cycles only.
#[derive(Debug, Serialize)]
pub(super) struct RunsOutput {
    pub(super) runs: Vec<RunOutput>,
    pub(super) warnings: Vec<String>,
}

impl fmt::Display for RunsOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}", table(&self.runs))?;
        left_out(f, &self.runs)?;
        notes(f, &self.warnings)
    }
}

/// Front rule and phase of each run, and its whole cycles that were left out.
fn left_out(f: &mut fmt::Formatter<'_>, runs: &[RunOutput]) -> fmt::Result {
    for run in runs {
        if run.front_rule.is_none() {
            write!(f, "\n  {}: reported, without a track", run.file)?;
            continue;
        }
        write!(
            f,
            "\n  {}: front {}, phase by {}",
            run.file,
            run.front_words,
            run.phase.replace('-', " ")
        )?;
        for cycle in &run.left_out {
            write!(f, "; left out at {:.2} s: {}", cycle.start_s, cycle.reason)?;
        }
        for diagnosis in &run.diagnoses {
            write!(f, "; {diagnosis}")?;
        }
    }
    Ok(())
}

fn notes(f: &mut fmt::Formatter<'_>, warnings: &[String]) -> fmt::Result {
    warnings
        .iter()
        .try_for_each(|warning| write!(f, "\n  note: {warning}"))
}

impl fmt::Display for FitOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        let [radius, chi] = with_intervals(self.sphere_radius_m, self.chi, &self.intervals);
        rows.row("sphere radius r_s", radius)
            .row("drag ratio χ", chi);
        if let Some(systematics) = self.assessment.iter().find_map(AssessmentOutput::estimate) {
            let [radius, chi] = systematics;
            rows.row("r_s with systematics", radius)
                .row("χ with systematics", chi);
        }
        rows.row(
            "RMSE",
            format!("{} (the paper's weights)", quantity::small(self.rmse)),
        )
        .row("form of c_t", &self.c_t_form);
        if let Some(likelihood) = &self.likelihood {
            let Pair { sphere_radius, chi } = likelihood.estimate;
            let [radius, chi] = with_intervals(sphere_radius, chi, &likelihood.intervals);
            rows.row("r_s by likelihood", radius)
                .row("χ by likelihood", chi);
        }
        write!(f, "{}", table(&self.runs))?;
        left_out(f, &self.runs)?;
        if let Some(assessment) = &self.assessment {
            write!(f, "{}", assessment.heading())?;
        }
        write!(f, "\n\n{rows}")?;
        notes(f, &self.warnings)?;
        let joints = self.joints.as_ref().map(JointsOutput::shown);
        let assessed = self.assessment.iter().flat_map(AssessmentOutput::shown);
        let all: Vec<ResultTable> = joints
            .into_iter()
            .chain(assessed)
            .chain(self.beyond.shown())
            .collect();
        all.iter().try_for_each(|shown| write!(f, "\n\n{shown}"))
    }
}

/// `r_s` and χ with their intervals, for people: as many decimals as these give sense to.
pub(super) fn with_intervals(sphere_radius_m: f64, chi: f64, intervals: &Intervals) -> [String; 2] {
    let percent = intervals.level * 100.0;
    let of = |value: f64, ends: [f64; 2], unit: &str| {
        let decimals = quantity::decimals(ends);
        let [low, high] = ends;
        format!(
            "{value:.decimals$}{unit}   ({percent:.0} %: {low:.decimals$} … {high:.decimals$}{unit})"
        )
    };
    [
        of(
            sphere_radius_m * 1e3,
            intervals.sphere_radius.map(|end| end * 1e3),
            " mm",
        ),
        of(chi, intervals.chi, ""),
    ]
}

fn table(runs: &[RunOutput]) -> Table {
    let mut table = Table::new([
        "run",
        "gait",
        "cycles",
        "X [mm]",
        "Y [mm]",
        "ΔY [mm]",
        "Δθ",
        "period [s]",
    ]);
    for run in runs {
        table.line([
            run.file.clone(),
            run.gait.clone(),
            run.cycles
                .map_or_else(|| "–".to_owned(), |cycles| cycles.to_string()),
            with_deviation([run.x_m, run.x_sd_m], millimetres),
            with_deviation([run.y_m, f64::NAN], millimetres),
            with_deviation([run.delta_y_m, run.delta_y_sd_m], millimetres),
            with_deviation(
                [run.delta_theta_rad, run.delta_theta_sd_rad],
                quantity::angle,
            ),
            format!("{:.3}", run.period_s),
        ]);
    }
    table
}

fn millimetres(metres: f64) -> String {
    format!("{:.3}", metres * 1e3)
}

/// A mean with its deviation, if there are several cycles.
fn with_deviation([mean, deviation]: [f64; 2], written: fn(f64) -> String) -> String {
    if mean.is_nan() {
        "–".to_owned()
    } else if deviation.is_nan() {
        written(mean)
    } else {
        format!("{} ± {}", written(mean), written(deviation))
    }
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
