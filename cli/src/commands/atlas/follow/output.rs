//! Output of a continuation.

use gait_optimizer::{ArcKind, Continuation, EventKind, Fold, Parameter, Point};

use crate::document::{Document, object};
use crate::quantity;

/// Gaits on the way of a parameter between these two values, and what happened there.
pub(super) fn followed(
    parameter: Parameter,
    [from, to]: [f64; 2],
    found: &Continuation,
) -> Document {
    let word = parameter.word();
    let mut answer = Document::new(format!("followed in {word} from {from} to {to}"));
    let points: Vec<_> = found.points.iter().map(keys).collect();
    answer
        .key("parameter", word)
        .key("from", from)
        .key("to", to)
        .key("points", points)
        .key("events", found.events.clone());
    let branches = found.points.last().map_or(1, |point| point.branch + 1);
    for branch in 0..branches {
        answer.line(format!("  gait {}", branch + 1)).line(format!(
            "  {word:<11}  X/L            efficiency ξ     starts at   ends at     arcs"
        ));
        for point in found.points.iter().filter(|point| point.branch == branch) {
            let gait = &point.gait;
            answer.line(format!(
                "  {:<11.7}  {:>+.9}   {:.8e}   {:<9}   {:<9}   {}",
                point.value,
                gait.displacement_over_length,
                gait.efficiency,
                quantity::angle(gait.start_angle),
                quantity::angle(gait.end_angle),
                arcs(point).join(" ")
            ));
        }
    }
    for event in &found.events {
        answer.line(format!(
            "  gait {} at {:.7} ± {:.0e}: {}",
            event.branch + 1,
            event.value,
            event.within,
            happened(&event.kind)
        ));
    }
    answer
}

fn arcs(point: &Point) -> Vec<&'static str> {
    point.gait.arcs.iter().map(|arc| arc.kind.word()).collect()
}

fn keys(point: &Point) -> Document {
    let gait = &point.gait;
    object! {
        // Number of the gait followed, from 0.
        "branch": point.branch,
        "value": point.value,
        "efficiency": gait.efficiency,
        "displacement_over_length": gait.displacement_over_length,
        "lateral_over_length": gait.lateral_over_length,
        "start_angle_rad": gait.start_angle,
        "end_angle_rad": gait.end_angle,
        "arcs": arcs(point),
        "residual": point.residual,
        "certified": gait.certificate.pass(),
    }
}

/// Event in words.
fn happened(kind: &EventKind) -> String {
    let arcs = |arcs: &[ArcKind]| {
        let words: Vec<_> = arcs.iter().map(|kind| kind.word()).collect();
        words.join(" ")
    };
    let power = |exponent: &Option<f64>| {
        exponent
            .map(|power| format!(" (changes with the distance to the power {power:.2})"))
            .unwrap_or_default()
    };
    match kind {
        EventKind::Structure { before, after } => {
            format!("arcs change: {} becomes {}", arcs(before), arcs(after))
        }
        EventKind::Fold(Fold { other, exponent }) => {
            let meets = other.map_or_else(String::new, |other| {
                format!(
                    ": meets another extremal (ξ {:.7e} at {:.6})",
                    other.efficiency, other.value
                )
            });
            format!("folds{meets}{}", power(exponent))
        }
        EventKind::Jump { apart, exponent } => format!(
            "the nearest gait beyond is {} away{}",
            quantity::angle(*apart),
            power(exponent)
        ),
        EventKind::Merger { with } => format!("becomes gait {}", with + 1),
        EventKind::Overtaken { by } => format!("gait {} becomes the better one", by + 1),
        EventKind::Symmetry { alone: true } => {
            "from here on curves without its symmetries are better".to_owned()
        }
        EventKind::Symmetry { alone: false } => {
            "from here on no curve without its symmetries is better".to_owned()
        }
        EventKind::Lost { failed } => format!("no optimum beyond: fails {failed}"),
        EventKind::Ended { reason, exponent } => format!("ends: {reason}{}", power(exponent)),
        EventKind::Reached => "followed to here".to_owned(),
    }
}
