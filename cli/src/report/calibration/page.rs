//! The report of a calibration as one self-contained HTML page.

use std::fmt::Write;

use calibrate::evidence::Pair;

use super::figures::{self, Coordinate};
use super::{Calibration, model_circles};
use crate::commands::calibrate::{AssessmentAnswer, JointsAnswer, Shown};
use crate::failure::Outcome;
use crate::quantity;
use crate::report::figures as circles;
use crate::report::page::{END, escaped, figure, figure_pair, head, minus};
use crate::report::style::subscripts;

/// Builds the whole page; the same calibration gives the same bytes.
///
/// # Errors
/// As the drawing of a chart.
pub(crate) fn page(calibration: &Calibration<'_>) -> Outcome<String> {
    let mut html = head(&format!("Calibration of {}", calibration.start().name));
    heading(&mut html, calibration);
    verdict(&mut html, calibration);
    parameters(&mut html, calibration)?;
    warnings(&mut html, calibration);
    assessed(&mut html, calibration);
    html.push_str("<section class=grid>");
    over_amplitude(&mut html, calibration)?;
    evidence(&mut html, calibration)?;
    html.push_str("</section>");
    beyond(&mut html, calibration);
    runs(&mut html, calibration);
    left_out(&mut html, calibration);
    each_run(&mut html, calibration)?;
    inputs(&mut html, calibration);
    html.push_str(END);
    Ok(html)
}

fn heading(html: &mut String, calibration: &Calibration<'_>) {
    let runs = &calibration.found.runs;
    let cycles: usize = runs.iter().filter_map(|run| run.cycles.count()).sum();
    let _ = write!(
        html,
        "<header><h1>Calibration of {}</h1><p>{} runs, {cycles} cycles that count. Drag fitted with <b>{}</b>; \
         the starting swimmer’s r<sub>s</sub> and χ are only where the search began.</p></header>",
        escaped(&calibration.start().name),
        runs.len(),
        escaped(&calibration.answer.c_t_form),
    );
}

/// What to do with the answer, before anything else.
fn verdict(html: &mut String, calibration: &Calibration<'_>) {
    let Some(assessment) = &calibration.answer.assessment else {
        return;
    };
    let class = assessment.verdict.replace(' ', "-");
    let _ = write!(
        html,
        "<section class='verdict {class}'><h2>Verdict: {}</h2>",
        escaped(assessment.verdict)
    );
    if assessment.reasons.is_empty() {
        html.push_str("<p class=note>Nothing speaks against it: the runs agree with the model and with what is known.</p>");
    } else {
        html.push_str("<ul>");
        for reason in &assessment.reasons {
            let _ = write!(html, "<li>{}", subscripts(&escaped(reason)));
        }
        html.push_str("</ul>");
    }
    html.push_str("</section>");
}

/// The answer four ways, as a table and as bars.
#[allow(clippy::too_many_lines)] // one table, row after row
fn parameters(html: &mut String, calibration: &Calibration<'_>) -> Outcome {
    let (fit, evidence) = (&calibration.found.fit, calibration.evidence);
    let level = fit.intervals.level * 100.0;
    let likelihood = &evidence.likelihood;
    let paper = (fit.sphere_radius, fit.chi);
    let mut ways = vec![
        ("the paper’s fit", Some(paper), &fit.intervals),
        (
            "greatest likelihood",
            Some((likelihood.estimate.sphere_radius, likelihood.estimate.chi)),
            &likelihood.intervals,
        ),
    ];
    if let Some(bootstrap) = &evidence.bootstrap {
        ways.push(("bootstrap", None, &bootstrap.intervals));
    }
    if let Some(systematics) = calibration.systematics {
        let Pair { sphere_radius, chi } = systematics.estimate;
        ways.push((
            "with systematics",
            Some((sphere_radius, chi)),
            &systematics.intervals,
        ));
    }
    let headline = calibration
        .answer
        .assessment
        .as_ref()
        .map_or("paper", |a| a.headline.by);
    let _ = write!(
        html,
        "<section class=top><div class=scroll tabindex=0><table class=fit><thead><tr><th>estimate<th>r<sub>s</sub> [mm]<th>{level:.0} %<th>χ<th>{level:.0} %\
         </tr></thead><tbody>"
    );
    let start = calibration.start().swimmer;
    let cells = |values: [f64; 3]| {
        let [value, low, high] = values;
        let digits = quantity::decimals([low, high]);
        (
            format!("{value:.digits$}"),
            format!("{low:.digits$} … {high:.digits$}"),
        )
    };
    let mut bars: [Vec<(&str, [f64; 3])>; 2] = [Vec::new(), Vec::new()];
    for (name, estimate, intervals) in ways {
        let recommended = match headline {
            "paper" => name == "the paper’s fit",
            _ => name == "with systematics",
        };
        let (radius, chi) = estimate.unwrap_or(paper);
        let radius = [
            radius,
            intervals.sphere_radius[0],
            intervals.sphere_radius[1],
        ]
        .map(|r| 1e3 * r);
        let chi = [chi, intervals.chi[0], intervals.chi[1]];
        let ((r, r_interval), (c, c_interval)) = (cells(radius), cells(chi));
        let class = if recommended { " class=main" } else { "" };
        let shown = |text: String| {
            if estimate.is_some() {
                text
            } else {
                "–".to_owned()
            }
        };
        let _ = write!(
            html,
            "<tr><th{class}>{name}{}<td{class}>{}<td>{r_interval}<td{class}>{}<td>{c_interval}</tr>",
            if recommended { " (recommended)" } else { "" },
            shown(r),
            shown(c),
        );
        let word = name
            .rsplit(' ')
            .next()
            .filter(|_| name != "the paper’s fit")
            .unwrap_or("paper");
        bars[0].push((word, radius));
        bars[1].push((word, chi));
    }
    let _ = write!(
        html,
        "<tr><th>start<td>{:.1}<td><td>{:.2}<td></tr>",
        1e3 * start.sphere_radius,
        start.chi
    );
    let [x, y, theta] = likelihood.between_runs;
    let bootstrap = evidence.bootstrap.as_ref().map_or_else(
        || "No bootstrap: fewer than five runs draw nothing worth the name.".to_owned(),
        |bootstrap| {
            format!(
                "Bootstrap: {} draws of runs and cycles, seed {}.",
                bootstrap.draws, calibration.options.seed
            )
        },
    );
    let _ = write!(
        html,
        "</tbody></table></div><p class=note>RMSE {} with the paper’s weights; correlation of r<sub>s</sub> and ln χ {}. The likelihood \
         weighs every X, ΔY and Δθ by its own error: from the run’s cycles, and from run to run {} mm, {} mm and {}°. {bootstrap} \
         All but the last interval hold random scatter only; with systematics, what is known by halves may move as far as it is known.\
         </p></section><section class=grid>",
        minus(&quantity::small(fit.rmse)),
        minus(&format!("{:.3}", fit.correlation)),
        minus(&quantity::small(x * 1e3)),
        minus(&quantity::small(y * 1e3)),
        minus(&quantity::small(theta.to_degrees())),
    );
    let [radius, chi] = bars;
    figure(
        html,
        &figures::bars(&radius, "r_s [mm]")?,
        "Sphere radius",
        "Estimates and intervals; the last one holds systematic errors too.",
    );
    figure(
        html,
        &figures::bars(&chi, "χ")?,
        "Drag ratio",
        "The same of χ.",
    );
    html.push_str("</section>");
    Ok(())
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
        let _ = write!(html, "<li>{}", subscripts(&escaped(warning)));
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
        &figures::residuals(evidence, &short_names(calibration))?,
        "What is left of each run",
        "<i class=dot style='color:#1f6fb2'></i>X <i class=dot style='color:#3a9d5d'></i>ΔY \
         <i class=dot style='color:#d35b1e'></i>Δθ; dashes at ±2.",
    );
    if !evidence.without_run.is_empty() {
        figure(
            html,
            &figures::without_run(evidence, paper, &short_names(calibration))?,
            "Without one run",
            "<i class=dot style='color:#1f6fb2'></i>the paper’s fit without that run \
             <i class=dot style='color:#d35b1e'></i>likelihood without it <i class='dot ink'></i>with all. \
             One point far from the others: the answer hangs on that run.",
        );
    }
    Ok(())
}

/// Budget, explanations and the runs' numbers: the tables that the command prints.
fn assessed(html: &mut String, calibration: &Calibration<'_>) {
    let joints = calibration.answer.joints.iter().map(JointsAnswer::shown);
    let assessment = calibration.answer.assessment.iter();
    tables(
        html,
        joints.chain(assessment.flat_map(AssessmentAnswer::shown)),
    );
}

/// What was fitted beyond `r_s` and χ.
fn beyond(html: &mut String, calibration: &Calibration<'_>) {
    tables(html, calibration.answer.beyond.shown().into_iter());
}

fn tables(html: &mut String, all: impl Iterator<Item = Shown>) {
    for shown in all {
        let _ = write!(
            html,
            "<section><h2>{}</h2><div class=scroll tabindex=0><table class=beyond>",
            escaped(shown.title)
        );
        for (index, line) in shown.table.lines().iter().enumerate() {
            // The first line and the first column are headings.
            let cells = line.iter().enumerate().map(|(column, cell)| {
                if index == 0 || column == 0 {
                    format!("<th>{}", subscripts(&escaped(cell)))
                } else {
                    format!("<td>{}", subscripts(&escaped(&minus(cell))))
                }
            });
            let cells: String = cells.collect();
            let _ = match index {
                0 => write!(html, "<thead><tr>{cells}</tr></thead><tbody>"),
                _ => write!(html, "<tr>{cells}</tr>"),
            };
        }
        let notes: Vec<String> = shown
            .notes
            .iter()
            .map(|note| subscripts(&escaped(note)))
            .collect();
        let _ = write!(
            html,
            "</tbody></table></div><p class=note>{}</p></section>",
            notes.join("<br>")
        );
    }
}

/// The runs' names without what their files end in, for axes.
fn short_names(calibration: &Calibration<'_>) -> Vec<String> {
    let stem = |name: String| {
        // Of a run that was told, the line tells it from the others.
        if let Some((file, line)) = name.rsplit_once(':') {
            let file = file.rsplit('/').next().unwrap_or(file);
            return format!("{}:{line}", file.split('.').next().unwrap_or(file));
        }
        let path = std::path::Path::new(&name);
        path.file_stem()
            .map_or(name.clone(), |stem| stem.to_string_lossy().into_owned())
    };
    names(calibration).into_iter().map(stem).collect()
}

fn names(calibration: &Calibration<'_>) -> Vec<String> {
    let runs = calibration.answer.runs.iter();
    runs.map(|run| run.file.clone()).collect()
}

fn runs(html: &mut String, calibration: &Calibration<'_>) {
    html.push_str(
        "<section><h2>The runs</h2><div class=scroll tabindex=0><table class=runs><thead><tr><th>#<th>track<th>gait<th>cycles<th>X [mm]<th>sd<th>Y [mm]\
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
            cycles
                .count()
                .map_or_else(|| "–".to_owned(), |count| count.to_string()),
            millimetres(cycles.x.mean),
            millimetres(cycles.x.sd),
            millimetres(cycles.y.mean),
            degrees(cycles.rotation.mean),
            millimetres(cycles.delta_y.mean),
            millimetres(cycles.delta_y.sd),
            degrees(cycles.delta_theta.mean),
            degrees(cycles.delta_theta.sd),
            cycles.period_s,
            if run.is_told() {
                "–"
            } else {
                run.poses.front.word()
            },
            cycles.phase.word().replace('-', " "),
        );
    }
    html.push_str("</tbody></table></div><p class=note>sd between cycles; standard errors and lag-1 correlations are in runs.csv.</p>");
    html.push_str("<ul class=diagnoses>");
    for run in &calibration.answer.runs {
        if !run.diagnoses.is_empty() {
            let _ = write!(
                html,
                "<li><b>{}</b>: {}",
                escaped(&run.file),
                escaped(&run.diagnoses.join("; "))
            );
        }
    }
    let excluded = calibration
        .answer
        .assessment
        .iter()
        .flat_map(|a| &a.excluded);
    for run in excluded {
        let _ = write!(
            html,
            "<li class=excluded><b>{}</b> is not fitted: {}",
            escaped(&run.file),
            escaped(&run.reason)
        );
    }
    html.push_str("</ul></section>");
}

fn left_out(html: &mut String, calibration: &Calibration<'_>) {
    html.push_str(
        "<section><h2>Cycles and samples that do not count</h2><div class=scroll tabindex=0><table class=left><thead><tr><th>track<th>cycle at [s]<th>why\
         <th>frames<th>filled<th>smoothed<th>beside long gaps</tr></thead><tbody>",
    );
    let tracked = calibration.answer.runs.iter().zip(&calibration.found.runs);
    for (answer, run) in tracked.filter(|(_, run)| !run.is_told()) {
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
        "</tbody></table></div><p class=note>Gaps of 0.1 s at most are filled by a cubic, which also stands for the three samples on either side; beside longer gaps these are drawn, never used.</p></section>",
    );
}

fn each_run(html: &mut String, calibration: &Calibration<'_>) -> Outcome {
    html.push_str("<section><h2>Tracks and cycles</h2><p class=note>Left: the centre of the middle link, \
         <i class=dot style='color:#1d242c'></i>where cycles begin, <i class=dot style='color:#d35b1e'></i>filled, \
         <i class=dot style='color:#c0396b'></i>names exchanged, set right, <i class=dot style='color:#e0b030'></i>a ghost about, \
         <i class=dot style='color:#d8b9e6'></i>where the frame jumped. \
         Middle and right: all cycles over one another, seen from each one’s first pose, and their mean harmonic curve.</p>");
    for (index, (answer, run)) in calibration
        .answer
        .runs
        .iter()
        .zip(&calibration.found.runs)
        .enumerate()
        .filter(|(_, (_, run))| !run.is_told())
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
    for excluded in &calibration.found.excluded {
        if let Some(run) = &excluded.result {
            let _ = write!(
                html,
                "<figure class='run excluded'><h2>{} · not fitted</h2><div>{}{}{}</div></figure>",
                escaped(
                    &excluded
                        .file
                        .file_name()
                        .unwrap_or_default()
                        .to_string_lossy()
                ),
                figures::track(run)?,
                figures::cycles(run, Coordinate::Y)?,
                figures::cycles(run, Coordinate::Theta)?,
            );
        }
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
            subscripts(&escaped(what))
        );
    }
    html.push_str("</table></figure></section>");
}
