//! Common parts of the outputs: a quarter, arcs, and the end of an output.

use std::path::Path;

use gait_optimizer::{Arc, Condition, Method, Objective, OptimalGait};
use swimmer_files::AnyGait;

use super::timing::Timed;
use super::{SearchResult, Task};
use crate::document::Document;
use crate::own_robot::PERIOD_S;
use crate::quantity;

/// Adds displacement and arcs of a gait with the paper's symmetries, from its quarter.
pub(super) fn add_quarter(document: &mut Document, gait: &OptimalGait) {
    document
        .key("displacement_over_length", gait.displacement_over_length)
        .key("displacement_m", gait.displacement)
        .key("start_angle_rad", gait.start_angle)
        .key("end_angle_rad", gait.end_angle);
    if gait.objective == Objective::Displacement {
        document.key("clockwise", gait.is_clockwise());
    }
    document.row(
        "displacement X",
        format!(
            "{} per cycle   X/L = {:.10}",
            quantity::length(gait.displacement),
            gait.displacement_over_length
        ),
    );
    if gait.objective == Objective::Displacement && gait.is_clockwise() {
        document.row(
            "runs",
            "clockwise; below, the quarter that is run counter-clockwise",
        );
    }
    document
        .row(
            "starts at",
            format!("φ₁ = φ₂ = {}", quantity::angle(gait.start_angle)),
        )
        .row(
            "quarter ends at",
            format!("φ₂ = −φ₁ = {}", quantity::angle(gait.end_angle)),
        );
    add_arcs(document, &gait.arcs);
}

/// Adds arcs in order, each with its ends.
pub(super) fn add_arcs(document: &mut Document, arcs: &[Arc]) {
    document.key("arcs", arcs.to_vec());
    for arc in arcs {
        let shape =
            |[one, two]: [f64; 2]| format!("({}, {})", quantity::angle(one), quantity::angle(two));
        document.row(
            format!("{} arc", arc.kind.word()),
            format!("{} to {}", shape(arc.from), shape(arc.to)),
        );
    }
}

/// Adds the figures of efficiency gaits that a solver does not report; those of gaits that were optimised as Fourier series
/// first. This condition of the certificate is the residual.
pub(crate) fn add_figures(
    document: &mut Document,
    gait: &OptimalGait,
    residual: Condition,
    power_variation: impl FnOnce(&OptimalGait) -> Option<f64>,
) {
    if gait.objective == Objective::Efficiency {
        document
            .key("residual", gait.certificate.value(residual))
            .key("power_variation", power_variation(gait))
            .key("method", Method::Fourier.word());
    }
}

impl SearchResult {
    /// A gait, as it is timed: the answer ends with crossing links, timing, certificate, seconds and the file.
    pub(super) fn gait(
        mut document: Document,
        task: &Task,
        gait: &OptimalGait,
        timed: Option<Timed>,
    ) -> Self {
        document.key("links_cross", gait.links_cross);
        if let Some(timed) = &timed {
            timed.add(&mut document);
        }
        let checks = gait.certificate.checks().len();
        let verdict = if gait.certificate.pass() {
            "hold"
        } else {
            "do not all hold"
        };
        document
            .key("certificate", gait.certificate.clone())
            .key("seconds", task.seconds.get())
            .key_if("gait", task.output.map(Path::to_owned))
            .row("links cross", quantity::crossing(gait.links_cross))
            .row("certificate", format!("{checks} conditions {verdict}"));
        if let Some(path) = task.output {
            document.row("written to", path.display().to_string());
        }
        let file = timed.map_or_else(|| gait.gait_file(&task.file.name), |timed| timed.file);
        Self {
            document,
            gaits: vec![(String::new(), file)],
        }
    }
}

/// Warns if the gait is beyond the robot of the file, at its period or the default one.
pub(super) fn say_if_beyond(task: &Task, gait: &OptimalGait) {
    if let Ok(curve) = AnyGait::from_file(&gait.gait_file(&task.file.name)) {
        crate::own_robot::say_if_beyond(&task.file, &curve, PERIOD_S);
    }
}
