//! `swimmer optimize speed --power`, `--torque`: the fastest gait of servos that give so many watts or newton-metres.

use std::collections::BTreeMap;
use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use gait_optimizer::{Arc, Limited, LimitedError, LimitedProblem, Torque, fastest_within};
use serde::Serialize;
use swimmer_files::{Bounds, SwimmerFile};

use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::progress::Progress;
use crate::quantity::{self, Rows};
use crate::threads;

use super::answer::{Closing, Pace, arc_rows, unfolded};

/// What limits the servos.
pub(super) struct Limits {
    /// \[W\]
    pub(super) power: Option<f64>,
    /// \[rad/s\]
    pub(super) rates: Option<[f64; 2]>,
    /// Whether their torque does, as the swimmer file says.
    pub(super) torque: bool,
}

/// Finds, writes and tells the gait within these limits.
pub(super) fn within(
    file: &SwimmerFile,
    bounds: Bounds,
    limits: &Limits,
    path: Option<PathBuf>,
    output: Output,
) -> Outcome {
    let fluid = file.fluid.ok_or_else(|| {
        Failure::BadInput(format!(
            "{} names no fluid, without which a power or a torque tells nothing; give [fluid] kinematic_viscosity and density in a \
             swimmer file",
            file.name
        ))
    })?;
    let viscosity = fluid.viscosity();
    let torque = if limits.torque {
        Some(torque(file, viscosity)?)
    } else {
        None
    };
    let begun = Instant::now();
    let progress = Progress::of_a_whole("looking for the fastest gait");
    let problem = LimitedProblem {
        swimmer: file.swimmer,
        bounds,
        power_over_viscosity: limits.power.map(|power| power / viscosity),
        rates: limits.rates,
        torque,
        threads: threads::available(),
    };
    let found = fastest_within(&problem, &|share| progress.at_share(share))?;
    drop(progress);
    let seconds = begun.elapsed().as_secs_f64();
    unfolded(&found.gait)?;
    if let Some(path) = &path {
        found.gait.gait_file(&file.name).save(path)?;
    }
    output.answer(&Answer::new(file, viscosity, &found, (seconds, path)));
    Ok(())
}

/// What the servos of the file give.
fn torque(file: &SwimmerFile, viscosity: f64) -> Result<Torque, Failure> {
    let servo = file.servo.unwrap_or_default();
    match (servo.torque, servo.no_load_rate) {
        (Some(torque), Some(no_load_rate)) => Ok(Torque {
            stall_over_viscosity: torque / viscosity,
            no_load_rate,
        }),
        (torque, _) => Err(Failure::BadInput(format!(
            "{} does not say what its servos give: [servo] {} is missing; give torque_n_m, at stall, and no_load_rate in rad/s in a \
             swimmer file",
            file.name,
            if torque.is_none() {
                "torque_n_m"
            } else {
                "no_load_rate"
            }
        ))),
    }
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(skip)]
    name: String,
    #[serde(flatten)]
    pace: Pace,
    /// Of the displacement against the cycle's mean heading.
    heading_rad: Option<f64>,
    rotation_rad: f64,
    efficiency: f64,
    /// `power`, `rate` or `torque`, or several joined by ` and `: what keeps it from being faster.
    limited_by: String,
    /// Of each of them, the share of the period in which it binds.
    limit_shares: BTreeMap<&'static str, f64>,
    peak_power_w: f64,
    peak_rates_rad_s: [f64; 2],
    peak_torques_n_m: [f64; 2],
    /// By what share the speed differed on half as many elements, where several limits bind.
    refinement: Option<f64>,
    /// The speed of a faster gait that failed its certificate.
    uncertified_speed_over_length_per_s: Option<f64>,
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
        let shares = found
            .limits
            .iter()
            .map(|(limit, share)| (limit.word(), *share));
        let words: Vec<&str> = shares.clone().map(|(word, _)| word).collect();
        Self {
            name: file.name.clone(),
            pace: Pace::new(
                file,
                (found.speed_over_length, found.distance_over_length),
                found.period,
            ),
            heading_rad: gait.heading(),
            rotation_rad: gait.rotation,
            efficiency: gait.efficiency,
            limited_by: words.join(" and "),
            limit_shares: shares.collect(),
            peak_power_w: found.peak_power_over_viscosity * viscosity,
            peak_rates_rad_s: found.peak_rates,
            peak_torques_n_m: found.peak_torques_over_viscosity.map(|one| one * viscosity),
            refinement: found.refinement,
            uncertified_speed_over_length_per_s: found.uncertified,
            arcs: gait.arcs.clone(),
            corners: gait.corners().to_vec(),
            closing: Closing::new(gait, None, seconds, path),
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        let limited_by: Vec<String> = self
            .limit_shares
            .iter()
            .map(|(limit, share)| format!("{limit} {:.1} % of the cycle", share * 100.0))
            .collect();
        let [front, back] = self.peak_rates_rad_s.map(quantity::angle);
        self.pace.rows(&mut rows);
        rows.row("efficiency ξ", format!("{:.10}", self.efficiency))
            .row("limited by", limited_by.join(", "))
            .row(
                "takes at most",
                format!(
                    "{} mW, {front} and {back} a second, {} and {} mN m",
                    quantity::small(self.peak_power_w * 1e3),
                    quantity::small(self.peak_torques_n_m[0] * 1e3),
                    quantity::small(self.peak_torques_n_m[1] * 1e3)
                ),
            );
        if let Some(refinement) = self.refinement {
            rows.row(
                "refined",
                format!("{refinement:.1e} of the speed, on twice as many elements"),
            );
        }
        if let Some(speed) = self.uncertified_speed_over_length_per_s {
            rows.row(
                "not certified",
                format!(
                    "another gait is {:.4} % faster, but meets not all conditions",
                    (speed / self.pace.speed_over_length_per_s - 1.0) * 100.0
                ),
            );
        }
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
            quantity::length(self.pace.displacement_m),
            self.pace.period_s,
            quantity::length(self.pace.speed_m_per_s),
        )
    }
}

impl From<LimitedError> for Failure {
    /// A problem that makes no sense is bad input; one without an answer was tried.
    fn from(error: LimitedError) -> Self {
        match error {
            LimitedError::Power { .. }
            | LimitedError::Torque { .. }
            | LimitedError::Unlimited
            | LimitedError::Problem(_) => Self::bad_input(&error),
            LimitedError::Speed(error) => error.into(),
            LimitedError::Atlas(error) => error.into(),
            LimitedError::NoGait { .. } => Self::tried(&error),
        }
    }
}
