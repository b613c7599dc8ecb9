//! The report as one self-contained HTML page: what its template, `page.html`, cannot say.

use askama::Template;

use super::swimming::snapshots;
use super::{Parameter, Report, figures, markup};
use crate::failure::{Failure, Outcome};
use crate::picture_file::FigureWidth;
use crate::quantity;

#[derive(Template)]
#[template(path = "report/page.html")]
struct Page<'a> {
    report: &'a Report,
    swimming: String,
    displacement: String,
    sway: String,
    yaw: String,
    track: String,
    x_over_time: String,
    heading_over_time: String,
    gait: String,
    prediction: String,
}

/// Builds the whole page; the same report gives the same bytes.
///
/// # Errors
/// Errors of the drawing.
pub(crate) fn page(report: &Report) -> Outcome<String> {
    let (circles, fitted, start) = (&report.circles, &report.fitted_curve, &report.start_curve);
    written(&Page {
        report,
        swimming: snapshots(&report.swimming, FigureWidth::Page),
        displacement: figures::displacement(circles, fitted, start)?,
        sway: figures::delta_y(circles, fitted, start)?,
        yaw: figures::delta_theta(circles, fitted, start)?,
        track: figures::track(&report.track)?,
        x_over_time: figures::x_over_time(&report.track)?,
        heading_over_time: figures::heading_over_time(&report.track)?,
        gait: figures::gait(&report.gait)?,
        prediction: figures::prediction(report)?,
    })
}

/// The text of a filled in template.
///
/// # Errors
/// Errors of the formatting.
pub(crate) fn written(page: &impl Template) -> Outcome<String> {
    page.render()
        .map_err(|error| Failure::Tried(format!("cannot write the page: {error}")))
}

impl Page<'_> {
    fn prediction_less_track(&self) -> String {
        let (predicted, (tracked, _)) = (
            self.report.displacement_predicted_m,
            self.report.displacement_tracked_m,
        );
        quantity::relative(predicted, tracked).map_or_else(
            || quantity::length(predicted - tracked),
            quantity::deviation,
        )
    }
}

impl Parameter {
    fn deviation(&self) -> String {
        quantity::relative(self.fitted, self.truth).map_or_else(
            || format!("{:+.3}{}", self.fitted - self.truth, self.unit),
            quantity::deviation,
        )
    }
}

/// A length in millimetres.
fn mm(metres: f64, decimals: usize) -> String {
    markup::minus(&format!("{:.decimals$}", metres * 1e3))
}
