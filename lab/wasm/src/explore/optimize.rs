//! `optimize`: optimal gaits, with the names of the commands, each with its certificate and its file.

use gait_optimizer::{
    Arc, Branch, Certificate, DisplacementProblem, EfficiencyProblem, OptimalGait, SidewaysProblem,
    SpeedProblem, TurningProblem, displacement, efficiency, fastest, sideways, turning,
};
use operations::bounds::BoundsRequest;
use serde::{Deserialize, Serialize};

use crate::calls::{Lab, Outcome, json, parsed};
use crate::input::SwimmerText;

#[derive(Deserialize)]
struct OptimizeRequest {
    swimmer: SwimmerText,
    what: Optimum,
    #[serde(default)]
    bounds: BoundsRequest,
    /// Largest rate for `speed` \[rad/s\]; default: that of the swimmer's servos.
    max_rate: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "kebab-case")]
enum Optimum {
    Displacement,
    EfficiencySmall,
    EfficiencyLarge,
    Turning,
    Sideways,
    Speed,
}

#[derive(Serialize)]
struct OptimizeOutput {
    /// |d|/L of the fastest gait, otherwise X/L.
    displacement_over_length: f64,
    displacement_m: f64,
    lateral_over_length: f64,
    rotation_rad: f64,
    /// Efficiency at constant power; for the fastest gait with its own timing.
    efficiency: f64,
    start_angle_rad: f64,
    end_angle_rad: f64,
    arcs: Vec<Arc>,
    links_cross: f64,
    certificate: Certificate,
    /// Period of the fastest gait.
    period_s: Option<f64>,
    speed_over_length_per_s: Option<f64>,
    /// Text of the gait file.
    gait: String,
}

/// Finds an optimum.
pub(super) fn optimize(_: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: OptimizeRequest = parsed(bytes)?;
    let file = request.swimmer.read()?;
    let (swimmer, bounds) = (file.swimmer, request.bounds.of(&file));
    let of_branch = |branch| {
        let problem = EfficiencyProblem {
            bounds,
            ..EfficiencyProblem::new(swimmer, branch)
        };
        efficiency(&problem).map_err(|why| why.to_string())
    };
    let found = match request.what {
        Optimum::Displacement => {
            let problem = DisplacementProblem {
                bounds,
                ..DisplacementProblem::new(swimmer)
            };
            OptimizeOutput::new(
                &displacement(&problem).map_err(|why| why.to_string())?,
                &file.name,
            )
        }
        Optimum::EfficiencySmall => OptimizeOutput::new(&of_branch(Branch::Small)?, &file.name),
        Optimum::EfficiencyLarge => OptimizeOutput::new(&of_branch(Branch::Large)?, &file.name),
        Optimum::Turning => {
            let found =
                turning(&TurningProblem { swimmer, bounds }).map_err(|why| why.to_string())?;
            OptimizeOutput::new(&found.gait, &file.name)
        }
        Optimum::Sideways => {
            let problem = SidewaysProblem {
                bounds,
                ..SidewaysProblem::new(swimmer)
            };
            OptimizeOutput::new(
                &sideways(&problem, &|_| ())
                    .map_err(|why| why.to_string())?
                    .gait,
                &file.name,
            )
        }
        Optimum::Speed => {
            let rate = request
                .max_rate
                .unwrap_or(file.servo.unwrap_or_default().max_rate);
            let problem = SpeedProblem {
                bounds,
                ..SpeedProblem::new(swimmer, [rate; 2])
            };
            let found = fastest(&problem).map_err(|why| why.to_string())?;
            OptimizeOutput {
                period_s: Some(found.period),
                speed_over_length_per_s: Some(found.speed_over_length),
                displacement_over_length: found.distance_over_length,
                displacement_m: found.distance_over_length * swimmer.total_length(),
                ..OptimizeOutput::new(&found.gait, &file.name)
            }
        }
    };
    json(&found)
}

impl OptimizeOutput {
    fn new(gait: &OptimalGait, name: &str) -> Self {
        Self {
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            lateral_over_length: gait.lateral_over_length,
            rotation_rad: gait.rotation,
            efficiency: gait.efficiency,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            arcs: gait.arcs.clone(),
            links_cross: gait.links_cross,
            certificate: gait.certificate.clone(),
            period_s: None,
            speed_over_length_per_s: None,
            gait: gait.gait_file(name).to_text(),
        }
    }
}
