//! The one-page report of a round through the whole loop: what was measured, fitted, predicted and tracked.

pub(crate) mod calibration;
pub(crate) mod chart;
pub(crate) mod colour_bar;
pub(crate) mod drawing;
pub(crate) mod experiment;
mod figures;
pub(crate) mod markup;
mod page;
pub(crate) mod palette;
mod placing;
pub(crate) mod style;
pub(crate) mod swimming;

pub(crate) use page::{page, written};

use swimming::Swimming;

/// Everything that the report shows, in SI units; the page turns them into millimetres and degrees.
#[derive(Debug, Clone)]
pub(crate) struct Report {
    /// Name of the swimmer in the tank.
    pub(crate) swimmer: String,
    /// Seed of cameras and link.
    pub(crate) seed: u64,
    /// Duration of a cycle, in seconds.
    pub(crate) period_s: f64,
    /// Sphere radius and χ.
    pub(crate) parameters: Vec<Parameter>,
    /// Level of their intervals, as 0.95.
    pub(crate) level: f64,
    /// The paper's weighted error of the fit.
    pub(crate) rmse: f64,
    /// Form of tangential drag that the fit assumes.
    pub(crate) c_t_form: String,
    /// The circles that the fit saw.
    pub(crate) circles: Vec<MeasuredCircle>,
    /// Circles of many amplitudes swum by the fitted model.
    pub(crate) fitted_curve: Vec<ModelCircle>,
    /// The same by the model that the fit started from.
    pub(crate) start_curve: Vec<ModelCircle>,
    /// The reflectors' middle during one run, cleaned.
    pub(crate) track: Track,
    /// The optimised gait.
    pub(crate) gait: GaitPicture,
    /// The swimmer itself under the optimised gait, as the cameras saw it.
    pub(crate) swimming: Swimming,
    /// The optimised gait as the cameras saw it swum.
    pub(crate) swum: Track,
    /// The same as the fitted model predicts it.
    pub(crate) predicted: Track,
    /// Predicted displacement of one cycle of the optimised gait, m.
    pub(crate) displacement_predicted_m: f64,
    /// Tracked displacement of one cycle, m, with its deviation between cycles.
    pub(crate) displacement_tracked_m: (f64, f64),
    /// Tracked speed of the gait that is made for speed, m/s, and how many times as fast it is as the optimised gait, both at the
    /// servos' full rate.
    pub(crate) fastest: (f64, f64),
    /// The bound on the joints under which the robot took the gait, and the one of its servos, rad.
    pub(crate) bounds: (f64, f64),
    /// Address at which the lab page shows the fitted swimmer and its gait, if the page exists.
    pub(crate) lab: Option<String>,
    /// Other files of the folder: name and contents.
    pub(crate) files: Vec<(String, String)>,
}

/// One fitted parameter.
#[derive(Debug, Clone)]
pub(crate) struct Parameter {
    /// Name as in the paper.
    pub(crate) name: String,
    /// ` mm` or nothing, as it follows a number; the values are already in it.
    pub(crate) unit: &'static str,
    /// Starting value of the fit.
    pub(crate) start: f64,
    /// Fitted value.
    pub(crate) fitted: f64,
    /// Its interval.
    pub(crate) interval: [f64; 2],
    /// True value of the tank.
    pub(crate) truth: f64,
}

/// Measured values of one circle, means over its cycles and their deviations.
#[derive(Debug, Clone, Copy)]
pub(crate) struct MeasuredCircle {
    /// Amplitude, rad.
    pub(crate) amplitude: f64,
    /// Cycles used.
    pub(crate) cycles: usize,
    /// X and its deviation, m.
    pub(crate) x: (f64, f64),
    /// ΔY and its deviation, m.
    pub(crate) delta_y: (f64, f64),
    /// Δθ and its deviation, rad.
    pub(crate) delta_theta: (f64, f64),
}

/// One circle swum by a model.
#[derive(Debug, Clone, Copy)]
pub(crate) struct ModelCircle {
    /// Amplitude, rad.
    pub(crate) amplitude: f64,
    /// X, m.
    pub(crate) x: f64,
    /// ΔY, m.
    pub(crate) delta_y: f64,
    /// Δθ, rad.
    pub(crate) delta_theta: f64,
}

/// Poses of the middle link over time; x along the heading at the symmetric shape.
#[derive(Debug, Clone, Default)]
pub(crate) struct Track {
    /// Name of the gait.
    pub(crate) label: String,
    /// Seconds, x and y in metres, heading in radians.
    pub(crate) poses: Vec<[f64; 4]>,
}

/// A gait in the plane of the joint angles.
#[derive(Debug, Clone, Default)]
pub(crate) struct GaitPicture {
    /// The whole cycle, arc by arc: kind and shapes.
    pub(crate) arcs: Vec<(String, Vec<[f64; 2]>)>,
    /// The knots that were uploaded, thinned.
    pub(crate) set_points: Vec<[f64; 2]>,
    /// Angles that the joints really take.
    pub(crate) played: Vec<[f64; 2]>,
    /// The bound on the joints, rad.
    pub(crate) bound: f64,
}
