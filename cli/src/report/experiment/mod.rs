//! The report of an unattended experiment: measured against predicted gaits, optima against their neighbours.

use askama::Template;
use experiment::unattended::{Better, Comparison, GaitSummary, Measure, Plan};

use super::chart::{Chart, MEASURED, PREDICTED, Series};
use super::written;
use crate::failure::Outcome;

/// Height of a figure, and width of a gait in it \[px\].
const HEIGHT: i32 = 380;
const PER_GAIT: i32 = 76;
const LEAST_WIDTH: i32 = 520;

#[derive(Template)]
#[template(path = "report/experiment/page.html")]
struct Page<'a> {
    plan: &'a Plan,
    plan_sha256: String,
    swimmer: &'a str,
    of: &'a Comparison,
    /// Fit of an adaptive campaign, in words.
    fit: Option<String>,
    displacement: String,
    speed: String,
    ratio: String,
}

/// Builds the page; the same comparison gives the same bytes.
///
/// # Errors
/// As the drawing of a chart.
pub(crate) fn page(
    plan: &Plan,
    swimmer: &str,
    of: &Comparison,
    fit: Option<String>,
) -> Outcome<String> {
    written(&Page {
        plan,
        plan_sha256: plan.sha256(),
        swimmer,
        of,
        fit,
        displacement: chart(of, "X [mm per cycle]", |_| 1e3)?,
        speed: chart(of, "speed [mm/s]", |gait| 1e3 / gait.period_s)?,
        ratio: ratios(of)?,
    })
}

/// Mean and interval of every gait, with its prediction, both times a factor of the gait.
fn chart(of: &Comparison, label: &str, unit: impl Fn(&GaitSummary) -> f64) -> Outcome<String> {
    let places = || (1..).map(f64::from).zip(&of.gaits);
    let predicted = places().map(|(x, gait)| (x, gait.predicted_m * unit(gait)));
    let measured = places().filter_map(|(x, gait)| {
        let half = gait.interval_m.unwrap_or(0.0);
        Some((x, gait.measured_m? * unit(gait), half * unit(gait)))
    });
    drawn(
        of,
        label,
        vec![
            Series::Dots {
                points: predicted.collect(),
                color: PREDICTED,
                radius: 6.0,
            },
            Series::Bars {
                points: measured.collect(),
                color: MEASURED,
            },
        ],
    )
}

/// Measured over predicted displacement.
fn ratios(of: &Comparison) -> Outcome<String> {
    let places = (1..).map(f64::from).zip(&of.gaits);
    let ratios = places.filter_map(|(x, gait)| {
        let share = 100.0 / gait.predicted_m;
        let half = gait.interval_m.unwrap_or(0.0);
        let ratio = (gait.measured_m? - gait.predicted_m) * share;
        ratio.is_finite().then_some((x, ratio, half * share))
    });
    let line = [0.5, of.gaits.len() as f64 + 0.5].map(|x| (x, 0.0));
    drawn(
        of,
        "measured − predicted [%]",
        vec![
            Series::Line {
                points: line.to_vec(),
                color: PREDICTED,
                width: 1.5,
            },
            Series::Bars {
                points: ratios.collect(),
                color: MEASURED,
            },
        ],
    )
}

fn drawn(of: &Comparison, label: &str, mut series: Vec<Series>) -> Outcome<String> {
    let names = of.gaits.iter().map(|gait| gait.gait.clone());
    series.push(Series::Names(names.collect()));
    let count = i32::try_from(of.gaits.len()).unwrap_or(i32::MAX / 1000);
    Chart {
        title: String::new(),
        x_label: "gait".to_owned(),
        y_label: label.to_owned(),
        size: ((count * PER_GAIT).clamp(LEAST_WIDTH, 4000), HEIGHT),
        equal_axes: false,
        series,
        legend: Vec::new(),
    }
    .svg()
}

impl Page<'_> {
    fn percent(&self) -> String {
        format!("{:.0}", self.of.level * 100.0)
    }
}

fn mm(metres: Option<f64>) -> String {
    metres.map_or_else(
        || "–".to_owned(),
        |metres| format!("{:.3}", metres * 1e3).replace('-', "−"),
    )
}

fn deviation(gait: &GaitSummary) -> String {
    gait.measured_m.map_or_else(
        || "–".to_owned(),
        |measured| {
            let percent = 100.0 * (measured / gait.predicted_m - 1.0);
            format!("{percent:+.2} %").replace('-', "−")
        },
    )
}

fn degrees(radians: Option<f64>) -> String {
    radians.map_or_else(
        || "–".to_owned(),
        |radians| format!("{:.3}", radians.to_degrees()).replace('-', "−"),
    )
}

fn difference(one: &Better) -> String {
    match one.measure {
        Measure::Displacement => format!("{} mm per cycle", mm(one.difference_m)),
        Measure::Speed => format!("{} mm/s", mm(one.difference_m_per_s)),
    }
}

fn p(value: Option<f64>) -> String {
    value.map_or_else(
        || "–".to_owned(),
        |p| {
            if p < 1e-4 {
                format!("{p:.1e}").replace('-', "−")
            } else {
                format!("{p:.4}")
            }
        },
    )
}
