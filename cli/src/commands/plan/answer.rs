//! What `swimmer plan` answers.

use std::fmt;
use std::path::PathBuf;

use serde::Serialize;

use crate::quantity::{self, Rows};

/// How far two poses are apart.
#[derive(Debug, Clone, Copy, Serialize)]
pub(super) struct Off {
    distance_m: f64,
    angle_rad: f64,
}

impl Off {
    pub(super) fn new([distance_m, angle_rad]: [f64; 2]) -> Self {
        Self {
            distance_m,
            angle_rad,
        }
    }
}

#[derive(Debug, Serialize)]
struct StepAnswer {
    /// The gait file, where the plan was written; else its name.
    gait: String,
    cycles: u32,
    period_s: f64,
    /// Share of the way from the common shape.
    scale: f64,
}

#[derive(Debug, Serialize)]
struct Place {
    x_m: f64,
    y_m: f64,
    heading_rad: f64,
}

#[derive(Debug, Serialize)]
pub(super) struct Answer {
    #[serde(skip)]
    name: String,
    steps: Vec<StepAnswer>,
    duration_s: f64,
    reached: Place,
    /// From the target, in the model.
    off_m: f64,
    off_rad: f64,
    /// From where the plan leads, where the swimmer's χ is other than in its file.
    off_if_chi_is_5_percent_lower: Off,
    off_if_chi_is_5_percent_higher: Off,
    /// Chains of legs that meet the target, and those that the walls leave.
    chains: usize,
    chains_within_walls: usize,
    #[serde(skip_serializing_if = "Option::is_none")]
    playlist: Option<PathBuf>,
}

impl Answer {
    pub(super) fn new(
        name: &str,
        plan: &forecast::Plan,
        [lower, higher]: [Off; 2],
        gaits: Option<Vec<String>>,
        playlist: Option<PathBuf>,
    ) -> Self {
        let gaits = gaits.unwrap_or_default();
        let step = |(at, step): (usize, &forecast::Step)| StepAnswer {
            gait: gaits
                .get(at)
                .cloned()
                .unwrap_or_else(|| plan.word(step).to_owned()),
            cycles: step.cycles,
            period_s: step.period,
            scale: step.member.scale,
        };
        Self {
            name: name.to_owned(),
            steps: plan.steps.iter().enumerate().map(step).collect(),
            duration_s: plan.duration,
            reached: Place {
                x_m: plan.reached.x,
                y_m: plan.reached.y,
                heading_rad: plan.reached.theta,
            },
            off_m: plan.off[0],
            off_rad: plan.off[1],
            off_if_chi_is_5_percent_lower: lower,
            off_if_chi_is_5_percent_higher: higher,
            chains: plan.met[0],
            chains_within_walls: plan.met[1],
            playlist,
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        for step in &self.steps {
            rows.row(
                step.gait.as_str(),
                format!(
                    "{} cycles of {:.3} s, at {:.2} % of its size",
                    step.cycles,
                    step.period_s,
                    step.scale * 100.0
                ),
            );
        }
        let off = |off: &Off| {
            format!(
                "{} and {} off",
                quantity::length(off.distance_m),
                quantity::angle(off.angle_rad)
            )
        };
        rows.row(
            "reaches",
            format!(
                "({}, {}), heading {}: {:.1e} m off",
                quantity::length(self.reached.x_m),
                quantity::length(self.reached.y_m),
                quantity::angle(self.reached.heading_rad),
                self.off_m
            ),
        )
        .row("χ 5 % lower", off(&self.off_if_chi_is_5_percent_lower))
        .row("χ 5 % higher", off(&self.off_if_chi_is_5_percent_higher))
        .row(
            "found",
            format!(
                "{} chains meet the target, {} of them within the walls",
                self.chains, self.chains_within_walls
            ),
        );
        if let Some(path) = &self.playlist {
            rows.row("written to", path.display().to_string());
        }
        write!(
            f,
            "{}: the quickest plan found takes {:.1} s\n{rows}",
            self.name, self.duration_s
        )
    }
}
