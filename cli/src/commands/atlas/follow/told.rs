//! What is told of gaits that were followed.

use std::fmt;

use gait_optimizer::{ArcKind, Continuation, EventKind, Parameter};
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

#[derive(Debug, Default, Serialize)]
struct Event {
    branch: usize,
    value: f64,
    within: f64,
    kind: &'static str,
    #[serde(skip_serializing_if = "Option::is_none")]
    arcs_before: Option<Vec<&'static str>>,
    #[serde(skip_serializing_if = "Option::is_none")]
    arcs_after: Option<Vec<&'static str>>,
    /// Folds: whether the extremal that the branch meets was found.
    #[serde(skip_serializing_if = "Option::is_none")]
    proven: Option<bool>,
    #[serde(skip_serializing_if = "Option::is_none")]
    other_side: Option<OtherSide>,
    #[serde(skip_serializing_if = "Option::is_none")]
    exponent: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    apart_rad: Option<f64>,
    /// Mergers and overtakings: the other branch.
    #[serde(skip_serializing_if = "Option::is_none")]
    other_branch: Option<usize>,
    #[serde(skip_serializing_if = "Option::is_none")]
    reason: Option<String>,
}

#[derive(Debug, Serialize)]
struct OtherSide {
    value: f64,
    efficiency: f64,
    start_angle_rad: f64,
    ascent_directions: Option<usize>,
}

fn words(kinds: &[ArcKind]) -> Vec<&'static str> {
    kinds.iter().map(|kind| kind.word()).collect()
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
            events: found.events.iter().map(Event::new).collect(),
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

impl Event {
    fn new(event: &gait_optimizer::Event) -> Self {
        let bare = Self {
            branch: event.branch,
            value: event.value,
            within: event.within,
            ..Self::default()
        };
        match &event.kind {
            EventKind::Structure { before, after } => Self {
                kind: "structure",
                arcs_before: Some(words(before)),
                arcs_after: Some(words(after)),
                ..bare
            },
            EventKind::Fold(fold) => Self {
                kind: "fold",
                proven: Some(fold.other.is_some()),
                other_side: fold.other.map(|other| OtherSide {
                    value: other.value,
                    efficiency: other.efficiency,
                    start_angle_rad: other.start_angle,
                    ascent_directions: other.ascent_directions,
                }),
                exponent: fold.exponent,
                ..bare
            },
            EventKind::Jump { apart, exponent } => Self {
                kind: "jump",
                apart_rad: Some(*apart),
                exponent: *exponent,
                ..bare
            },
            EventKind::Merger { with } => Self {
                kind: "merger",
                other_branch: Some(*with),
                ..bare
            },
            EventKind::Overtaken { by } => Self {
                kind: "overtaken",
                other_branch: Some(*by),
                ..bare
            },
            EventKind::Lost { failed } => Self {
                kind: "lost",
                reason: Some(failed.clone()),
                ..bare
            },
            EventKind::Ended { reason, exponent } => Self {
                kind: "ended",
                reason: Some(reason.clone()),
                exponent: *exponent,
                ..bare
            },
            EventKind::Reached => Self {
                kind: "reached",
                ..bare
            },
        }
    }

    /// In words.
    fn told(&self) -> String {
        let reason = self.reason.as_deref().unwrap_or_default();
        let arcs = |arcs: &Option<Vec<&str>>| arcs.as_deref().unwrap_or_default().join(" ");
        let power = self
            .exponent
            .map(|power| format!(" (changes with the distance to the power {power:.2})"))
            .unwrap_or_default();
        let other = self.other_branch.map_or(0, |other| other + 1);
        match self.kind {
            "structure" => format!(
                "arcs change: {} becomes {}",
                arcs(&self.arcs_before),
                arcs(&self.arcs_after)
            ),
            "fold" => match &self.other_side {
                Some(other) => format!(
                    "folds: meets another extremal (ξ {:.7e} at {:.6}){power}",
                    other.efficiency, other.value
                ),
                None => format!("folds{power}"),
            },
            "jump" => format!(
                "the nearest gait beyond is {} away{power}",
                quantity::angle(self.apart_rad.unwrap_or(f64::NAN))
            ),
            "merger" => format!("becomes gait {other}"),
            "overtaken" => format!("gait {other} becomes the better one"),
            "lost" => format!("no optimum beyond: fails {reason}"),
            "ended" => format!("ends: {reason}{power}"),
            _ => "followed to here".to_owned(),
        }
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
                event.told()
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
