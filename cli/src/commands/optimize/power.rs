//! `swimmer optimize speed --power`: the fastest gait of servos that give so many watts.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use gait_optimizer::{Arc, Limited, PowerError, PowerProblem, fastest_on_power};
use serde::Serialize;
use swimmer_files::{Bounds, SwimmerFile};

use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::progress::Progress;
use crate::quantity::{self, Rows};
use crate::threads;

use super::answer::{Closing, arc_rows, unfolded};

/// Finds, writes and tells the gait within limits on power \[W\] and, where they are given, rates \[rad/s\].
pub(super) fn on_power(
    file: &SwimmerFile,
    bounds: Bounds,
    (power, rates): (f64, Option<[f64; 2]>),
    path: Option<PathBuf>,
    output: Output,
) -> Outcome {
    let fluid = file.fluid.ok_or_else(|| {
        Failure::BadInput(format!(
            "{} names no fluid, without which a power tells nothing; give [fluid] kinematic_viscosity_m2_s and density_kg_m3 in a \
             swimmer file",
            file.name
        ))
    })?;
    let begun = Instant::now();
    let progress = Progress::of_a_whole("looking for the fastest gait");
    let problem = PowerProblem {
        swimmer: file.swimmer,
        bounds,
        power_over_viscosity: power / fluid.viscosity(),
        rates,
        threads: threads::available(),
    };
    let found = fastest_on_power(&problem, &|share| progress.at_share(share))?;
    drop(progress);
    let seconds = begun.elapsed().as_secs_f64();
    unfolded(&found.gait)?;
    if let Some(path) = &path {
        found.gait.gait_file(&file.name).save(path)?;
    }
    let viscosity = fluid.viscosity();
    output.answer(&Answer::new(file, viscosity, &found, (seconds, path)));
    Ok(())
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(skip)]
    name: String,
    speed_over_length_per_s: f64,
    speed_m_per_s: f64,
    /// |d| of a cycle.
    displacement_over_length: f64,
    displacement_m: f64,
    period_s: f64,
    /// Of the displacement against the cycle's mean heading.
    heading_rad: Option<f64>,
    rotation_rad: f64,
    efficiency: f64,
    /// `power` or `rate`: what keeps it from being faster.
    limited_by: &'static str,
    peak_power_w: f64,
    peak_rates_rad_s: [f64; 2],
    arcs: Vec<Arc>,
    corners: Vec<f64>,
    #[serde(flatten)]
    closing: Closing,
}

impl Answer {
    fn new(
        file: &SwimmerFile,
        viscosity: f64,
        found: &Limited,
        (seconds, path): (f64, Option<PathBuf>),
    ) -> Self {
        let gait = &found.gait;
        let length = file.swimmer.total_length();
        Self {
            name: file.name.clone(),
            speed_over_length_per_s: found.speed_over_length,
            speed_m_per_s: found.speed_over_length * length,
            displacement_over_length: found.distance_over_length,
            displacement_m: found.distance_over_length * length,
            period_s: found.period,
            heading_rad: gait.heading(),
            rotation_rad: gait.rotation,
            efficiency: gait.efficiency,
            limited_by: found.limit.word(),
            peak_power_w: found.peak_power_over_viscosity * viscosity,
            peak_rates_rad_s: found.peak_rates,
            arcs: gait.arcs.clone(),
            corners: gait.corners().to_vec(),
            closing: Closing::new(gait, None, seconds, path),
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        let [front, back] = self.peak_rates_rad_s.map(quantity::angle);
        rows.row(
            "speed",
            format!(
                "{} a second   |d|/(L T) = {:.10} 1/s",
                quantity::length(self.speed_m_per_s),
                self.speed_over_length_per_s
            ),
        )
        .row(
            "displacement",
            format!(
                "{} per cycle   |d|/L = {:.10}",
                quantity::length(self.displacement_m),
                self.displacement_over_length
            ),
        )
        .row("period", format!("{:.6} s", self.period_s))
        .row("efficiency ξ", format!("{:.10}", self.efficiency))
        .row("limited by", self.limited_by)
        .row(
            "takes at most",
            format!(
                "{} mW, {front} and {back} a second",
                quantity::small(self.peak_power_w * 1e3)
            ),
        );
        if let Some(heading) = self.heading_rad {
            rows.row(
                "leads",
                format!("{} off the mean heading", quantity::angle(heading)),
            );
        }
        arc_rows(&mut rows, &self.arcs);
        self.closing.rows(&mut rows);
        write!(
            f,
            "{}: the fastest gait swims {} in {:.2} s, {} a second\n{rows}",
            self.name,
            quantity::length(self.displacement_m),
            self.period_s,
            quantity::length(self.speed_m_per_s),
        )
    }
}

impl From<PowerError> for Failure {
    /// A problem that makes no sense is bad input; one without an answer was tried.
    fn from(error: PowerError) -> Self {
        match error {
            PowerError::Power { .. } => Self::bad_input(&error),
            PowerError::Speed(error) => error.into(),
            PowerError::Atlas(error) => error.into(),
            PowerError::NoGait { .. } | PowerError::BothBind { .. } => Self::tried(&error),
        }
    }
}
