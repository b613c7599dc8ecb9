//! `swimmer optimize speed --power`, `--torque`: the fastest gait of servos that give so many watts or newton-metres.

use std::collections::BTreeMap;

use gait_optimizer::{LimitedError, LimitedProblem, Torque, fastest_within};
use swimmer_files::{Bounds, SwimmerFile};

use super::answer::tell_arcs;
use super::pace::{SEARCHING, at_pace, tell_as_played};
use super::{Found, Task};
use crate::failure::{Failure, Outcome};
use crate::quantity;
use crate::threads;

/// What limits the servos.
pub(super) struct Limits {
    /// \[W\]
    pub(super) power: Option<f64>,
    /// \[rad/s\]
    pub(super) rates: Option<[f64; 2]>,
    /// Whether their torque does, as the swimmer file says.
    pub(super) torque: bool,
}

/// The fastest gait within these limits.
pub(super) fn within(task: &Task, bounds: Bounds, limits: &Limits) -> Outcome<Found> {
    let file = &task.file;
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
    let problem = LimitedProblem {
        swimmer: file.swimmer,
        bounds,
        power_over_viscosity: limits.power.map(|power| power / viscosity),
        rates: limits.rates,
        torque,
        threads: threads::available(),
    };
    let found = task.watched(SEARCHING, |watch| fastest_within(&problem, watch))?;
    let gait = &found.gait;
    let speed = found.speed_over_length;
    let power = found.peak_power_over_viscosity * viscosity;
    let torques = found.peak_torques_over_viscosity.map(|one| one * viscosity);
    // What keeps it from being faster, and of each the share of the period in which it binds.
    let shares = found
        .limits
        .iter()
        .map(|(limit, share)| (limit.word(), *share));
    let words: Vec<&str> = shares.clone().map(|(word, _)| word).collect();
    let shares: BTreeMap<_, _> = shares.collect();
    let told = shares
        .iter()
        .map(|(limit, share)| format!("{limit} {:.1} % of the cycle", share * 100.0));
    let told: Vec<_> = told.collect();
    let [front, back] = found.peak_rates.map(quantity::angle);
    let mut answer = at_pace(
        "fastest",
        file,
        (speed, found.distance_over_length),
        found.period,
    );
    answer
        // Of the displacement against the cycle's mean heading.
        .key("heading_rad", gait.heading())
        .key("rotation_rad", gait.rotation)
        .key("efficiency", gait.efficiency)
        .key("limited_by", words.join(" and "))
        .key("limit_shares", shares)
        .key("peak_power_w", power)
        .key("peak_rates_rad_s", found.peak_rates)
        .key("peak_torques_n_m", torques)
        // By what share the speed differed on half as many elements, where several limits bind.
        .key("refinement", found.refinement)
        // Of a faster gait that failed its certificate.
        .key("uncertified_speed_over_length_per_s", found.uncertified)
        .row("efficiency ξ", format!("{:.10}", gait.efficiency))
        .row("limited by", told.join(", "))
        .row(
            "takes at most",
            format!(
                "{} mW, {front} and {back} a second, {} and {} mN m",
                quantity::small(power * 1e3),
                quantity::small(torques[0] * 1e3),
                quantity::small(torques[1] * 1e3)
            ),
        );
    if let Some(refinement) = found.refinement {
        answer.row(
            "refined",
            format!("{refinement:.1e} of the speed, on twice as many elements"),
        );
    }
    if let Some(uncertified) = found.uncertified {
        answer.row(
            "not certified",
            format!(
                "another gait is {:.4} % faster, but meets not all conditions",
                (uncertified / speed - 1.0) * 100.0
            ),
        );
    }
    if let Some(heading) = gait.heading() {
        answer.row(
            "leads",
            format!("{} off the mean heading", quantity::angle(heading)),
        );
    }
    tell_arcs(&mut answer, &gait.arcs);
    answer.key("corners", gait.corners().to_vec());
    tell_as_played(&mut answer, file, file.servo, (gait, found.period));
    Ok(Found::gait(answer, task, gait, None))
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
