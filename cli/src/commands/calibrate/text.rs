//! Text of `swimmer calibrate`.

use std::fmt;

use calibrate::Intervals;
use calibrate::evidence::Pair;
use operations::calibrate::{Output, RunOutput, RunsOutput};

use super::{assessment, beyond_fit, joints};
use crate::quantity::{self, Rows, Table};

/// Output of a single run as text.
pub(super) struct RunsText<'a>(pub(super) &'a RunsOutput);

/// Output of a campaign as text.
pub(super) struct FitText<'a>(pub(super) &'a Output);

impl fmt::Display for RunsText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(output) = self;
        write!(f, "{}", table(&output.runs))?;
        left_out(f, &output.runs)?;
        notes(f, &output.warnings)
    }
}

/// Front rule and phase of each run, and its whole cycles that were left out.
fn left_out(f: &mut fmt::Formatter<'_>, runs: &[RunOutput]) -> fmt::Result {
    for run in runs {
        if run.front_rule.is_none() {
            write!(f, "\n  {}: reported, without a track", run.file)?;
            continue;
        }
        write!(
            f,
            "\n  {}: front {}, phase by {}",
            run.file,
            run.front_words,
            run.phase.replace('-', " ")
        )?;
        for cycle in &run.left_out {
            write!(f, "; left out at {:.2} s: {}", cycle.start_s, cycle.reason)?;
        }
        for diagnosis in &run.diagnoses {
            write!(f, "; {diagnosis}")?;
        }
    }
    Ok(())
}

fn notes(f: &mut fmt::Formatter<'_>, warnings: &[String]) -> fmt::Result {
    warnings
        .iter()
        .try_for_each(|warning| write!(f, "\n  note: {warning}"))
}

impl fmt::Display for FitText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self(output) = self;
        let mut rows = Rows::default();
        let [radius, chi] = with_intervals(output.sphere_radius_m, output.chi, &output.intervals);
        rows.row("sphere radius r_s", radius)
            .row("drag ratio χ", chi);
        if let Some(systematics) = output.assessment.as_ref().and_then(assessment::estimate) {
            let [radius, chi] = systematics;
            rows.row("r_s with systematics", radius)
                .row("χ with systematics", chi);
        }
        rows.row(
            "RMSE",
            format!("{} (the paper's weights)", quantity::small(output.rmse)),
        )
        .row("form of c_t", &output.c_t_form);
        if let Some(likelihood) = &output.likelihood {
            let Pair { sphere_radius, chi } = likelihood.estimate;
            let [radius, chi] = with_intervals(sphere_radius, chi, &likelihood.intervals);
            rows.row("r_s by likelihood", radius)
                .row("χ by likelihood", chi);
        }
        write!(f, "{}", table(&output.runs))?;
        left_out(f, &output.runs)?;
        if let Some(assessment) = &output.assessment {
            write!(f, "{}", assessment::heading(assessment))?;
        }
        write!(f, "\n\n{rows}")?;
        notes(f, &output.warnings)?;
        let joints = output.joints.as_ref().map(joints::table);
        let assessed = output.assessment.iter().flat_map(assessment::tables);
        let mut all = joints
            .into_iter()
            .chain(assessed)
            .chain(beyond_fit::tables(output));
        all.try_for_each(|table| write!(f, "\n\n{table}"))
    }
}

/// `r_s` and χ with their intervals, for people: as many decimals as these give sense to.
pub(super) fn with_intervals(sphere_radius_m: f64, chi: f64, intervals: &Intervals) -> [String; 2] {
    let percent = intervals.level * 100.0;
    let of = |value: f64, ends: [f64; 2], unit: &str| {
        let decimals = quantity::decimals(ends);
        let [low, high] = ends;
        format!(
            "{value:.decimals$}{unit}   ({percent:.0} %: {low:.decimals$} … {high:.decimals$}{unit})"
        )
    };
    [
        of(
            sphere_radius_m * 1e3,
            intervals.sphere_radius.map(|end| end * 1e3),
            " mm",
        ),
        of(chi, intervals.chi, ""),
    ]
}

fn table(runs: &[RunOutput]) -> Table {
    let mut table = Table::new([
        "run",
        "gait",
        "cycles",
        "X [mm]",
        "Y [mm]",
        "ΔY [mm]",
        "Δθ",
        "period [s]",
    ]);
    for run in runs {
        table.line([
            run.file.clone(),
            run.gait.clone(),
            run.cycles
                .map_or_else(|| "–".to_owned(), |cycles| cycles.to_string()),
            with_deviation([run.x_m, run.x_sd_m], millimetres),
            with_deviation([run.y_m, f64::NAN], millimetres),
            with_deviation([run.delta_y_m, run.delta_y_sd_m], millimetres),
            with_deviation(
                [run.delta_theta_rad, run.delta_theta_sd_rad],
                quantity::angle,
            ),
            format!("{:.3}", run.period_s),
        ]);
    }
    table
}

fn millimetres(metres: f64) -> String {
    format!("{:.3}", metres * 1e3)
}

/// A mean with its deviation, if there are several cycles.
fn with_deviation([mean, deviation]: [f64; 2], written: fn(f64) -> String) -> String {
    if mean.is_nan() {
        "–".to_owned()
    } else if deviation.is_nan() {
        written(mean)
    } else {
        format!("{} ± {}", written(mean), written(deviation))
    }
}
