//! Check of the gait that a run is said to have swum, by its sway and yaw.

use std::fmt;

use swimmer_files::{AnyGait, Campaign, GaitSpec, SwimmerFile};

use crate::median::median;
use crate::{RunResult, predict};

/// An amplitude that fits the sway less well than this belongs to another gait, as a share, among runs whose common factor is
/// known.
const OFF_AMONG_OTHERS: f64 = 0.06;
/// Least number of runs whose common factor is estimated: it holds the servos' gain and errors of the model.
const ENOUGH_RUNS: usize = 3;
/// Corrections of the amplitude.
const CORRECTIONS: usize = 3;

/// A run that sways like another gait than its campaign says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct OtherGait {
    /// The run's place in the campaign.
    pub index: usize,
    /// The amplitude that it sways like \[rad\].
    pub sways_like_rad: f64,
    /// The amplitude that the campaign says \[rad\].
    pub stated_rad: f64,
}

impl fmt::Display for OtherGait {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "it sways like a gait of {:.3}°, not of {:.3}°, compared with the other runs: correct its `gait`, or leave it out (`exclude = \"why\"`)",
            self.sways_like_rad.to_degrees(),
            self.stated_rad.to_degrees()
        )
    }
}

/// The runs of a campaign whose sway and yaw fit another amplitude, after the factor common to all runs.
pub fn other_gaits(
    campaign: &Campaign,
    runs: &[RunResult],
    swimmer: &SwimmerFile,
) -> Vec<OtherGait> {
    let factors: Vec<(usize, f64, f64)> = runs
        .iter()
        .filter_map(|run| {
            let stated = campaign.runs.get(run.index)?;
            let (amplitude, factor) =
                amplitude_by_sway(run, &stated.gait, stated.period_s, swimmer)?;
            Some((run.index, amplitude, factor))
        })
        .collect();
    if factors.len() < ENOUGH_RUNS {
        return Vec::new();
    }
    let Some(common) = median(factors.iter().map(|(.., factor)| *factor)) else {
        return Vec::new();
    };
    let off = |factor: f64| factor / common - 1.0;
    let unlike = factors
        .into_iter()
        .filter(|(.., factor)| off(*factor).abs() > OFF_AMONG_OTHERS);
    unlike
        .map(|(index, stated_rad, factor)| OtherGait {
            index,
            sways_like_rad: stated_rad * factor / common,
            stated_rad,
        })
        .collect()
}

fn amplitude(gait: &GaitSpec) -> Option<f64> {
    match gait {
        GaitSpec::Circle { amplitude, .. } | GaitSpec::Square { amplitude, .. } => Some(*amplitude),
        GaitSpec::File { .. } => None,
    }
}

/// Stated amplitude \[rad\] of a circle or square, and its ratio to the amplitude whose sway and yaw are nearest to those of the run.
/// Returns `None` for other gaits, or if no amplitude has such sway and yaw.
pub fn amplitude_by_sway(
    run: &RunResult,
    gait: &GaitSpec,
    period_s: f64,
    swimmer: &SwimmerFile,
) -> Option<(f64, f64)> {
    let stated = amplitude(gait)?;
    let measured = [run.cycles.delta_y.mean, run.cycles.delta_theta.mean];
    let mut factor = 1.0;
    for _ in 0..CORRECTIONS {
        let shape = match gait {
            GaitSpec::Circle { clockwise, .. } => {
                AnyGait::circle(stated * factor).reversed_if(*clockwise)
            }
            GaitSpec::Square { clockwise, .. } => {
                AnyGait::square(stated * factor).reversed_if(*clockwise)
            }
            GaitSpec::File { .. } => return None,
        };
        let predicted = predict(swimmer, &shape, period_s).ok()?;
        let [sway, yaw] = [
            measured[0] / predicted.delta_y_m,
            measured[1] / predicted.delta_theta_rad,
        ];
        factor *= (sway * yaw).sqrt();
        if !(factor.is_finite() && factor > 0.05 && factor < 20.0) {
            return None;
        }
    }
    Some((stated, factor))
}
