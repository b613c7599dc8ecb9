//! The answers, under the keys of `swimmer calibrate --json` and of its evidence, and what only pictures need.

use calibrate::evidence::{CurvePoint, Evidence, EvidenceDocument, Pair};
use calibrate::{
    CampaignData, CampaignFit, FurtherFit, Intervals, MeasuredServo, RunResult, c_t_form,
    other_gaits,
};
use serde::Serialize;
use swimmer_files::{Campaign, GaitSpec};

/// The fit.
#[derive(Serialize)]
pub(super) struct FitAnswer {
    /// What the later steps name it by.
    number: u32,
    runs: Vec<Run>,
    sphere_radius_m: f64,
    chi: f64,
    rmse: f64,
    intervals: Intervals,
    correlation: f64,
    c_t_form: String,
    /// The mean of the runs' servos.
    servos: Option<[MeasuredServo; 2]>,
    excluded: Vec<Excluded>,
    warnings: Vec<String>,
    /// The fitted swimmer's file.
    swimmer: String,
}

#[derive(Serialize)]
struct Run {
    file: String,
    gait: String,
    /// Of a circle, with the sign that its displacement is counted by.
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
    /// Start \[s\] and displacement \[m\] of each cycle that counts.
    each: Vec<[f64; 2]>,
    left_out: Vec<Excluded>,
    /// What the servos made of their commands, front and back, where reflectors on the side links showed it.
    servos: Option<[MeasuredServo; 2]>,
    /// x, y \[m\] of the middle link, thinned.
    path: Vec<[f64; 2]>,
    /// Of its track.
    diagnoses: Vec<String>,
    warnings: Vec<String>,
}

#[derive(Serialize)]
struct Excluded {
    what: String,
    reason: String,
}

/// Points of a drawn path.
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

impl FitAnswer {
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

/// What was fitted also: as `further` of the command.
#[derive(Serialize)]
pub(super) struct FurtherAnswer<'a> {
    #[serde(flatten)]
    fit: &'a FurtherFit,
    /// The swimmer's file with all that it can hold of it.
    swimmer: String,
}

impl<'a> FurtherAnswer<'a> {
    pub(super) fn new(fit: &'a FurtherFit) -> Self {
        Self {
            fit,
            swimmer: fit.swimmer.to_toml(),
        }
    }
}

/// What speaks for the fit.
#[derive(Serialize)]
pub(super) struct EvidenceAnswer<'a> {
    /// What the command leaves as `evidence.json`.
    #[serde(flatten)]
    document: EvidenceDocument<'a>,
    /// Of the bootstrap, thinned.
    draws: Vec<Pair>,
    start_curve: Vec<CurveAnswer>,
    fitted_curve: Vec<CurveAnswer>,
}

/// Draws that a picture holds.
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

impl<'a> EvidenceAnswer<'a> {
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
