//! What to measure next? Each gait that the servos can play is added in thought to the runs there are: what it would say about
//! r_s and χ follows from the model's derivatives and the errors that the other runs had, and with it how much narrower the
//! intervals would become (Fisher's information).

use nalgebra::{DMatrix, Matrix2, Vector2};
use serde::{Serialize, Serializer};
use swimmer_files::{AnyGait, Campaign, GaitSpec};
use swimmer_model::{Gait as _, Model, Swimmer};

use crate::error::FitError;
use crate::fit::CampaignFit;
use crate::fit::likelihood::Estimate;
use crate::fit::parameter::Parameter;
use crate::least_squares::Model as _;
use crate::prediction::Played;
use crate::quantities::QUANTITIES;

/// Amplitudes of circles and squares that are weighed \[deg\].
const AMPLITUDES: std::ops::RangeInclusive<u32> = 4..=22;
const STEP_DEG: u32 = 5;
/// Points of a gait at which the links are looked at.
const POINTS: usize = 360;

/// One gait that could be measured next. Serialised with the keys of `swimmer calibrate --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Candidate {
    /// The gait.
    #[serde(serialize_with = "readable")]
    pub gait: GaitSpec,
    /// Width of the interval of r_s with one run of it more, over the width now.
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

/// Gaits by how much one run of each would narrow the intervals. Serialised with the keys of `swimmer calibrate --json`.
#[derive(Debug, Clone, PartialEq, Serialize)]
pub struct Advice {
    /// One cycle \[s\], as most runs had it.
    pub period_s: f64,
    /// The most telling first.
    pub candidates: Vec<Candidate>,
}

/// Ranks circles and squares of 20° to 110°, as far as the servos reach and the links do not meet, and the campaign's own gaits.
///
/// # Errors
/// [`FitError`]: the runs do not determine r_s and χ.
pub fn advise(campaign: &Campaign, found: &CampaignFit) -> Result<Advice, FitError> {
    let undetermined = || FitError::Undetermined {
        parameters: "r_s, chi".to_owned(),
    };
    let values = found.values()?;
    let model = found.model(&values, vec![Parameter::SphereRadius, Parameter::Chi])?;
    let estimate = Estimate::of(&model, &values, &found.optimum()).ok_or_else(undetermined)?;
    let known = Known::of(&estimate).ok_or_else(undetermined)?;
    let period_s = found.usual_period_s();
    let weigh = |gait: GaitSpec, shape: &AnyGait| -> Option<Candidate> {
        if crosses(&found.swimmer.swimmer, shape) {
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

/// Whether side links would meet.
fn crosses(swimmer: &Swimmer<f64>, gait: &AnyGait) -> bool {
    let points = (0..POINTS).map(|i| gait.at(i as f64 / POINTS as f64).phi);
    Model::new(swimmer).is_ok_and(|model| points.into_iter().any(|phi| model.links_cross(&phi)))
}

/// What the runs so far say.
struct Known {
    information: Matrix2<f64>,
    covariance: Matrix2<f64>,
    /// Variances of X, ΔY, Δθ of a run like the others.
    variances: [f64; QUANTITIES],
}

impl Known {
    fn of(estimate: &Estimate) -> Option<Self> {
        let jacobian = &estimate.jacobian;
        let rows = jacobian.nrows();
        let mut information = Matrix2::zeros();
        let mut variances = [0.0; QUANTITIES];
        let mut counts = [0.0; QUANTITIES];
        for row in 0..rows {
            if estimate.weights[row] <= 0.0 {
                continue;
            }
            let variance = estimate.components.variance(row);
            let gradient = jacobian.row(row);
            let gradient = Vector2::new(gradient[0], gradient[1]);
            information += gradient * gradient.transpose() / variance;
            variances[row % QUANTITIES] += variance;
            counts[row % QUANTITIES] += 1.0;
        }
        // What no run has, one more will not have either.
        for (variance, count) in variances.iter_mut().zip(counts) {
            *variance = if count > 0.0 {
                *variance / count
            } else {
                f64::INFINITY
            };
        }
        Some(Self {
            information,
            covariance: information.try_inverse()?,
            variances,
        })
    }

    /// Widths of both intervals with one run more, over the widths now.
    fn with(&self, jacobian: &DMatrix<f64>) -> Option<[f64; 2]> {
        let mut information = self.information;
        for (row, variance) in self.variances.iter().enumerate() {
            let gradient = Vector2::new(jacobian[(row, 0)], jacobian[(row, 1)]);
            information += gradient * gradient.transpose() / *variance;
        }
        let covariance = information.try_inverse()?;
        Some([0, 1].map(|i| (covariance[(i, i)] / self.covariance[(i, i)]).sqrt()))
    }
}
