//! The report of a calibration as one self-contained HTML page.

use std::fmt::Write;

use calibrate::Intervals;

use super::figures::{self, Coordinate};
use super::{Calibration, model_circles};
use crate::failure::Outcome;
use crate::quantity;
use crate::report::figures as circles;
use crate::report::page::{END, escaped, figure, figure_pair, head, minus};

/// Builds the whole page; the same calibration gives the same bytes.
///
/// # Errors
/// As the drawing of a chart.
pub(crate) fn page(calibration: &Calibration<'_>) -> Outcome<String> {
    let mut html = head(&format!("Calibration of {}", calibration.start().name));
    heading(&mut html, calibration);
    parameters(&mut html, calibration);
    warnings(&mut html, calibration);
    html.push_str("<section class=grid>");
    over_amplitude(&mut html, calibration)?;
    evidence(&mut html, calibration)?;
    html.push_str("</section>");
    asked(&mut html, calibration);
    runs(&mut html, calibration);
    left_out(&mut html, calibration);
    each_run(&mut html, calibration)?;
    inputs(&mut html, calibration);
    html.push_str(END);
    Ok(html)
}

fn heading(html: &mut String, calibration: &Calibration<'_>) {
    let runs = &calibration.found.runs;
    let cycles: usize = runs.iter().map(|run| run.cycles.cycles.len()).sum();
    let _ = write!(
        html,
        "<header><h1>Calibration of {}</h1><p>{} runs, {cycles} cycles that count. Drag fitted with <b>{}</b>; \
         the starting swimmer’s r<sub>s</sub> and χ are only where the search began.</p></header>",
        escaped(&calibration.start().name),
        runs.len(),
        escaped(&calibration.answer.c_t_form),
    );
}

fn parameters(html: &mut String, calibration: &Calibration<'_>) {
    let (fit, evidence) = (&calibration.found.fit, calibration.evidence);
    let percent = fit.intervals.level * 100.0;
    let _ = write!(
        html,
        "<section class=top><table class=fit><thead><tr><th>parameter<th>start<th>the paper’s fit<th>{percent:.0} %\
         <th>greatest likelihood<th>{percent:.0} % by profile<th>{percent:.0} % by bootstrap</tr></thead><tbody>"
    );
    let start = calibration.start().swimmer;
    let likelihood = &evidence.likelihood;
    let mut row = |name: &str, unit: f64, values: [f64; 3], ends: fn(&Intervals) -> [f64; 2]| {
        let digits = digits(ends(&fit.intervals).map(|end| end * unit));
        let between = |intervals: &Intervals| {
            let [low, high] = ends(intervals).map(|end| end * unit);
            format!("{low:.digits$} … {high:.digits$}")
        };
        let [start, paper, likely] = values.map(|value| value * unit);
        let _ = write!(
            html,
            "<tr><th>{name}<td>{start:.digits$}<td class=main>{paper:.digits$}<td>{}<td class=main>{likely:.digits$}<td>{}<td>{}</tr>",
            between(&fit.intervals),
            between(&likelihood.intervals),
            between(&evidence.bootstrap.intervals),
        );
    };
    row(
        "r<sub>s</sub> [mm]",
        1e3,
        [
            start.sphere_radius,
            fit.sphere_radius,
            likelihood.estimate.sphere_radius,
        ],
        |intervals| intervals.sphere_radius,
    );
    row(
        "χ",
        1.0,
        [start.chi, fit.chi, likelihood.estimate.chi],
        |intervals| intervals.chi,
    );
    let [x, y, theta] = likelihood.between_runs;
    let _ = write!(
        html,
        "</tbody></table><p class=note>RMSE {} with the paper’s weights; correlation of r<sub>s</sub> and ln χ {}. The likelihood \
         weighs every X, ΔY and Δθ by its own error: from the run’s cycles, and from run to run {} mm, {} mm and {}°. \
         Bootstrap: {} draws of {}, seed {}.</p></section>",
        minus(&quantity::small(fit.rmse)),
        minus(&format!("{:.3}", fit.correlation)),
        minus(&quantity::small(x * 1e3)),
        minus(&quantity::small(y * 1e3)),
        minus(&quantity::small(theta.to_degrees())),
        evidence.bootstrap.draws,
        if evidence.bootstrap.runs_drawn {
            "runs and cycles"
        } else {
            "cycles"
        },
        calibration.options.seed,
    );
}

/// Decimals that show an interval's width to two digits.
fn digits([low, high]: [f64; 2]) -> usize {
    let width = high - low;
    if !(width.is_finite() && width > 0.0) {
        return 4;
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // between 1 and 9
    let digits = (1.0 - width.log10().floor()).clamp(1.0, 9.0) as usize;
    digits
}

fn warnings(html: &mut String, calibration: &Calibration<'_>) {
    let names = names(calibration);
    let outliers = calibration.evidence.outliers.iter().map(|outlier| {
        format!(
            "{}: {} stands out by {} standard errors and is left out of the likelihood, not of the paper’s fit",
            names.get(outlier.run).map_or("", |name| name),
            outlier.quantity,
            minus(&format!("{:.1}", outlier.standard_errors))
        )
    });
    let all: Vec<String> = calibration
        .answer
        .warnings
        .iter()
        .cloned()
        .chain(outliers)
        .collect();
    if all.is_empty() {
        return;
    }
    html.push_str("<section class=warnings><h2>What to know</h2><ul>");
    for warning in &all {
        let _ = write!(html, "<li>{}", escaped(warning));
    }
    html.push_str("</ul></section>");
}

fn over_amplitude(html: &mut String, calibration: &Calibration<'_>) -> Outcome {
    let measured = calibration.circles();
    if measured.is_empty() {
        return Ok(());
    }
    let fitted = model_circles(&calibration.evidence.fitted_curve);
    let start = model_circles(&calibration.evidence.start_curve);
    figure(
        html,
        &circles::displacement(&measured, &fitted, &start)?,
        "Displacement of circles",
        "<i class=dot style='color:#1f6fb2'></i>measured, mean ± sd over cycles \
         <i class=ink></i>fitted model <i style='color:#3a9d5d'></i>model the fit started from",
    );
    figure_pair(
        html,
        [
            &circles::delta_y(&measured, &fitted, &start)?,
            &circles::delta_theta(&measured, &fitted, &start)?,
        ],
        "Sway and yaw of circles",
        "Half of maximum − minimum of a cycle’s harmonic curve; colours as on the left.",
    );
    Ok(())
}

fn evidence(html: &mut String, calibration: &Calibration<'_>) -> Outcome {
    let evidence = calibration.evidence;
    let fit = &calibration.found.fit;
    let paper = (fit.sphere_radius, fit.chi);
    figure(
        html,
        &figures::ridge(evidence, paper)?,
        "The ridge between both parameters",
        "<i style='color:#1f6fb2'></i>joint regions by likelihood <i class=dot style='color:#d35b1e'></i>greatest likelihood \
         <i class='dot ink'></i>the paper’s fit <i class=dot style='color:#c3cdd6'></i>its bootstrap",
    );
    let [radius, chi] = &evidence.profiles;
    figure_pair(
        html,
        [
            &figures::profile(radius, "sphere radius r_s [mm]", 1e3)?,
            &figures::profile(chi, "drag ratio χ", 1.0)?,
        ],
        "Profile likelihoods",
        &format!(
            "The other parameter set free at each value. <i class=dot style='color:#d35b1e'></i>{:.0} % interval, where the curve \
             meets Student’s threshold for {:.1} degrees of freedom",
            fit.intervals.level * 100.0,
            radius.freedom
        ),
    );
    figure(
        html,
        &figures::residuals(evidence)?,
        "What is left of each run",
        "<i class=dot style='color:#1f6fb2'></i>X <i class=dot style='color:#3a9d5d'></i>ΔY \
         <i class=dot style='color:#d35b1e'></i>Δθ; dashes at ±2. Runs are numbered as in the table below.",
    );
    if !evidence.without_run.is_empty() {
        figure(
            html,
            &figures::without_run(evidence, paper)?,
            "Without one run",
            "<i class=dot style='color:#1f6fb2'></i>the paper’s fit without the run of that number \
             <i class=dot style='color:#d35b1e'></i>likelihood without it <i class='dot ink'></i>with all. \
             One point far from the others: the answer hangs on that run.",
        );
    }
    Ok(())
}

/// What was asked beyond the fit: the tables that the command prints.
fn asked(html: &mut String, calibration: &Calibration<'_>) {
    for shown in calibration.answer.asked.shown() {
        let _ = write!(
            html,
            "<section><h2>{}</h2><table class=asked>",
            escaped(shown.title)
        );
        for (index, line) in shown.table.lines().iter().enumerate() {
            // The first line and the first column are headings.
            let cells = line.iter().enumerate().map(|(column, cell)| {
                if index == 0 || column == 0 {
                    format!("<th>{}", escaped(cell))
                } else {
                    format!("<td>{}", escaped(&minus(cell)))
                }
            });
            let cells: String = cells.collect();
            let _ = match index {
                0 => write!(html, "<thead><tr>{cells}</tr></thead><tbody>"),
                _ => write!(html, "<tr>{cells}</tr>"),
            };
        }
        let notes: Vec<String> = shown.notes.iter().map(|note| escaped(note)).collect();
        let _ = write!(
            html,
            "</tbody></table><p class=note>{}</p></section>",
            notes.join("<br>")
        );
    }
}

fn names(calibration: &Calibration<'_>) -> Vec<String> {
    let runs = calibration.answer.runs.iter();
    runs.map(|run| run.file.clone()).collect()
}

fn runs(html: &mut String, calibration: &Calibration<'_>) {
    html.push_str(
        "<section><h2>The runs</h2><table class=runs><thead><tr><th>#<th>track<th>gait<th>cycles<th>X [mm]<th>sd<th>Y [mm]\
         <th>turn [°]<th>ΔY [mm]<th>sd<th>Δθ [°]<th>sd<th>period [s]<th>front by<th>phase by</tr></thead><tbody>",
    );
    for (index, (answer, run)) in calibration
        .answer
        .runs
        .iter()
        .zip(&calibration.found.runs)
        .enumerate()
    {
        let cycles = &run.cycles;
        // Adding zero turns a rounded -0.000 into 0.000.
        let three = |value: f64| match value {
            // Of a single cycle there is no deviation.
            none if none.is_nan() => "–".to_owned(),
            value => minus(&format!("{:.3}", (value * 1e3).round() / 1e3 + 0.0)),
        };
        let millimetres = |metres: f64| three(metres * 1e3);
        let degrees = |radians: f64| three(radians.to_degrees());
        let _ = write!(
            html,
            "<tr><th>{}<td class=name>{}<td class=name>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{}<td>{:.3}<td>{}<td>{}</tr>",
            index + 1,
            escaped(&answer.file),
            escaped(&answer.gait),
            cycles.cycles.len(),
            millimetres(cycles.x.mean),
            millimetres(cycles.x.sd),
            millimetres(cycles.y.mean),
            degrees(cycles.rotation.mean),
            millimetres(cycles.delta_y.mean),
            millimetres(cycles.delta_y.sd),
            degrees(cycles.delta_theta.mean),
            degrees(cycles.delta_theta.sd),
            cycles.period_s,
            run.poses.front.word(),
            cycles.phase.word().replace('-', " "),
        );
    }
    html.push_str("</tbody></table><p class=note>sd between cycles; standard errors and lag-1 correlations are in runs.csv.</p></section>");
}

fn left_out(html: &mut String, calibration: &Calibration<'_>) {
    html.push_str(
        "<section><h2>Cycles and samples that do not count</h2><table class=left><thead><tr><th>track<th>cycle at [s]<th>why\
         <th>frames<th>filled<th>smoothed<th>beside long gaps</tr></thead><tbody>",
    );
    for (answer, run) in calibration.answer.runs.iter().zip(&calibration.found.runs) {
        let listed = &run.cycles.left_out;
        let _ = write!(html, "<tr><th>{}", escaped(&answer.file));
        let times: Vec<String> = listed.iter().map(|(at, _)| format!("{at:.2}")).collect();
        let reasons: Vec<String> = listed
            .iter()
            .map(|(_, why)| escaped(&why.to_string()))
            .collect();
        let _ = write!(
            html,
            "<td>{}<td class=name>{}<td>{}<td>{}<td>{}<td>{}</tr>",
            times.join("<br>"),
            reasons.join("<br>"),
            answer.samples.frames,
            answer.samples.filled,
            answer.samples.smoothed,
            answer.samples.tails,
        );
    }
    html.push_str(
        "</tbody></table><p class=note>Gaps of 0.1 s at most are filled by a cubic, which also stands for the three samples on either side; beside longer gaps these are drawn, never used.</p></section>",
    );
}

fn each_run(html: &mut String, calibration: &Calibration<'_>) -> Outcome {
    html.push_str("<section><h2>Tracks and cycles</h2><p class=note>Left: the centre of the middle link, \
         <i class=dot style='color:#1d242c'></i>where cycles begin, <i class=dot style='color:#d35b1e'></i>filled. \
         Middle and right: all cycles over one another, seen from each one’s first pose, and their mean harmonic curve.</p>");
    for (index, (answer, run)) in calibration
        .answer
        .runs
        .iter()
        .zip(&calibration.found.runs)
        .enumerate()
    {
        let _ = write!(
            html,
            "<figure class=run><h2>{} · {} · {}</h2><div>{}{}{}</div></figure>",
            index + 1,
            escaped(&answer.file),
            escaped(&answer.gait),
            figures::track(run)?,
            figures::cycles(run, Coordinate::Y)?,
            figures::cycles(run, Coordinate::Theta)?,
        );
    }
    html.push_str("</section>");
    Ok(())
}

fn inputs(html: &mut String, calibration: &Calibration<'_>) {
    let _ = write!(
        html,
        "<section class=grid><figure class=files><h2>What it was made from</h2><table><tr><th>made by<td>{}</tr>",
        escaped(&calibration.provenance.made_by)
    );
    for input in &calibration.provenance.inputs {
        let _ = write!(
            html,
            "<tr><th><code>{}</code><td><code class=hash>{}</code></tr>",
            escaped(&input.file),
            input.sha256
        );
    }
    html.push_str("</table></figure><figure class=files><h2>In this folder</h2><table>");
    for (name, what) in &calibration.files {
        let _ = write!(
            html,
            "<tr><th><code>{name}</code><td>{}</tr>",
            escaped(what)
        );
    }
    html.push_str("</table></figure></section>");
}

#[cfg(test)]
mod tests {
    use super::digits;

    #[test]
    fn intervals_are_told_apart() {
        // 69.177 … 69.209, 3.5960 … 3.5989, 60 … 75.
        assert_eq!(digits([69.177, 69.209]), 3);
        assert_eq!(digits([3.5960, 3.5989]), 4);
        assert_eq!(digits([60.0, 75.0]), 1);
        assert_eq!(digits([1.0, 1.0]), 4);
    }
}
