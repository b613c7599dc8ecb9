//! Gaits that are followed as a parameter changes.

use std::str::FromStr;

use gait_optimizer::{
    ArcKind, Atlas, Bounds, Branch, Continuation, ContinuationError, ContinuationProblem, Event,
    Heading, Parameter, Point, Start, continuation,
};
use serde::{Deserialize, Serialize};
use swimmer_files::{Objective, parse_angle};
use swimmer_model::Swimmer;

use crate::Error;
use crate::optimize::efficiency::Optimum;

/// Number of gaits of an atlas that are continued.
const MOST_GAITS: usize = 2;
/// Samples of a followed gait.
const SAMPLES: usize = 512;

/// Parameter with its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Range {
    /// Parameter.
    pub parameter: Parameter,
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
}

impl FromStr for Range {
    type Err = String;

    /// Reads `max-angle=2.8..2.0` and the like.
    fn from_str(text: &str) -> Result<Self, String> {
        let form = || {
            "write a parameter and its range as max-angle=2.8..2.0, chi=2..1.5, sphere=0.07..0 or link-ratio=1..2"
                .to_owned()
        };
        let (name, range) = text.split_once('=').ok_or_else(form)?;
        let (from, to) = range.split_once("..").ok_or_else(form)?;
        let parameter = parameter_of_word(name).ok_or_else(form)?;
        let value = |text: &str| match parameter {
            Parameter::MaxAngle => parse_angle(text).map_err(|error| error.to_string()),
            _ => text.parse().map_err(|_| form()),
        };
        Ok(Self {
            parameter,
            from: value(from)?,
            to: value(to)?,
        })
    }
}

/// Number of steps, unless the user sets one.
pub const STEPS: u32 = 20;

/// Parameter with its range, and the gaits to follow.
#[derive(Debug, Clone, PartialEq, Deserialize)]
pub struct Request {
    /// Parameter.
    #[serde(deserialize_with = "parameter")]
    pub parameter: Parameter,
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
    /// Number of equal steps.
    pub steps: usize,
    /// Efficiency gaits to follow. Empty for the best of an atlas, or for the gaits of most displacement.
    #[serde(default)]
    pub gaits: Vec<Optimum>,
}

fn parameter<'de, D: serde::Deserializer<'de>>(deserializer: D) -> Result<Parameter, D::Error> {
    let word = String::deserialize(deserializer)?;
    parameter_of_word(&word)
        .ok_or_else(|| serde::de::Error::custom(format!("`{word}` is no parameter")))
}

/// Parameter by its name on the command line.
fn parameter_of_word(word: &str) -> Option<Parameter> {
    let all = [
        Parameter::MaxAngle,
        Parameter::Chi,
        Parameter::SphereRadius,
        Parameter::LinkRatio,
    ];
    all.into_iter().find(|parameter| parameter.word() == word)
}

/// Followed gaits, and the events on their way.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "ContinuationOutput")
)]
pub struct Output {
    /// Name of the parameter.
    pub parameter: &'static str,
    /// First value.
    pub from: f64,
    /// Last value.
    pub to: f64,
    /// Gaits, branch by branch.
    pub points: Vec<PointOutput>,
    /// Events, branch by branch; those between branches come last.
    pub events: Vec<Event>,
}

/// Gait at one value of the parameter.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct PointOutput {
    /// Number of the gait that is followed, from 0.
    pub branch: usize,
    /// Value of the parameter.
    pub value: f64,
    /// Lighthill efficiency ξ.
    #[cfg_attr(feature = "schema", schemars(with = "Option<f64>"))]
    pub efficiency: f64,
    /// Displacement along the heading at the first sample, over the total length.
    pub displacement_over_length: f64,
    /// Displacement across that heading, over the total length.
    pub lateral_over_length: f64,
    /// φ₁ at the first sample \[rad\].
    pub start_angle_rad: f64,
    /// φ₂ at the end of the first quarter \[rad\].
    pub end_angle_rad: f64,
    /// Kinds of the arcs in order.
    pub arcs: Vec<&'static str>,
    /// Residual of the solver.
    pub residual: f64,
    /// The certificate passes.
    pub certified: bool,
}

impl From<&Point> for PointOutput {
    fn from(point: &Point) -> Self {
        let gait = &point.gait;
        Self {
            branch: point.branch,
            value: point.value,
            efficiency: gait.efficiency,
            displacement_over_length: gait.displacement_over_length,
            lateral_over_length: gait.lateral_over_length,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            arcs: words(gait.arcs.iter().map(|arc| arc.kind)),
            residual: point.residual,
            certified: gait.certificate.pass(),
        }
    }
}

fn words(kinds: impl Iterator<Item = ArcKind>) -> Vec<&'static str> {
    kinds.map(ArcKind::word).collect()
}

/// Receiver of the completed share.
type Share<'a> = &'a (dyn Fn(f64) + Sync);

/// Inputs of a continuation, except for the gaits.
pub(super) struct Order<'a> {
    pub(super) swimmer: Swimmer<f64>,
    pub(super) objective: Objective,
    pub(super) bounds: Bounds,
    pub(super) request: &'a Request,
}

impl Order<'_> {
    /// Swimmer and bounds at the first value.
    pub(super) fn at_first(&self) -> (Swimmer<f64>, Bounds) {
        let Request {
            parameter, from, ..
        } = self.request;
        (
            parameter.swimmer(&self.swimmer, *from),
            parameter.bounds(&self.bounds, *from),
        )
    }

    fn follow(&self, starts: Vec<Start>, watch: Share<'_>) -> Result<Output, ContinuationError> {
        let Request {
            parameter,
            from,
            to,
            steps,
            ..
        } = *self.request;
        let problem = ContinuationProblem {
            swimmer: self.swimmer,
            objective: self.objective,
            bounds: self.bounds,
            parameter,
            from,
            to,
            starts,
            steps,
            samples: SAMPLES,
        };
        let Continuation { points, events } = continuation(&problem, watch)?;
        Ok(Output {
            parameter: parameter.word(),
            from,
            to,
            points: points.iter().map(Into::into).collect(),
            events,
        })
    }

    /// Follows the requested gaits, or those of most displacement.
    ///
    /// # Errors
    /// The problem is invalid, or has no gait to begin with.
    pub(super) fn named(&self, watch: Share<'_>) -> Result<Output, Error> {
        let gaits = &self.request.gaits;
        if self.objective == Objective::Efficiency {
            let starts = gaits.iter().map(|gait| {
                Start::Efficiency(match gait {
                    Optimum::Small => Branch::Small,
                    Optimum::Large => Branch::Large,
                })
            });
            return Ok(self.follow(starts.collect(), watch)?);
        }
        if !gaits.is_empty() {
            return Err(Error::refused(
                "--gait names efficiency gaits; leave it out for --objective displacement",
            ));
        }
        let ranks = |count: usize| {
            let heading = Heading::Forwards;
            (0..count).map(move |rank| Start::Displacement { heading, rank })
        };
        match self.follow(ranks(MOST_GAITS).collect(), watch) {
            // There is only one.
            Err(ContinuationError::NoStart { branch, .. }) if branch > 0 => {
                Ok(self.follow(ranks(1).collect(), watch)?)
            }
            other => Ok(other?),
        }
    }

    /// Follows the best gaits of an atlas.
    ///
    /// # Errors
    /// The atlas is empty, or as [`named`](Self::named).
    pub(super) fn best(&self, atlas: &Atlas, watch: Share<'_>) -> Result<Output, Error> {
        let optima = atlas.optima.iter().take(MOST_GAITS);
        let starts: Vec<_> = optima
            .map(|optimum| Start::Gait(Box::new(optimum.gait.clone())))
            .collect();
        if starts.is_empty() {
            return Err(Error::unsuccessful(
                "the atlas is empty, so there is no gait to follow; give more --starts or wider bounds",
            ));
        }
        Ok(self.follow(starts, watch)?)
    }
}

impl From<ContinuationError> for Error {
    /// An invalid problem is bad input; one without a gait to begin with is a failure.
    fn from(error: ContinuationError) -> Self {
        if error.is_bad_input() {
            Self::bad_input(&error)
        } else {
            Self::failed(&error)
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ranges_are_read() {
        let read: Range = "max-angle=160deg..2.0".parse().unwrap();
        assert_eq!(read.parameter, Parameter::MaxAngle);
        assert!((read.from - 160.0_f64.to_radians()).abs() < 1e-12);
        assert!((read.to - 2.0).abs() < 1e-15);
        let sphere: Range = "sphere=0.07..0".parse().unwrap();
        assert_eq!(sphere.parameter, Parameter::SphereRadius);
        for text in ["chi", "chi=2", "chi=2..x", "mass=1..2", "=1..2", ""] {
            assert!(text.parse::<Range>().is_err(), "{text}");
        }
    }
}
