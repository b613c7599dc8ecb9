//! Gaits followed as a parameter changes.

use std::fmt;

use clap::ValueEnum;
use gait_optimizer::{
    ArcKind, Atlas as Found, Bounds, Branch, Continuation, ContinuationError, ContinuationProblem,
    EventKind, Objective, Parameter, Start, continuation,
};
use serde::Serialize;
use swimmer_model::Swimmer;

use crate::arguments::angle;
use crate::failure::{Failure, Outcome};
use crate::quantity;

/// What to follow gaits in, from where to where.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    parameter: Parameter,
    from: f64,
    to: f64,
}

/// How many gaits of an atlas are followed.
const MOST_GAITS: usize = 2;

/// Reads `max-angle=2.8..2.0` and the like.
pub(super) fn way(text: &str) -> Result<Way, String> {
    let form = || {
        "write a parameter and its range as max-angle=2.8..2.0, chi=2..1.5, sphere=0.07..0 or link-ratio=1..2"
            .to_owned()
    };
    let (name, range) = text.split_once('=').ok_or_else(form)?;
    let (from, to) = range.split_once("..").ok_or_else(form)?;
    let parameter = match name {
        "max-angle" => Parameter::MaxAngle,
        "chi" => Parameter::Chi,
        "sphere" => Parameter::SphereRadius,
        "link-ratio" => Parameter::LinkRatio,
        _ => return Err(form()),
    };
    let value = |text: &str| match parameter {
        Parameter::MaxAngle => angle(text),
        _ => text.parse().map_err(|_| form()),
    };
    Ok(Way {
        parameter,
        from: value(from)?,
        to: value(to)?,
    })
}

/// Gaits that have a name.
#[derive(Debug, Clone, Copy, ValueEnum)]
pub(super) enum Named {
    Small,
    Large,
}

/// What to follow, but for where it starts.
#[derive(Debug, Clone, Copy)]
pub(super) struct Order {
    pub(super) swimmer: Swimmer<f64>,
    pub(super) objective: Objective,
    pub(super) bounds: Bounds,
    pub(super) way: Way,
    pub(super) steps: usize,
}

impl Order {
    /// Swimmer and bounds at the first value.
    pub(super) fn at_first(&self) -> (Swimmer<f64>, Bounds) {
        let Way {
            parameter, from, ..
        } = self.way;
        (
            parameter.swimmer(&self.swimmer, from),
            parameter.bounds(&self.bounds, from),
        )
    }

    fn follow(&self, starts: Vec<Start>) -> Result<Followed, ContinuationError> {
        let Way {
            parameter,
            from,
            to,
        } = self.way;
        let found = continuation(&ContinuationProblem {
            swimmer: self.swimmer,
            objective: self.objective,
            bounds: self.bounds,
            parameter,
            from,
            to,
            starts,
            steps: self.steps,
            samples: 512,
        })?;
        Ok(Followed::new(self.way, &found))
    }

    /// The gaits with these names, or those of most displacement.
    pub(super) fn named(&self, names: &[Named]) -> Outcome<Followed> {
        if self.objective == Objective::Efficiency {
            let starts = names.iter().map(|name| {
                Start::Efficiency(match name {
                    Named::Small => Branch::Small,
                    Named::Large => Branch::Large,
                })
            });
            return Ok(self.follow(starts.collect())?);
        }
        if !names.is_empty() {
            return Err(Failure::BadInput(
                "--gait names efficiency gaits; leave it out for --objective displacement"
                    .to_owned(),
            ));
        }
        let ranks = |count: usize| {
            let heading = None;
            (0..count).map(move |rank| Start::Displacement { heading, rank })
        };
        match self.follow(ranks(MOST_GAITS).collect()) {
            // There is only one.
            Err(ContinuationError::NoStart { branch, .. }) if branch > 0 => {
                Ok(self.follow(ranks(1).collect())?)
            }
            other => Ok(other?),
        }
    }

    /// The best gaits of an atlas.
    pub(super) fn best(&self, atlas: &Found) -> Outcome<Followed> {
        let optima = atlas.optima.iter().take(MOST_GAITS);
        let starts: Vec<_> = optima
            .map(|optimum| Start::Gait(Box::new(optimum.gait.clone())))
            .collect();
        if starts.is_empty() {
            return Err(Failure::Tried(
                "the atlas is empty, so there is no gait to follow; give more --starts or wider bounds"
                    .to_owned(),
            ));
        }
        Ok(self.follow(starts)?)
    }
}

/// Gaits on the way, and what happened there.
#[derive(Debug, Serialize)]
pub(super) struct Followed {
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
    fn new(way: Way, found: &Continuation) -> Self {
        let points: Vec<_> = found.points.iter().map(Point::new).collect();
        Self {
            parameter: way.parameter.word(),
            from: way.from,
            to: way.to,
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
pub(super) struct Alone {
    #[serde(skip)]
    title: String,
    continuation: Followed,
    seconds: f64,
}

impl Alone {
    pub(super) fn new(title: String, continuation: Followed, seconds: f64) -> Self {
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

impl From<ContinuationError> for Failure {
    /// A problem that makes no sense is bad input; one without a gait to begin with was tried.
    fn from(error: ContinuationError) -> Self {
        if error.is_bad_input() {
            Self::bad_input(&error)
        } else {
            Self::tried(&error)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ways_are_read() {
        let read = way("max-angle=160deg..2.0").unwrap();
        assert_eq!(read.parameter, Parameter::MaxAngle);
        assert!((read.from - 160.0_f64.to_radians()).abs() < 1e-12);
        assert!((read.to - 2.0).abs() < 1e-15);
        assert_eq!(
            way("sphere=0.07..0").unwrap().parameter,
            Parameter::SphereRadius
        );
        for text in ["chi", "chi=2", "chi=2..x", "mass=1..2", "=1..2", ""] {
            assert!(way(text).is_err(), "{text}");
        }
    }
}
