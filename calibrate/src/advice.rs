//! Optimal design of the next run: each gait that the robot plays with clearance is added to the runs there are. Its information on
//! r_s, χ and the systematic errors follows from the model's derivatives and the errors that the other runs had, and with it by
//! how much the recommended intervals would become narrower (Fisher's information).

use gait_player::Limits;
use gait_player::clearance::clearance;
use gait_player::table::check::Checker;
use nalgebra::DMatrix;
use serde::{Serialize, Serializer};
use swimmer_files::{AnyGait, Campaign, GaitSpec, ServoFile};
use swimmer_model::{Gait as _, Links, Swimmer};

use crate::assessment::JointEstimate;
use crate::error::FitError;
use crate::fit::CampaignFit;
use crate::fit::likelihood::Estimate;
use crate::least_squares::Model as _;
use crate::prediction::{KNOTS, Played};
use crate::quantities::QUANTITIES;

/// Amplitudes of circles and squares that are weighed \[deg\].
const AMPLITUDES: std::ops::RangeInclusive<u32> = 4..=22;
const STEP_DEG: u32 = 5;
/// Shapes of a gait at which the distance of its side links is evaluated.
const LOOKS: usize = 4096;

/// One gait that could be measured next. Serialised with the keys of `swimmer calibrate --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Candidate {
    /// The gait.
    #[serde(serialize_with = "readable")]
    #[cfg_attr(feature = "schema", schemars(with = "String"))]
    pub gait: GaitSpec,
    /// Width of the recommended interval of r_s with one run of it more, over the width now.
    #[serde(rename = "sphere_radius_width")]
    pub sphere_radius: f64,
    /// The same of χ.
    #[serde(rename = "chi_width")]
    pub chi: f64,
    /// Geometric mean of both: what the candidates are ranked by.
    pub both: f64,
}

fn readable<S: Serializer>(gait: &GaitSpec, serializer: S) -> Result<S::Ok, S::Error> {
    serializer.serialize_str(&gait.readable())
}

/// Gaits by how much one run of each would narrow the recommended intervals. Serialised with the keys of `swimmer calibrate --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct Advice {
    /// One cycle \[s\], as most runs had it.
    pub period_s: f64,
    /// The most informative first.
    pub candidates: Vec<Candidate>,
}

/// Ranks circles and squares of 20° to 110° and the campaign's own gaits, as far as the robot's own check lets them play: within the
/// servos' angles and rates, and with its margin between the side links.
///
/// # Errors
/// [`FitError`]: the runs do not determine r_s and χ.
pub fn advise(
    campaign: &Campaign,
    found: &CampaignFit,
    estimate: &JointEstimate,
) -> Result<Advice, FitError> {
    let undetermined = || FitError::Undetermined {
        parameters: "r_s, chi".to_owned(),
    };
    let (model, estimate) = estimate.recommended();
    let known = Known::of(estimate).ok_or_else(undetermined)?;
    let period_s = found.usual_period_s();
    let weigh = |gait: GaitSpec, shape: &AnyGait| -> Option<Candidate> {
        if !plays(
            &found.start.swimmer,
            campaign.swimmer.servo,
            shape,
            period_s,
        ) {
            return None;
        }
        let played = Played::commanded(shape, campaign.swimmer.servo.as_ref(), period_s);
        let one = model.with_runs(vec![played.ok()?]);
        let [sphere_radius, chi] = known.with(&one.jacobian(&estimate.at)?)?;
        Some(Candidate {
            gait,
            sphere_radius,
            chi,
            both: (sphere_radius * chi).sqrt(),
        })
    };
    let mut candidates: Vec<Candidate> = Vec::new();
    for degrees in AMPLITUDES.map(|step| step * STEP_DEG) {
        let amplitude = f64::from(degrees).to_radians();
        let clockwise = false;
        let circle = GaitSpec::Circle {
            amplitude,
            clockwise,
        };
        candidates.extend(weigh(circle, &AnyGait::circle(amplitude)));
        let square = GaitSpec::Square {
            amplitude,
            clockwise,
        };
        if let Ok(shape) = square.load() {
            candidates.extend(weigh(square, &shape));
        }
    }
    for run in &found.runs {
        let named = &campaign.runs[run.index];
        let file = matches!(named.gait, GaitSpec::File { .. });
        if file
            && candidates
                .iter()
                .all(|candidate| candidate.gait != named.gait)
        {
            candidates.extend(weigh(named.gait.clone(), &run.played.gait));
        }
    }
    candidates.sort_by(|a, b| a.both.total_cmp(&b.both));
    Ok(Advice {
        period_s,
        candidates,
    })
}

/// Returns `true` if the robot's check of its table accepts a gait. Servos that no file names are the robot's own.
#[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // bounded: a period of hours, lengths of metres
fn plays(swimmer: &Swimmer<f64>, servo: Option<ServoFile>, gait: &AnyGait, period_s: f64) -> bool {
    let Ok(table) = forecast::table(gait, KNOTS) else {
        return false;
    };
    let links = Links {
        middle: swimmer.links.middle as f32,
        front: swimmer.links.front as f32,
        back: swimmer.links.back as f32,
    };
    let limits = servo.map_or(Limits::ROBOT, |servo| Limits {
        max_angle: servo.max_angle as f32,
        max_rate: servo.max_rate as f32,
        ..Limits::ROBOT
    });
    // The plates must not touch at any shape of the gait, corners included.
    let thickness = forecast::thickness(swimmer);
    let mut shapes = (0..LOOKS).map(|i| gait.at(i as f64 / LOOKS as f64).phi);
    if shapes.any(|phi| f64::from(clearance(&links, [phi.x as f32, phi.y as f32])) < thickness) {
        return false;
    }
    let facts = Checker::new().advance(&table, &links, u32::MAX);
    let period_us = (period_s * 1e6).clamp(0.0, 4e9) as u32;
    facts.is_some_and(|facts| {
        let allowed = facts.allow(&limits);
        allowed.is_ok() && facts.allow_period(&limits, period_us).is_ok()
    })
}

/// The information of the runs so far, and of what is known beforehand.
struct Known {
    information: DMatrix<f64>,
    covariance: DMatrix<f64>,
    /// Variances of X, ΔY, Δθ of a run like the others.
    variances: [f64; QUANTITIES],
}

impl Known {
    fn of(estimate: &Estimate) -> Option<Self> {
        let jacobian = &estimate.jacobian;
        let rows = jacobian.nrows();
        let mut information = DMatrix::zeros(jacobian.ncols(), jacobian.ncols());
        let mut variances = [0.0; QUANTITIES];
        let mut counts = [0.0; QUANTITIES];
        for row in 0..rows {
            if estimate.weights[row] <= 0.0 {
                continue;
            }
            let variance = estimate.components.variance(row);
            let gradient = jacobian.row(row);
            information += gradient.transpose() * gradient / variance;
            if estimate.components.is_of_run(row) {
                variances[row % QUANTITIES] += variance;
                counts[row % QUANTITIES] += 1.0;
            }
        }
        // A quantity that no run has is missing in a further run, too.
        for (variance, count) in variances.iter_mut().zip(counts) {
            *variance = if count > 0.0 {
                *variance / count
            } else {
                f64::INFINITY
            };
        }
        Some(Self {
            covariance: information.clone().try_inverse()?,
            information,
            variances,
        })
    }

    /// Widths of both intervals with one run more, over the widths now.
    fn with(&self, jacobian: &DMatrix<f64>) -> Option<[f64; 2]> {
        let mut information = self.information.clone();
        for (row, variance) in self.variances.iter().enumerate() {
            let gradient = jacobian.row(row);
            information += gradient.transpose() * gradient / *variance;
        }
        let covariance = information.try_inverse()?;
        Some([0, 1].map(|i| (covariance[(i, i)] / self.covariance[(i, i)]).sqrt()))
    }
}
