//! `swimmer optimize displacement`: the gait of most displacement per cycle.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use gait_optimizer::{
    DisplacementError, DisplacementProblem, Heading, displacement, displacement_supremum,
    robust_displacement,
};
use serde::Serialize;

use crate::arguments::load_swimmer;
use crate::bounds::QuarterBounds;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::Rows;

use super::answer::{Closing, Quarter, say_if_beyond};
use super::better::{Better, than_displacement};
use super::no_optimum::NoOptimum;
use super::robust::{RobustAnswer, Robustly, as_written, refused};
use super::timing::ServoTiming;

/// Find the gait of most displacement per cycle by the maximum principle, with its certificate
///
/// Signed, per full cycle, for the gait run counter-clockwise: with no bound or --max-angle alone the local optimum with
/// X > 0; with --min-angle or --sector the one with X < 0; --sign asks for the other. Where gaits along ever narrower slits carry
/// ever farther no optimum exists: exit status 1, with the limit, a gait near it (which -o writes) and the fastest gait.
#[derive(Debug, clap::Args)]
pub(crate) struct Displacement {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
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
    /// Write the gait, at constant power or as timed for the servos, as a gait file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

impl Displacement {
    pub(super) fn run(self, output: Output) -> Outcome {
        let file = load_swimmer(&self.swimmer)?;
        let uncertain = self.robustly.load(&file)?;
        let begun = Instant::now();
        let problem = DisplacementProblem {
            bounds: self.bounds.of(&file),
            heading: self.sign,
            // A slit costs no displacement, but time.
            simple: self.simple || self.timing.max_rate.is_some(),
            ..DisplacementProblem::new(file.swimmer)
        };
        if let Some((uncertainty, over)) = uncertain {
            let found = robust_displacement(&problem, &uncertainty, over)
                .map_err(|error| refused(error, &self.bounds))?;
            let seconds = begun.elapsed().as_secs_f64();
            let timing = self.timing.write(
                &as_written(&found.gait),
                (&file.name, &self.swimmer),
                self.output.as_deref(),
            )?;
            output.answer(&RobustAnswer::new(
                format!("{}, most displacement, robust", file.name),
                "X/L",
                &found,
                timing,
                (seconds, self.output),
            ));
            return Ok(());
        }
        let found = displacement(&problem);
        if let Ok(_)
        | Err(DisplacementError::NoOptimum { .. } | DisplacementError::NotCertified { .. }) =
            found
            && let local = found.as_ref().ok()
            && let Some(supremum) = displacement_supremum(&problem, local)
            && let Some(answer) = NoOptimum::new((&file, &self.swimmer), &problem, &supremum, local)
        {
            let best = supremum.members.last().zip(self.output);
            return answer.told(best, begun.elapsed().as_secs_f64(), output);
        }
        let gait = found?;
        let seconds = begun.elapsed().as_secs_f64();
        let better = than_displacement(&problem, &self.swimmer, &gait);
        say_if_beyond(&file, &gait);
        let timing =
            self.timing
                .write(&gait, (&file.name, &self.swimmer), self.output.as_deref())?;
        output.answer(&Found {
            name: file.name,
            quarter: (&gait).into(),
            outdone_over_length: gait.outdone_over_length,
            extremals: gait.extremals,
            better,
            closing: Closing::new(&gait, timing, seconds, self.output),
        });
        Ok(())
    }
}

#[derive(Debug, Serialize)]
struct Found {
    #[serde(skip)]
    name: String,
    #[serde(flatten)]
    quarter: Quarter,
    /// X/L of a gait within the bounds that carries farther but is no extremal, where no gaits were found that go on from there;
    /// left out where none was seen.
    #[serde(skip_serializing_if = "Option::is_none")]
    outdone_over_length: Option<f64>,
    /// Local optima and other extremals found, of which this is the best certified one.
    #[serde(skip_serializing_if = "Option::is_none")]
    extremals: Option<usize>,
    /// Of a wider class.
    #[serde(skip_serializing_if = "Option::is_none")]
    better: Option<Better>,
    #[serde(flatten)]
    closing: Closing,
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        self.quarter.rows(&mut rows);
        if let Some(carried) = self.outdone_over_length {
            rows.row(
                "not the farthest",
                format!("a gait that is no extremal carries X/L = {carried:.6}"),
            );
        }
        let sign = if self.quarter.forwards() { ">" } else { "<" };
        let of = self
            .extremals
            .map_or_else(String::new, |count| match count {
                1 => "the only extremal found ".to_owned(),
                count => format!("the {count} extremals found "),
            });
        rows.row(
            "best of",
            format!(
                "{of}with the paper's symmetries and X {sign} 0; `swimmer atlas --objective displacement` looks beyond"
            ),
        );
        if let Some(better) = &self.better {
            better.row(&mut rows);
        }
        self.closing.rows(&mut rows);
        write!(f, "{}, a local optimum of displacement\n{rows}", self.name)
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
