//! What to measure next? Each gait that the servos can play is added in thought to the runs there are: what it would say about
//! r_s and χ follows from the model's derivatives and the errors that the other runs had, and with it how much narrower the
//! intervals would become (Fisher's information).

use nalgebra::{DMatrix, Matrix2};
use swimmer_files::{AnyGait, Campaign, GaitSpec};
use swimmer_model::{Gait as _, Model, Swimmer};

use crate::campaign::{CalibrateError, CampaignData, CampaignFit};
use crate::cycles::Projection;
use crate::fit::FitError;
use crate::fit::measured::RunValues;
use crate::further::{Likeliest, Setting, Slot, likeliest};
use crate::prediction::JointPath;

/// Amplitudes of circles and squares that are weighed \[deg\].
const AMPLITUDES: std::ops::RangeInclusive<u32> = 4..=22;
const STEP_DEG: u32 = 5;
/// Half a difference's width in r_s/L and ln χ.
const STEP: f64 = 1e-3;
/// Points of a gait at which the links are looked at.
const POINTS: usize = 360;

/// One gait that could be measured next.
#[derive(Debug, Clone, PartialEq)]
pub struct Candidate {
    /// The gait.
    pub gait: GaitSpec,
    /// Width of the interval of r_s with one run of it more, over the width now.
    pub sphere_radius: f64,
    /// The same of χ.
    pub chi: f64,
}

impl Candidate {
    /// Geometric mean of both: what the candidates are ranked by.
    pub fn both(&self) -> f64 {
        (self.sphere_radius * self.chi).sqrt()
    }
}

/// Gaits by how much one run of each would narrow the intervals.
#[derive(Debug, Clone, PartialEq)]
pub struct Advice {
    /// The most telling first.
    pub candidates: Vec<Candidate>,
    /// One cycle \[s\], as most runs had it.
    pub period_s: f64,
}

/// Ranks circles and squares of 20° to 110°, as far as the servos reach and the links do not meet, and the campaign's own gaits.
///
/// # Errors
/// [`CalibrateError`]: the runs do not determine r_s and χ.
pub fn advise(
    campaign: &Campaign,
    data: &CampaignData,
    found: &CampaignFit,
) -> Result<Advice, CalibrateError> {
    let undetermined = || {
        CalibrateError::Fit(FitError::Undetermined {
            parameters: "r_s, chi".to_owned(),
        })
    };
    let slots = vec![Slot::SphereRadius, Slot::Chi];
    let values = RunValues::of(&found.runs);
    let setting = Setting::new(&campaign.swimmer, data, found, slots, values.scales)?;
    let begun = [setting.begin(found)];
    let estimate = likeliest(&setting, &values, &begun).ok_or_else(undetermined)?;
    let known = Known::of(&estimate).ok_or_else(undetermined)?;
    let period_s = data.usual_period_s();
    let projection = Projection::new();
    let weigh = |gait: GaitSpec, shape: &AnyGait| -> Option<Candidate> {
        if crosses(&found.swimmer.swimmer, shape) {
            return None;
        }
        let path = JointPath::new(shape, campaign.swimmer.servo.as_ref(), period_s).ok()?;
        let jacobian = derivatives(&setting, &path, &projection, &estimate.minimum.at)?;
        let [sphere_radius, chi] = known.with(&jacobian)?;
        Some(Candidate {
            gait,
            sphere_radius,
            chi,
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
    for (named, run) in campaign.runs.iter().zip(&data.runs) {
        let file = matches!(named.gait, GaitSpec::File { .. });
        if file
            && candidates
                .iter()
                .all(|candidate| candidate.gait != named.gait)
        {
            candidates.extend(weigh(named.gait.clone(), &run.gait));
        }
    }
    candidates.sort_by(|a, b| a.both().total_cmp(&b.both()));
    Ok(Advice {
        candidates,
        period_s,
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
    variances: [f64; 3],
}

impl Known {
    fn of(estimate: &Likeliest) -> Option<Self> {
        let jacobian = &estimate.minimum.jacobian;
        let rows = jacobian.nrows();
        let mut information = Matrix2::zeros();
        let mut variances = [0.0; 3];
        for row in 0..rows {
            let variance = estimate.components.variance(row);
            let gradient = jacobian.row(row);
            let gradient = nalgebra::Vector2::new(gradient[0], gradient[1]);
            information += gradient * gradient.transpose() / variance;
            variances[row % 3] += variance / (rows / 3) as f64;
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
            let gradient = nalgebra::Vector2::new(jacobian[(row, 0)], jacobian[(row, 1)]);
            information += gradient * gradient.transpose() / *variance;
        }
        let covariance = information.try_inverse()?;
        Some([0, 1].map(|i| (covariance[(i, i)] / self.covariance[(i, i)]).sqrt()))
    }
}

/// Of X, ΔY, Δθ in units of the runs' scales, by r_s/L and ln χ; one-sided next to no sphere.
fn derivatives(
    setting: &Setting<'_>,
    path: &JointPath,
    projection: &Projection,
    at: &[f64],
) -> Option<DMatrix<f64>> {
    let mut jacobian = DMatrix::zeros(3, 2);
    for column in 0..2 {
        let look = |value: f64| {
            let mut z = at.to_vec();
            z[column] = value;
            let cycle = path.predict(&setting.file(&z).swimmer, projection).ok()?.0;
            let values = [cycle.x_m, cycle.delta_y_m, cycle.delta_theta_rad];
            Some([0, 1, 2].map(|q| values[q] / setting.scales[q]))
        };
        let least = if column == 0 { 0.0 } else { f64::MIN };
        let (behind, ahead) = ((at[column] - STEP).max(least), at[column] + STEP);
        let (b, a) = (look(behind)?, look(ahead)?);
        for row in 0..3 {
            jacobian[(row, column)] = (a[row] - b[row]) / (ahead - behind);
        }
    }
    Some(jacobian)
}
