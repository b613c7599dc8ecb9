//! The report of a calibration as one self-contained HTML page: what its template, `page.html`, cannot say.

use askama::Template;
use calibrate::evidence::Pair;
use calibrate::{CampaignFit, Intervals, RunResult};
use operations::calibrate::RunOutput;

use super::figures::{self, Coordinate};
use super::{Calibration, model_circles};
use crate::commands::calibrate::{ResultTable, assessment, beyond_fit, joints};
use crate::failure::Outcome;
use crate::quantity;
use crate::report::figures as circles;
use crate::report::markup;
use crate::report::written;

#[derive(Template)]
#[template(path = "report/calibration/page.html")]
struct Page<'a> {
    of: &'a Calibration<'a>,
    found: &'a CampaignFit,
    ways: Vec<Way>,
    radius_bars: String,
    chi_bars: String,
    /// Displacement, sway and yaw over the amplitude, if there are circles.
    circles: Option<[String; 3]>,
    ridge: String,
    profiles: [String; 2],
    residuals: String,
    without_run: Option<String>,
    drawn_runs: Vec<DrawnRun>,
}

/// One of the ways to an estimate.
struct Way {
    name: &'static str,
    /// A bootstrap has intervals alone.
    has_estimate: bool,
    is_recommended: bool,
    /// Value, and the ends of its interval.
    radius_mm: [f64; 3],
    chi: [f64; 3],
}

struct DrawnRun {
    class: &'static str,
    title: String,
    track: String,
    sway: String,
    yaw: String,
}

/// Builds the whole page; the same calibration gives the same bytes.
///
/// # Errors
/// As the drawing of a chart.
pub(crate) fn page(calibration: &Calibration<'_>) -> Outcome<String> {
    let evidence = calibration.evidence;
    let fit = &calibration.found.fit;
    let paper = (fit.sphere_radius, fit.chi);
    let names = numbers(calibration);
    let ways = ways(calibration);
    let bars = |of: fn(&Way) -> [f64; 3], unit| {
        let bars: Vec<_> = ways.iter().map(|way| (way.word(), of(way))).collect();
        figures::bars(&bars, unit)
    };
    let [radius, chi] = &evidence.profiles;
    let without = (!evidence.without_run.is_empty())
        .then(|| figures::without_run(evidence, paper, &names))
        .transpose()?;
    written(&Page {
        of: calibration,
        found: calibration.found,
        radius_bars: bars(|way| way.radius_mm, "r_s [mm]")?,
        chi_bars: bars(|way| way.chi, "χ")?,
        circles: over_amplitude(calibration)?,
        ridge: figures::ridge(evidence, paper)?,
        profiles: [
            figures::profile(radius, "sphere radius r_s [mm]", 1e3)?,
            figures::profile(chi, "drag ratio χ", 1.0)?,
        ],
        residuals: figures::residuals(evidence, &names)?,
        without_run: without,
        drawn_runs: drawn_runs(calibration)?,
        ways,
    })
}

/// The estimates of all methods.
fn ways(calibration: &Calibration<'_>) -> Vec<Way> {
    let (fit, evidence) = (&calibration.found.fit, calibration.evidence);
    let likelihood = &evidence.likelihood;
    let paper = Pair {
        sphere_radius: fit.sphere_radius,
        chi: fit.chi,
    };
    let assessment = calibration.output.assessment.as_ref();
    let by_paper = assessment.is_none_or(|assessment| assessment.headline.by == "paper");
    let way = |name, estimate: Option<Pair>, intervals: &Intervals, is_recommended| {
        let value = estimate.unwrap_or(paper);
        let [r_low, r_high] = intervals.sphere_radius;
        let [chi_low, chi_high] = intervals.chi;
        Way {
            name,
            has_estimate: estimate.is_some(),
            is_recommended,
            radius_mm: [value.sphere_radius, r_low, r_high].map(|r| 1e3 * r),
            chi: [value.chi, chi_low, chi_high],
        }
    };
    let most_likely = Some(likelihood.estimate);
    let mut ways = vec![
        way("the paper’s fit", Some(paper), &fit.intervals, by_paper),
        way(
            "greatest likelihood",
            most_likely,
            &likelihood.intervals,
            false,
        ),
    ];
    if let Some(bootstrap) = &evidence.bootstrap {
        ways.push(way("bootstrap", None, &bootstrap.intervals, false));
    }
    if let Some(of) = calibration.systematics {
        ways.push(way(
            "with systematics",
            Some(of.estimate),
            &of.intervals,
            !by_paper,
        ));
    }
    ways
}

impl Way {
    /// Label of the bar.
    fn word(&self) -> &'static str {
        match self.name {
            "the paper’s fit" => "paper",
            name => name.rsplit(' ').next().unwrap_or(name),
        }
    }

    fn estimate(&self, [value, low, high]: &[f64; 3]) -> String {
        let digits = quantity::decimals([*low, *high]);
        if self.has_estimate {
            format!("{value:.digits$}")
        } else {
            "–".to_owned()
        }
    }
}

fn interval([_, low, high]: &[f64; 3]) -> String {
    let digits = quantity::decimals([*low, *high]);
    format!("{low:.digits$} … {high:.digits$}")
}

/// Class that highlights a recommendation.
fn main_class(is_recommended: bool) -> &'static str {
    if is_recommended { "main" } else { "" }
}

/// Three decimals; a dash for the deviation of a single cycle, which does not exist.
fn three_decimals(value: f64) -> String {
    if value.is_nan() {
        return "–".to_owned();
    }
    // Adding zero turns a rounded -0.000 into 0.000.
    markup::minus(&format!("{:.3}", (value * 1e3).round() / 1e3 + 0.0))
}

fn mm(metres: f64) -> String {
    three_decimals(metres * 1e3)
}

fn degrees(radians: f64) -> String {
    three_decimals(radians.to_degrees())
}

impl Page<'_> {
    /// Those that count.
    fn cycles(&self) -> usize {
        let runs = self.found.runs.iter();
        runs.filter_map(|run| run.cycles.count()).sum()
    }

    fn percent(&self) -> String {
        format!("{:.0}", self.found.fit.intervals.level * 100.0)
    }

    fn runs(&self) -> impl Iterator<Item = (&RunOutput, &RunResult)> {
        self.of.output.runs.iter().zip(&self.found.runs)
    }

    fn has_remarks(&self) -> bool {
        let output = self.of.output;
        let mut excluded = output.assessment.iter().flat_map(|of| &of.excluded);
        output.runs.iter().any(|run| !run.diagnoses.is_empty()) || excluded.next().is_some()
    }

    fn warnings(&self) -> Vec<String> {
        let outliers = self.of.evidence.outliers.iter().map(|outlier| {
            format!(
                "{}: {} stands out by {} standard errors and is left out of the likelihood, not of the paper’s fit",
                self.of.output.runs.get(outlier.run).map_or("", |run| &run.file),
                outlier.quantity,
                markup::minus(&format!("{:.1}", outlier.standard_errors))
            )
        });
        self.of
            .output
            .warnings
            .iter()
            .cloned()
            .chain(outliers)
            .collect()
    }

    /// Budget, explanations and the runs' numbers: the tables that the command prints.
    fn assessed(&self) -> Vec<ResultTable> {
        let joints = self.of.output.joints.iter().map(joints::table);
        let assessment = self.of.output.assessment.iter();
        joints
            .chain(assessment.flat_map(assessment::tables))
            .collect()
    }

    /// Tables of the optional computations.
    fn beyond_fit(&self) -> Vec<ResultTable> {
        beyond_fit::tables(self.of.output).collect()
    }
}

fn over_amplitude(calibration: &Calibration<'_>) -> Outcome<Option<[String; 3]>> {
    let measured = calibration.circles();
    if measured.is_empty() {
        return Ok(None);
    }
    let fitted = model_circles(&calibration.evidence.fitted_curve);
    let start = model_circles(&calibration.evidence.start_curve);
    Ok(Some([
        circles::displacement(&measured, &fitted, &start)?,
        circles::delta_y(&measured, &fitted, &start)?,
        circles::delta_theta(&measured, &fitted, &start)?,
    ]))
}

/// Numbers of the runs, as in their table: names of files would cover each other.
fn numbers(calibration: &Calibration<'_>) -> Vec<String> {
    let count = calibration.output.runs.len();
    (1..=count).map(|number| number.to_string()).collect()
}

/// Tracks and cycles of every run with a track, those that are not fitted last.
fn drawn_runs(calibration: &Calibration<'_>) -> Outcome<Vec<DrawnRun>> {
    let drawn = |class, title, run: &RunResult| -> Outcome<DrawnRun> {
        Ok(DrawnRun {
            class,
            title,
            track: figures::track(run)?,
            sway: figures::cycles(run, Coordinate::Y)?,
            yaw: figures::cycles(run, Coordinate::Theta)?,
        })
    };
    let described = calibration.output.runs.iter();
    let fitted = described
        .zip(&calibration.found.runs)
        .enumerate()
        .filter(|(_, (_, run))| !run.is_reported())
        .map(|(index, (output, run))| {
            let title = format!("{} · {} · {}", index + 1, output.file, output.gait);
            drawn("run", title, run)
        });
    let excluded = calibration.found.excluded.iter().filter_map(|excluded| {
        let name = excluded.file.file_name().unwrap_or_default();
        let title = format!("{} · not fitted", name.to_string_lossy());
        Some(drawn("run excluded", title, excluded.result.as_ref()?))
    });
    fitted.chain(excluded).collect()
}
