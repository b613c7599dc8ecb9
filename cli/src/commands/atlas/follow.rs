//! Gaits followed as a parameter changes.

mod output;

use clap::ValueEnum;
use gait_optimizer::{
    Atlas as Found, Bounds, Branch, ContinuationError, ContinuationProblem, Heading, Objective,
    Parameter, Start, continuation,
};
use swimmer_model::Swimmer;

use crate::arguments::angle;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::progress::Progress;

use output::followed;

/// Parameter of a continuation, with its range.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) struct Way {
    parameter: Parameter,
    from: f64,
    to: f64,
}

/// Number of gaits of an atlas that are continued.
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

/// Inputs of a continuation, except for the gait that it starts from.
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

    fn follow(&self, starts: Vec<Start>) -> Result<Document, ContinuationError> {
        let Way {
            parameter,
            from,
            to,
        } = self.way;
        let progress = Progress::with_share("following gaits");
        let asked = ContinuationProblem {
            swimmer: self.swimmer,
            objective: self.objective,
            bounds: self.bounds,
            parameter,
            from,
            to,
            starts,
            steps: self.steps,
            samples: 512,
        };
        let found = continuation(&asked, &|share| progress.at_share(share))?;
        Ok(followed(parameter, [from, to], &found))
    }

    /// The gaits with these names, or those of most displacement.
    pub(super) fn named(&self, names: &[Named]) -> Outcome<Document> {
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
            let heading = Heading::Forwards;
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
    pub(super) fn best(&self, atlas: &Found) -> Outcome<Document> {
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
