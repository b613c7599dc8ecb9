//! Outputs of the calls: those of `swimmer calibrate`, and additional data for the figures.

use calibrate::assessment::ExcludedPart;
use calibrate::evidence::{CurvePoint, Evidence, EvidenceDocument, Pair};
use calibrate::{NuisanceFit, RunResult};
use operations::calibrate::{Fitted, Output};
use serde::Serialize;
use swimmer_files::GaitSpec;

/// Output of the fit.
#[derive(Serialize)]
pub(super) struct FitOutput<'a> {
    /// Number by which the later steps refer to the fit.
    number: u32,
    /// Document of the command.
    #[serde(flatten)]
    fit: &'a Output,
    /// Data for the figures, run by run.
    figures: Vec<RunFigures>,
    /// Runs that were not fitted.
    excluded: Vec<ExcludedPart>,
    /// Swimmer file of the fitted swimmer.
    swimmer: String,
}

/// Data of one run for the figures.
#[derive(Serialize)]
struct RunFigures {
    /// Amplitude of a circle.
    amplitude_rad: Option<f64>,
    clockwise: bool,
    /// Start \[s\] and displacement \[m\] of each valid cycle.
    each: Vec<[f64; 2]>,
    /// x, y \[m\] of the middle link, thinned.
    path: Vec<[f64; 2]>,
}

/// Largest number of points of a plotted path.
const PATH: usize = 600;

impl RunFigures {
    fn new(run: &RunResult, gait: &GaitSpec) -> Self {
        let samples = &run.poses.samples;
        let (amplitude_rad, clockwise) = match gait {
            GaitSpec::Circle {
                amplitude,
                clockwise,
            } => (Some(*amplitude), *clockwise),
            _ => (None, false),
        };
        Self {
            amplitude_rad,
            clockwise,
            each: run
                .cycles
                .cycles
                .iter()
                .filter_map(|cycle| Some([cycle.start_s, cycle.step.as_ref()?.x]))
                .collect(),
            path: samples
                .iter()
                .step_by(samples.len().div_ceil(PATH).max(1))
                .map(|sample| [sample.pose.x, sample.pose.y])
                .collect(),
        }
    }
}

impl<'a> FitOutput<'a> {
    /// Describes the fit that the page knows by a number.
    pub(super) fn new(fitted: &'a Fitted, number: u32) -> Self {
        let Fitted {
            campaign, result, ..
        } = fitted;
        Self {
            number,
            fit: &fitted.output,
            figures: result
                .runs
                .iter()
                .map(|run| RunFigures::new(run, &campaign.runs[run.index].gait))
                .collect(),
            excluded: result
                .excluded
                .iter()
                .map(|run| ExcludedPart {
                    file: run.file.display().to_string(),
                    reason: run.reason.clone(),
                })
                .collect(),
            swimmer: result.swimmer.to_toml(),
        }
    }
}

/// Output of a fit with additional parameters, like `further` of the command.
#[derive(Serialize)]
pub(super) struct NuisanceOutput<'a> {
    #[serde(flatten)]
    fit: &'a NuisanceFit,
    /// Swimmer file with the fitted values for which it has keys.
    swimmer: String,
}

impl<'a> NuisanceOutput<'a> {
    pub(super) fn new(fit: &'a NuisanceFit) -> Self {
        Self {
            fit,
            swimmer: fit.swimmer.to_toml(),
        }
    }
}

/// Evidence for the fit.
#[derive(Serialize)]
pub(super) struct EvidenceOutput<'a> {
    /// Content of the command's `evidence.json`.
    #[serde(flatten)]
    document: EvidenceDocument<'a>,
    /// Samples of the bootstrap, thinned.
    draws: Vec<Pair>,
    start_curve: Vec<CurveAnswer>,
    fitted_curve: Vec<CurveAnswer>,
}

/// Largest number of bootstrap samples in a figure.
const DRAWS: usize = 400;

#[derive(Serialize)]
struct CurveAnswer {
    amplitude_rad: f64,
    x_m: f64,
    delta_y_m: f64,
    delta_theta_rad: f64,
}

impl From<&CurvePoint> for CurveAnswer {
    fn from(point: &CurvePoint) -> Self {
        Self {
            amplitude_rad: point.amplitude_rad,
            x_m: point.cycle.x_m,
            delta_y_m: point.cycle.delta_y_m,
            delta_theta_rad: point.cycle.delta_theta_rad,
        }
    }
}

impl<'a> EvidenceOutput<'a> {
    /// `names` are the runs' files.
    pub(super) fn new(evidence: &'a Evidence, names: &'a [String]) -> Self {
        let bootstrap = evidence.bootstrap.as_ref();
        let draws = bootstrap.map_or(&[][..], |bootstrap| &bootstrap.points);
        let every = draws.len().div_ceil(DRAWS).max(1);
        Self {
            document: evidence.document(names),
            draws: draws.iter().step_by(every).copied().collect(),
            start_curve: evidence.start_curve.iter().map(Into::into).collect(),
            fitted_curve: evidence.fitted_curve.iter().map(Into::into).collect(),
        }
    }
}
