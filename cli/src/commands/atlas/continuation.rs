//! Gaits that are followed as a parameter changes: `--continue`, and their text.

use clap::ValueEnum;
use gait_optimizer::{ArcKind, EventKind, Fold};
use operations::atlas::continuation::Output;

use crate::quantity;

/// Gaits that have a name.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Named {
    Small,
    Large,
}

/// Gaits along the range, and the events.
pub(super) fn text(output: &Output) -> String {
    let word = output.parameter;
    let mut lines = vec![format!(
        "followed in {word} from {} to {}",
        output.from, output.to
    )];
    let branches = output.points.last().map_or(1, |point| point.branch + 1);
    for branch in 0..branches {
        lines.push(format!("  gait {}", branch + 1));
        lines.push(format!(
            "  {word:<11}  X/L            efficiency ξ     starts at   ends at     arcs"
        ));
        let points = output.points.iter().filter(|point| point.branch == branch);
        lines.extend(points.map(|point| {
            format!(
                "  {:<11.7}  {:>+.9}   {:.8e}   {:<9}   {:<9}   {}",
                point.value,
                point.displacement_over_length,
                point.efficiency,
                quantity::angle(point.start_angle_rad),
                quantity::angle(point.end_angle_rad),
                point.arcs.join(" ")
            )
        }));
    }
    lines.extend(output.events.iter().map(|event| {
        format!(
            "  gait {} at {:.7} ± {:.0e}: {}",
            event.branch + 1,
            event.value,
            event.within,
            happened(&event.kind)
        )
    }));
    lines.join("\n")
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
