//! Result of one design.

use gait_optimizer::OptimalGait;
use serde::{Deserialize, Serialize};

/// Result of one design. A quantity is `None` if there is no gait or if the objective does not define it.
#[derive(Debug, Clone, PartialEq, Default, Serialize, Deserialize)]
pub struct Row {
    /// Key of the task.
    pub key: u64,
    /// Reason if there is no gait; `None` otherwise.
    pub reason: Option<String>,
    /// `true` if the gait was found from a neighbour's gait instead of by a search.
    pub warm: bool,
    /// Maximised value: |X|/L, ξ, L/s, rad or |Y|/L.
    pub objective: Option<f64>,
    /// X/L of a cycle, signed.
    pub displacement_over_length: Option<f64>,
    /// Y/L of a cycle.
    pub lateral_over_length: Option<f64>,
    /// Net rotation of a cycle \[rad\].
    pub rotation_rad: Option<f64>,
    /// Lighthill's ξ at constant power.
    pub efficiency: Option<f64>,
    /// |d|/(L T) \[1/s\] in the shortest period that the servo rates allow; `None` without rates.
    pub speed_over_length_per_s: Option<f64>,
    /// That period \[s\].
    pub period_s: Option<f64>,
    /// Largest joint angle \[rad\].
    pub amplitude_rad: Option<f64>,
    /// φ₁ at the first sample \[rad\].
    pub start_angle_rad: Option<f64>,
    /// φ₂ a quarter later \[rad\].
    pub end_angle_rad: Option<f64>,
    /// Share of the cycle with crossing links.
    pub links_cross: Option<f64>,
    /// Kinds of the arcs in order, of a quarter or of the cycle.
    pub arcs: Option<String>,
    /// `true` if the certificate passes; `None` if there is no gait.
    pub certified: Option<bool>,
}

impl Row {
    /// Row of a design without a gait.
    pub(crate) fn without(key: u64, reason: String) -> Self {
        Self {
            key,
            reason: Some(reason),
            ..Self::default()
        }
    }

    /// Row of a gait, with the quantities that the gait determines.
    pub(crate) fn of(gait: &OptimalGait, rates: Option<[f64; 2]>) -> Self {
        let distance = gait
            .displacement_over_length
            .hypot(gait.lateral_over_length);
        let period = rates.map(|rates| shortest_period(gait, rates));
        let farthest = gait.phi().iter().map(|phi| phi.x.abs().max(phi.y.abs()));
        Self {
            displacement_over_length: Some(gait.displacement_over_length),
            lateral_over_length: Some(gait.lateral_over_length),
            rotation_rad: Some(gait.rotation),
            efficiency: Some(gait.efficiency),
            speed_over_length_per_s: period.map(|period| distance / period),
            period_s: period,
            amplitude_rad: Some(farthest.fold(0.0, f64::max)),
            start_angle_rad: Some(gait.start_angle),
            end_angle_rad: Some(gait.end_angle),
            links_cross: Some(gait.links_cross),
            arcs: Some(arcs(gait)),
            certified: Some(gait.certificate.pass()),
            ..Self::default()
        }
    }

    /// Status of the design: `optimal`, `uncertified` or `none`.
    pub fn status(&self) -> &'static str {
        match self.certified {
            Some(true) => "optimal",
            Some(false) => "uncertified",
            None => "none",
        }
    }
}

fn arcs(gait: &OptimalGait) -> String {
    let words: Vec<_> = gait.arcs.iter().map(|arc| arc.kind.word()).collect();
    words.join(" ")
}

/// Shortest period \[s\] at these servo rates along the polygon of the samples.
fn shortest_period(gait: &OptimalGait, rates: [f64; 2]) -> f64 {
    let sides = gait.phi().iter().zip(gait.phi().iter().skip(1));
    sides
        .map(|(from, to)| {
            let turned = to - from;
            (turned.x.abs() / rates[0]).max(turned.y.abs() / rates[1])
        })
        .sum()
}
