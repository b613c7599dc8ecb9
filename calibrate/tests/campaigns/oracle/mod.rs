//! Oracle for the best possible intervals: the model's derivatives by differences of the laboratory's own campaigns, the error of
//! each value by repeating them, and the priors. No estimator can have narrower intervals.

use calibrate::calibrate_run;
use nalgebra::{DMatrix, DVector};
use statrs::distribution::{ContinuousCDF, Normal};

use crate::lab::Lab;

/// Campaigns by which errors are known.
const REPEATED: u64 = 24;

/// X, ΔY, Δθ, Y and net turn of every run.
fn values(lab: &Lab) -> DVector<f64> {
    let (campaign, data) = lab.campaign();
    let of_runs = data.runs.iter().flat_map(|run| {
        // The truth says where cycles begin: the symmetric gait's do not depend on it.
        let cycles = calibrate_run(run, &campaign.reflectors, &campaign.swimmer)
            .unwrap()
            .cycles;
        [
            cycles.x,
            cycles.delta_y,
            cycles.delta_theta,
            cycles.y,
            cycles.rotation,
        ]
        .map(|s| s.mean)
    });
    DVector::from_vec(of_runs.collect())
}

/// Error that may be present: the step of its difference, its standard deviation (`None`: unknown), and its effect.
type Column = (f64, Option<f64>, fn(&mut Lab, f64));

const COLUMNS: [Column; 8] = [
    (0.01, None, |lab, by| lab.body.sphere *= 1.0 + by),
    (0.01, None, |lab, by| lab.body.chi *= 1.0 + by),
    (0.005, Some(0.005), |lab, by| {
        lab.joints.iter_mut().for_each(|joint| joint.gain += by);
    }),
    (
        0.005,
        Some(0.3 * std::f64::consts::PI / 180.0),
        |lab, by| lab.joints[0].offset += by,
    ),
    (
        0.005,
        Some(0.3 * std::f64::consts::PI / 180.0),
        |lab, by| lab.joints[1].offset += by,
    ),
    (0.001, Some(5e-4), |lab, by| {
        lab.places.front[0] += by;
        lab.places.back[0] += by;
    }),
    (0.001, Some(5e-4), |lab, by| {
        lab.places.front[1] += by;
        lab.places.back[1] += by;
    }),
    (0.002, Some(0.002), |lab, by| lab.cameras.scale += by),
];

/// Half widths of r_s and χ, as shares of the truth.
pub(crate) fn half_widths(lab: &Lab, level: f64) -> [f64; 2] {
    let quiet = |change: &dyn Fn(&mut Lab)| {
        let mut lab = lab.clone().with_noise(0.0);
        change(&mut lab);
        values(&lab)
    };
    let columns = COLUMNS.map(|(by, _, change)| {
        let ahead = quiet(&|lab| change(lab, by));
        (ahead - quiet(&|lab| change(lab, -by))) / (2.0 * by)
    });
    let jacobian = DMatrix::from_columns(&columns);
    let (mut sum, mut squares) = (
        DVector::zeros(jacobian.nrows()),
        DVector::zeros(jacobian.nrows()),
    );
    for seed in 0..REPEATED {
        let repeated = values(&Lab {
            seed: 5000 + seed,
            ..lab.clone()
        });
        sum += &repeated;
        squares += repeated.component_mul(&repeated);
    }
    let count = REPEATED as f64;
    let variances =
        (squares / count - (sum / count).map(|mean| mean * mean)) * (count / (count - 1.0));
    let mut information = DMatrix::zeros(COLUMNS.len(), COLUMNS.len());
    for (row, variance) in variances.iter().enumerate() {
        let gradient = jacobian.row(row);
        information += gradient.transpose() * gradient / *variance;
    }
    for (place, (_, width, _)) in COLUMNS.iter().enumerate() {
        information[(place, place)] += width.map_or(0.0, |width| width.powi(-2));
    }
    let covariance = information.try_inverse().unwrap();
    let normal = Normal::standard().inverse_cdf(0.5 + level / 2.0);
    [0, 1].map(|i| normal * covariance[(i, i)].sqrt())
}
