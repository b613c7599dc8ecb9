//! Text of an assessment: the verdict with its reasons, and the tables behind them.

use std::fmt::Write as _;

use calibrate::assessment::{AssessmentDocument, RepeatsPart, RunPart, SystematicsPart};

use super::beyond_fit::{ResultTable, readable};
use super::text::with_intervals;
use crate::quantity::{self, Table};

/// The verdict and its reasons, as the terminal shows them.
pub(super) fn heading(assessed: &AssessmentDocument) -> String {
    let mut text = format!("\n\n  verdict: {}", assessed.verdict);
    for reason in &assessed.reasons {
        // Writing to a String cannot fail.
        let _ = write!(text, "\n    - {reason}");
    }
    for run in &assessed.excluded {
        let _ = write!(text, "\n    not fitted: {}: {}", run.file, run.reason);
    }
    if assessed.headline.by != "paper" {
        let _ = write!(text, "\n    recommended: the estimate with systematics");
    }
    text
}

/// `r_s` and χ with systematics, for people.
pub(super) fn estimate(assessed: &AssessmentDocument) -> Option<[String; 2]> {
    let systematics = assessed.systematics.as_ref()?;
    let intervals = assessed.intervals_with_systematics.as_ref()?;
    let of = systematics.estimate;
    Some(with_intervals(of.sphere_radius, of.chi, intervals))
}

/// Tables: nuisance parameters, error budget, explanations, statistics of the runs.
pub(crate) fn tables(assessed: &AssessmentDocument) -> Vec<ResultTable> {
    let known = assessed.systematics.as_ref().map(known);
    let tables = [budget(assessed), explained(assessed), of_runs(assessed)];
    known.into_iter().chain(tables).collect()
}

fn budget(assessed: &AssessmentDocument) -> ResultTable {
    let mut table = Table::new(["if off by", "", "r_s moves by", "χ moves by", "known to ±"]);
    for line in &assessed.budget {
        let width = line.width.map_or_else(
            || "exact".to_owned(),
            |width| {
                format!(
                    "{}{}",
                    change(line.unit, width),
                    if line.stated { "" } else { " (usual)" }
                )
            },
        );
        table.line([
            line.name.to_owned(),
            change(line.unit, line.by),
            format!("{:+.3} mm", 1e3 * line.sphere_radius),
            format!("{:+.4}", line.chi),
            width,
        ]);
    }
    ResultTable {
        title: "The budget of systematic errors",
        table,
        notes: vec![
            "how far r_s and χ of greatest likelihood come out wrong where the truth is off by so much from what the files say; \
             what is known to ± something else is stated under [known] in the campaign"
                .to_owned(),
        ],
    }
}

fn explained(assessed: &AssessmentDocument) -> ResultTable {
    let mut table = Table::new(["what may be off", "log-likelihood", "would be", "r_s", "χ"]);
    for explanation in &assessed.explanations {
        let values = explanation
            .parameters
            .iter()
            .map(|p| readable(p.unit, p.value));
        table.line([
            explanation.name.to_owned(),
            format!("{:+.1}", explanation.gain),
            values.collect::<Vec<_>>().join(", "),
            format!("{:.2} mm", 1e3 * explanation.estimate.sphere_radius),
            format!("{:.3}", explanation.estimate.chi),
        ]);
    }
    ResultTable {
        title: "Explanations of the runs, side by side",
        table,
        notes: vec![
            "each fitted alone with r_s and χ, without its prior, by X, ΔY, Δθ, Y and net turn; gains relative to r_s and χ alone; the runs \
             cannot distinguish explanations within 2 of each other"
                .to_owned(),
        ],
    }
}

fn of_runs(assessed: &AssessmentDocument) -> ResultTable {
    let mut table = Table::new([
        "run",
        "Y/X",
        "chance",
        "net turn",
        "chance",
        "drift along, across",
        "lengths",
    ]);
    // Reported results may lack one.
    let there = |value: f64, written: String| {
        if value.is_nan() {
            "–".to_owned()
        } else {
            written
        }
    };
    let chance = |chance: f64| {
        if chance.is_nan() {
            "–".to_owned()
        } else if chance < 1e-3 {
            "< 0.001".to_owned()
        } else {
            format!("{chance:.3}")
        }
    };
    for RunPart { file, goodness } in &assessed.goodness.runs {
        let [ratio, error] = goodness.y_over_x;
        let [turn, turn_error] = goodness.turn_rad.map(f64::to_degrees);
        let [along, across] = goodness.drift_m_per_s.map(|speed| 1e3 * speed);
        let lengths = goodness.scale.map_or_else(
            || "–".to_owned(),
            |[scale, error]| format!("{scale:.4} ± {error:.4}"),
        );
        table.line([
            file.clone(),
            there(ratio, format!("{ratio:+.4} ± {error:.4}")),
            chance(goodness.y_chance),
            there(turn, format!("{turn:+.3} ± {turn_error:.3}°")),
            chance(goodness.turn_chance),
            there(along + across, format!("{along:+.4}, {across:+.4} mm/s")),
            lengths,
        ]);
    }
    let chi2 = |value: Option<f64>| value.map_or_else(|| "–".to_owned(), quantity::small);
    let mut notes = vec![format!(
        "reduced χ² by the cycles' own scatter {} ({} degrees of freedom), with systematics {}; chance is that of a Y and a net turn \
         so far from the model's by scatter alone (a symmetric gait has neither with ideal servos; a dead band turns its way, so \
         that it has Y); lengths are X and ΔY over those predicted from the other runs",
        chi2(assessed.reduced_chi2),
        assessed.goodness.freedom,
        chi2(assessed.goodness.reduced_chi2_with_systematics)
    )];
    for test in &assessed.goodness.signs {
        let signs = test
            .signs
            .iter()
            .map(|sign| if *sign > 0 { '+' } else { '−' });
        notes.push(format!(
            "signs of simulated − measured {} from the smallest gait to the largest: {} ({} stretches, chance {:.2})",
            test.quantity,
            signs.collect::<String>(),
            test.stretches,
            test.chance
        ));
    }
    for common in &assessed.goodness.common {
        let of = |value: f64| {
            if common.quantity == "Y/X" {
                format!("{value:+.4}")
            } else {
                format!("{:+.3}°", value.to_degrees())
            }
        };
        notes.push(format!(
            "{} beyond the model with systematics, mean of the runs: {} ± {} (chance {})",
            common.quantity,
            of(common.mean),
            of(common.error).trim_start_matches('+'),
            chance(common.chance)
        ));
    }
    for repeats in &assessed.goodness.repeats {
        let RepeatsPart { files, repeats } = repeats;
        let of = |[mean, sd]: [f64; 2]| format!("{:.3} ± {:.3} mm", 1e3 * mean, 1e3 * sd);
        let [turn, turn_sd] = repeats.delta_theta_rad.map(f64::to_degrees);
        notes.push(format!(
            "{} repeat {}, and their mean counts as one run: X {}, ΔY {}, Δθ {turn:.3} ± {turn_sd:.3}° from repeat to repeat \
             (chance by the cycles' scatter {})",
            files.join(", "),
            repeats.gait,
            of(repeats.x_m),
            of(repeats.delta_y_m),
            chance(repeats.chance)
        ));
    }
    ResultTable {
        title: "How well the model explains the runs",
        table,
        notes,
    }
}

/// A change as people read it: mm, degrees, or a share in per cent.
fn change(unit: &str, by: f64) -> String {
    match unit {
        "m" => format!("{:.2} mm", 1e3 * by),
        "rad" => format!("{:.2}°", by.to_degrees()),
        "s" => format!("{:.0} ms", 1e3 * by),
        _ => format!("{:.2} %", 100.0 * by),
    }
}

fn known(systematics: &SystematicsPart) -> ResultTable {
    let mut table = Table::new(["nuisance parameter", "known", "±", "found", "±", "pull"]);
    for nuisance in &systematics.parameters {
        let of = |value: f64| readable(nuisance.unit, value);
        let ([known, width], [found, deviation]) = (nuisance.known, nuisance.found);
        table.line([
            nuisance.name.to_owned(),
            of(known),
            format!(
                "{}{}",
                of(width),
                if nuisance.stated { "" } else { " (usual)" }
            ),
            of(found),
            of(deviation),
            format!("{:+.1}", nuisance.pull),
        ]);
    }
    ResultTable {
        title: "Nuisance parameters: known and fitted values",
        table,
        notes: vec![
            "pull: deviation of the runs alone from the known value, in standard deviations"
                .to_owned(),
        ],
    }
}
