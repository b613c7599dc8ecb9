//! What is told of gaits that were followed.

use std::fmt;

use gait_optimizer::{ArcKind, Continuation, Event, EventKind, Fold, Parameter};
use serde::Serialize;

use crate::quantity;

/// Gaits on the way, and what happened there.
#[derive(Debug, Serialize)]
pub(crate) struct Followed {
    parameter: &'static str,
    from: f64,
    to: f64,
    points: Vec<Point>,
    events: Vec<Event>,
    #[serde(skip)]
    branches: usize,
}

#[derive(Debug, Serialize)]
struct Point {
    /// Number of the gait followed, from 0.
    branch: usize,
    value: f64,
    efficiency: f64,
    displacement_over_length: f64,
    lateral_over_length: f64,
    start_angle_rad: f64,
    end_angle_rad: f64,
    arcs: Vec<&'static str>,
    residual: f64,
    certified: bool,
}

impl Followed {
    /// What was found of a parameter between these two values.
    pub(super) fn new(parameter: Parameter, [from, to]: [f64; 2], found: &Continuation) -> Self {
        let points: Vec<_> = found.points.iter().map(Point::new).collect();
        Self {
            parameter: parameter.word(),
            from,
            to,
            branches: points.last().map_or(1, |point| point.branch + 1),
            points,
            events: found.events.clone(),
        }
    }
}

impl Point {
    fn new(point: &gait_optimizer::Point) -> Self {
        let gait = &point.gait;
        Self {
            branch: point.branch,
            value: point.value,
            efficiency: gait.efficiency,
            displacement_over_length: gait.displacement_over_length,
            lateral_over_length: gait.lateral_over_length,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            arcs: gait.arcs.iter().map(|arc| arc.kind.word()).collect(),
            residual: point.residual,
            certified: gait.certificate.pass(),
        }
    }
}

/// What happened, in words.
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
        EventKind::Lost { failed } => format!("no optimum beyond: fails {failed}"),
        EventKind::Ended { reason, exponent } => format!("ends: {reason}{}", power(exponent)),
        EventKind::Reached => "followed to here".to_owned(),
    }
}

impl fmt::Display for Followed {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "followed in {} from {} to {}",
            self.parameter, self.from, self.to
        )?;
        for branch in 0..self.branches {
            write!(
                f,
                "\n  gait {}\n  {:<11}  X/L            efficiency ξ     starts at   ends at     arcs",
                branch + 1,
                self.parameter
            )?;
            for point in self.points.iter().filter(|point| point.branch == branch) {
                write!(
                    f,
                    "\n  {:<11.7}  {:>+.9}   {:.8e}   {:<9}   {:<9}   {}",
                    point.value,
                    point.displacement_over_length,
                    point.efficiency,
                    quantity::angle(point.start_angle_rad),
                    quantity::angle(point.end_angle_rad),
                    point.arcs.join(" ")
                )?;
            }
        }
        for event in &self.events {
            write!(
                f,
                "\n  gait {} at {:.7} ± {:.0e}: {}",
                event.branch + 1,
                event.value,
                event.within,
                happened(&event.kind)
            )?;
        }
        Ok(())
    }
}

/// Followed gaits without an atlas.
#[derive(Debug, Serialize)]
pub(crate) struct Alone {
    #[serde(skip)]
    title: String,
    continuation: Followed,
    seconds: f64,
}

impl Alone {
    pub(crate) fn new(title: String, continuation: Followed, seconds: f64) -> Self {
        Self {
            title,
            continuation,
            seconds,
        }
    }
}

impl fmt::Display for Alone {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}: {}", self.title, self.continuation)
    }
}
