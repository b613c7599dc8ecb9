//! Outputs of the calls, with the keys of `swimmer calibrate --json` and of its evidence, and additional data for the figures.

use calibrate::evidence::{CurvePoint, Evidence, EvidenceDocument, Pair};
use calibrate::{
    CampaignData, CampaignFit, Intervals, MeasuredServo, NuisanceFit, RunResult, c_t_form,
    other_gaits,
};
use serde::Serialize;
use swimmer_files::{Campaign, GaitSpec};

/// Output of the fit.
#[derive(Serialize)]
pub(super) struct FitOutput {
    /// Number by which the later steps refer to the fit.
    number: u32,
    runs: Vec<Run>,
    sphere_radius_m: f64,
    chi: f64,
    rmse: f64,
    intervals: Intervals,
    correlation: f64,
    c_t_form: String,
    /// Mean over the runs of the measured servos.
    servos: Option<[MeasuredServo; 2]>,
    excluded: Vec<Excluded>,
    warnings: Vec<String>,
    /// Swimmer file of the fitted swimmer.
    swimmer: String,
}

#[derive(Serialize)]
struct Run {
    file: String,
    gait: String,
    /// Amplitude of a circle, with the sign of its sense.
    amplitude_rad: Option<f64>,
    clockwise: bool,
    cycles: Option<usize>,
    x_m: f64,
    x_sd_m: f64,
    y_m: f64,
    delta_y_m: f64,
    delta_y_sd_m: f64,
    delta_theta_rad: f64,
    delta_theta_sd_rad: f64,
    period_s: f64,
    /// Start \[s\] and displacement \[m\] of each valid cycle.
    each: Vec<[f64; 2]>,
    left_out: Vec<Excluded>,
    /// Actual angles of the servos relative to the commanded ones, front and back, if reflectors on the side links show them.
    servos: Option<[MeasuredServo; 2]>,
    /// x, y \[m\] of the middle link, thinned.
    path: Vec<[f64; 2]>,
    /// Notes on the track.
    diagnoses: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Excluded {
    what: String,
    reason: String,
}

/// Largest number of points of a plotted path.
const PATH: usize = 600;

impl Run {
    fn new(run: &RunResult, gait: &GaitSpec) -> Self {
        let cycles = &run.cycles;
        let samples = &run.poses.samples;
        let (amplitude_rad, clockwise) = match gait {
            GaitSpec::Circle {
                amplitude,
                clockwise,
            } => (Some(*amplitude), *clockwise),
            _ => (None, false),
        };
        Self {
            file: run.file.display().to_string(),
            gait: run.gait.clone(),
            amplitude_rad,
            clockwise,
            cycles: cycles.count(),
            x_m: cycles.x.mean,
            x_sd_m: cycles.x.sd,
            y_m: cycles.y.mean,
            delta_y_m: cycles.delta_y.mean,
            delta_y_sd_m: cycles.delta_y.sd,
            delta_theta_rad: cycles.delta_theta.mean,
            delta_theta_sd_rad: cycles.delta_theta.sd,
            period_s: cycles.period_s,
            each: cycles
                .cycles
                .iter()
                .filter_map(|cycle| Some([cycle.start_s, cycle.step.as_ref()?.x]))
                .collect(),
            left_out: cycles
                .left_out
                .iter()
                .map(|(start, reason)| Excluded {
                    what: format!("{start:.1} s"),
                    reason: reason.to_string(),
                })
                .collect(),
            servos: run.joints.as_ref().and_then(|joints| joints.servos),
            path: samples
                .iter()
                .step_by(samples.len().div_ceil(PATH).max(1))
                .map(|sample| [sample.pose.x, sample.pose.y])
                .collect(),
            diagnoses: run.diagnoses(),
            warnings: run.warnings.clone(),
        }
    }
}

impl FitOutput {
    pub(super) fn new(found: &CampaignFit, campaign: &Campaign, data: &CampaignData) -> Self {
        let fit = &found.fit;
        Self {
            number: 0,
            runs: found
                .runs
                .iter()
                .map(|run| Run::new(run, &campaign.runs[run.index].gait))
                .collect(),
            sphere_radius_m: fit.sphere_radius,
            chi: fit.chi,
            rmse: fit.rmse,
            intervals: fit.intervals,
            correlation: fit.correlation,
            c_t_form: c_t_form(&fit.c_t_form),
            servos: found.servos(),
            excluded: found
                .excluded
                .iter()
                .map(|run| Excluded {
                    what: run.file.display().to_string(),
                    reason: run.reason.clone(),
                })
                .collect(),
            warnings: (data.doubts.iter().cloned())
                .chain(
                    other_gaits(campaign, &found.runs, &found.swimmer)
                        .iter()
                        .map(|other| {
                            let track = &campaign.runs[other.index].track;
                            format!("{}: {other}", track.display())
                        }),
                )
                .chain(fit.warnings.iter().map(ToString::to_string))
                .collect(),
            swimmer: found.swimmer.to_toml(),
        }
    }

    pub(super) fn numbered(self, number: u32) -> Self {
        Self { number, ..self }
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
