//! The report of a calibration: one page, and every intermediate as CSV and JSON.

mod figures;
mod page;
mod tables;

use calibrate::assessment::Systematics;
use calibrate::evidence::{CurvePoint, Evidence};
use calibrate::{CampaignFit, EvidenceOptions};
use operations::calibrate::Output;
use swimmer_files::{Campaign, GaitSpec, Provenance, SwimmerFile};

pub(crate) use self::page::page;
pub(crate) use self::tables::tables;
use super::{MeasuredCircle, ModelCircle};

/// Everything that the report shows.
pub(crate) struct Calibration<'a> {
    pub(crate) campaign: &'a Campaign,
    pub(crate) found: &'a CampaignFit,
    pub(crate) evidence: &'a Evidence,
    pub(crate) output: &'a Output,
    /// The estimate with systematics, if there is one.
    pub(crate) systematics: Option<&'a Systematics>,
    pub(crate) options: EvidenceOptions,
    pub(crate) provenance: &'a Provenance,
    /// Other files of the folder: name and contents.
    pub(crate) files: Vec<(&'static str, &'static str)>,
}

impl Calibration<'_> {
    fn start(&self) -> &SwimmerFile {
        &self.campaign.swimmer
    }

    /// The runs that were circles, as points over the amplitude; clockwise ones count as what they are, mirrored.
    fn circles(&self) -> Vec<MeasuredCircle> {
        let runs = self.found.runs.iter();
        runs.filter_map(|run| match &self.campaign.runs[run.index].gait {
            GaitSpec::Circle {
                amplitude,
                clockwise,
            } => {
                let cycles = &run.cycles;
                // A single cycle has no deviation, and its point no bar.
                let of = |s: &calibrate::Statistics| (s.mean, s.sd.max(0.0));
                let (x, sd) = of(&cycles.x);
                Some(MeasuredCircle {
                    amplitude: *amplitude,
                    cycles: cycles.count().unwrap_or(1),
                    x: (if *clockwise { -x } else { x }, sd),
                    delta_y: of(&cycles.delta_y),
                    delta_theta: of(&cycles.delta_theta),
                })
            }
            _ => None,
        })
        .collect()
    }
}

fn model_circles(curve: &[CurvePoint]) -> Vec<ModelCircle> {
    curve
        .iter()
        .map(|point| ModelCircle {
            amplitude: point.amplitude_rad,
            x: point.cycle.x_m,
            delta_y: point.cycle.delta_y_m,
            delta_theta: point.cycle.delta_theta_rad,
        })
        .collect()
}
