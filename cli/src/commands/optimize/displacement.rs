//! `swimmer optimize displacement`: the gait of most displacement per cycle.

use gait_optimizer::{
    DisplacementError, DisplacementProblem, Heading, Suprema, displacement, robust_displacement,
};

use super::answer::{say_if_beyond, tell_quarter};
use super::better::than_displacement;
use super::no_optimum::no_optimum;
use super::robust::{Robustly, refused, robust_gait};
use super::timing::ServoTiming;
use super::{Found, Objective, Task};
use crate::bounds::QuarterBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::threads;

/// Find the gait of most displacement per cycle by the maximum principle, with its certificate
///
/// Signed, per full cycle, for the gait run counter-clockwise: with no bound or --max-angle alone the local optimum with
/// X > 0; with --min-angle or --sector the one with X < 0; --sign asks for the other. Where gaits along ever narrower slits carry
/// ever farther no optimum exists: exit status 1, with the limit, a gait near it (which -o writes) and the fastest gait.
#[derive(Debug, clap::Args)]
pub(crate) struct Displacement {
    #[command(flatten)]
    bounds: QuarterBounds,
    /// The sign of X: + or -
    #[arg(long, value_name = "SIGN", value_parser = sign, allow_hyphen_values = true)]
    sign: Option<Heading>,
    /// Only gaits that do not touch their own images, as the paper's (a) to (c); limits of these may carry a little farther, along
    /// slits that cost time. Implied by --robust and --max-rate
    #[arg(long)]
    simple: bool,
    #[command(flatten)]
    robustly: Robustly,
    #[command(flatten)]
    timing: ServoTiming,
}

impl Objective for Displacement {
    fn search(&self, task: &Task) -> Outcome<Found> {
        let problem = DisplacementProblem {
            bounds: self.bounds.of(&task.file),
            heading: self.sign,
            // A slit costs no displacement, but time.
            simple: self.simple || self.timing.max_rate.is_some(),
            ..DisplacementProblem::new(task.file.swimmer)
        };
        if let Some((uncertainty, over)) = self.robustly.load(&task.file)? {
            let found = task
                .timed(|| robust_displacement(&problem, &uncertainty, over))
                .map_err(|error| refused(error, &self.bounds))?;
            return robust_gait(task, ("displacement", "X/L"), found, &self.timing);
        }
        let (found, supremum) = task.timed(|| {
            let found = displacement(&problem);
            let mut suprema = Suprema::new(threads::available());
            let supremum = match &found {
                Ok(gait) => suprema.of(&problem, Some(gait)),
                Err(DisplacementError::Saddle { gait }) => suprema.of(&problem, Some(gait)),
                Err(
                    DisplacementError::NoOptimum { .. } | DisplacementError::NotCertified { .. },
                ) => suprema.of(&problem, None),
                Err(_) => None,
            };
            (found, supremum)
        });
        if let Some(supremum) = supremum
            && let Some(farthest) = supremum.members.last()
        {
            let local = found.as_ref().ok();
            return Ok(no_optimum(
                task,
                &problem.bounds,
                (&supremum, farthest),
                local,
            ));
        }
        let gait = found?;
        let better = than_displacement(&problem, task.swimmer, &gait);
        say_if_beyond(task, &gait);
        let timed = self.timing.of(task, &gait)?;
        let mut answer = Document::new(format!(
            "{}, a local optimum of displacement",
            task.file.name
        ));
        tell_quarter(&mut answer, &gait);
        // X/L of a gait within the bounds that carries farther but is no extremal, where no gaits were found that go on from there.
        answer.key_if("outdone_over_length", gait.outdone_over_length);
        if let Some(carried) = gait.outdone_over_length {
            answer.row(
                "not the farthest",
                format!("a gait that is no extremal carries X/L = {carried:.6}"),
            );
        }
        let sign = if gait.displacement > 0.0 { ">" } else { "<" };
        let of = match gait.extremals {
            None => String::new(),
            Some(1) => "the only extremal found ".to_owned(),
            Some(count) => format!("the {count} extremals found "),
        };
        answer.key_if("extremals", gait.extremals).row(
            "best of",
            format!(
                "{of}with the paper's symmetries and X {sign} 0; `swimmer atlas --objective displacement` looks beyond"
            ),
        );
        if let Some(better) = better {
            better.tell(&mut answer, false);
        }
        Ok(Found::gait(answer, task, &gait, timed))
    }
}

fn sign(text: &str) -> Result<Heading, String> {
    match text {
        "+" => Ok(Heading::Forwards),
        "-" => Ok(Heading::Backwards),
        _ => Err("write + or -".to_owned()),
    }
}

impl From<DisplacementError> for Failure {
    /// A problem that makes no sense is bad input; one without an optimum was tried.
    fn from(error: DisplacementError) -> Self {
        match error {
            DisplacementError::Problem(_) => Self::bad_input(&error),
            _ => Self::tried_with_details(&error, error.details()),
        }
    }
}
