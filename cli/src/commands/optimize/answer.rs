//! What the answers of all objectives share: arcs, certificate and the lines that people read.

use std::path::PathBuf;

use gait_optimizer::Certificate;
use serde::Serialize;

use crate::quantity::{self, Rows};

/// One arc of a gait.
#[derive(Debug, Serialize)]
pub(crate) struct Arc {
    kind: &'static str,
    from: [f64; 2],
    to: [f64; 2],
}

impl From<&gait_optimizer::Arc> for Arc {
    fn from(arc: &gait_optimizer::Arc) -> Self {
        Self {
            kind: arc.kind.word(),
            from: arc.from,
            to: arc.to,
        }
    }
}

/// The necessary conditions, each with its number.
#[derive(Debug, Serialize)]
pub(crate) struct Evidence {
    pass: bool,
    checks: Vec<Check>,
}

#[derive(Debug, Serialize)]
struct Check {
    name: &'static str,
    value: f64,
    tolerance: f64,
    pass: bool,
}

impl From<&Certificate> for Evidence {
    fn from(certificate: &Certificate) -> Self {
        let check = |check: &gait_optimizer::Check| Check {
            name: check.name,
            value: check.value,
            tolerance: check.tolerance,
            pass: check.pass,
        };
        Self {
            pass: certificate.pass(),
            checks: certificate.checks().iter().map(check).collect(),
        }
    }
}

/// X with its unit and over L.
pub(crate) fn displacement_row(rows: &mut Rows, metres: f64, over_length: f64) {
    let displacement = quantity::length(metres);
    rows.row(
        "displacement X",
        format!("{displacement} per cycle   X/L = {over_length:.10}"),
    );
}

/// Where the quarter of a doubly symmetric gait starts and ends, and its arcs.
pub(crate) fn quarter_rows(rows: &mut Rows, start_angle: f64, end_angle: f64, arcs: &[Arc]) {
    rows.row(
        "starts at",
        format!("φ₁ = φ₂ = {}", quantity::angle(start_angle)),
    )
    .row(
        "quarter ends at",
        format!("φ₂ = −φ₁ = {}", quantity::angle(end_angle)),
    );
    arc_rows(rows, arcs);
}

/// Arcs in order, each with its ends.
pub(crate) fn arc_rows(rows: &mut Rows, arcs: &[Arc]) {
    for arc in arcs {
        let shape =
            |[one, two]: [f64; 2]| format!("({}, {})", quantity::angle(one), quantity::angle(two));
        rows.row(
            format!("{} arc", arc.kind),
            format!("{} to {}", shape(arc.from), shape(arc.to)),
        );
    }
}

/// Crossing links, the certificate's verdict and the file written.
pub(crate) fn closing_rows(
    rows: &mut Rows,
    links_cross: f64,
    certificate: &Evidence,
    file: Option<&PathBuf>,
) {
    rows.row("links cross", quantity::crossing(links_cross));
    let checks = certificate.checks.len();
    let verdict = if certificate.pass {
        "hold"
    } else {
        "do not all hold"
    };
    rows.row("certificate", format!("{checks} conditions {verdict}"));
    if let Some(path) = file {
        rows.row("written to", path.display().to_string());
    }
}
