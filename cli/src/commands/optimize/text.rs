//! Common parts of the texts: a quarter, arcs, a closed curve, and the end of an output.

use gait_optimizer::Arc;
use operations::optimize::{ClosedCurve, GaitOutput, Quarter, STARTS};

use crate::quantity::{self, Rows};

/// Title and rows of an output.
pub(super) fn titled(title: &str, rows: &Rows) -> String {
    format!("{title}\n{rows}")
}

/// Adds displacement and arcs of a gait with the paper's symmetries, from its quarter.
pub(super) fn add_quarter(rows: &mut Rows, quarter: &Quarter) {
    rows.row(
        "displacement X",
        format!(
            "{} per cycle   X/L = {:.10}",
            quantity::length(quarter.displacement_m),
            quarter.displacement_over_length
        ),
    );
    if quarter.clockwise == Some(true) {
        rows.row(
            "runs",
            "clockwise; below, the quarter that is run counter-clockwise",
        );
    }
    rows.row(
        "starts at",
        format!("φ₁ = φ₂ = {}", quantity::angle(quarter.start_angle_rad)),
    )
    .row(
        "quarter ends at",
        format!("φ₂ = −φ₁ = {}", quantity::angle(quarter.end_angle_rad)),
    );
    add_arcs(rows, &quarter.arcs);
}

/// Adds arcs in order, each with its ends.
pub(super) fn add_arcs(rows: &mut Rows, arcs: &[Arc]) {
    for arc in arcs {
        let shape =
            |[one, two]: [f64; 2]| format!("({}, {})", quantity::angle(one), quantity::angle(two));
        rows.row(
            format!("{} arc", arc.kind.word()),
            format!("{} to {}", shape(arc.from), shape(arc.to)),
        );
    }
}

/// Adds displacement, arcs and class of a gait without the paper's symmetries.
pub(super) fn add_closed(rows: &mut Rows, curve: &ClosedCurve) {
    rows.row(
        "displacement",
        format!(
            "|d|/L = {:.10}   X/L = {:.10}   Y/L = {:.10}",
            curve.distance_over_length, curve.displacement_over_length, curve.lateral_over_length
        ),
    )
    .row("net rotation", quantity::angle(curve.rotation));
    add_arcs(rows, &curve.arcs);
    rows.row(
        "best of",
        format!(
            "{} certified closed curves from {STARTS} starts: the side links differ, so no gait has the paper's symmetries; \
             `swimmer atlas --objective {}` lists them all",
            curve.count, curve.objective
        ),
    );
}

/// Adds crossing links, timing, certificate and file.
pub(super) fn add_gait(rows: &mut Rows, gait: &GaitOutput) {
    if let Some(timing) = &gait.timing {
        super::timing::add(rows, timing);
    }
    let checks = gait.certificate.checks().len();
    let verdict = if gait.certificate.pass() {
        "hold"
    } else {
        "do not all hold"
    };
    rows.row("links cross", quantity::crossing(gait.links_cross))
        .row("certificate", format!("{checks} conditions {verdict}"));
    if let Some(path) = &gait.gait {
        rows.row("written to", path.display().to_string());
    }
}
