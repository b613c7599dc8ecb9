//! `swimmer optimize sideways`: the gait that moves most across its heading, without turning.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use gait_optimizer::{Arc, Sideways as Found, SidewaysError, SidewaysProblem, sideways_watched};
use serde::Serialize;

use crate::arguments::load_swimmer;
use crate::bounds::WholeBounds;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::progress::Progress;
use crate::quantity::{self, Rows};
use crate::threads;

use super::answer::{Closing, say_if_beyond, unfolded};

/// Find the simple closed gait of most displacement across the heading at its first sample, without net rotation
///
/// The first sample is free to choose, so it is part of what is optimised: either the heading there is square to the
/// displacement, or as near to it as the loop gets. Bridges to another start do not count, so a wider bound can lower the
/// answer: where a loop can no longer run into the corner that it starts from, only a bridge would lead there.
#[derive(Debug, clap::Args)]
pub(crate) struct Sideways {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    #[command(flatten)]
    bounds: WholeBounds,
    /// Write the gait, at constant power, as a gait file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

impl Sideways {
    pub(super) fn run(self, output: Output) -> Outcome {
        let file = load_swimmer(&self.swimmer)?;
        let begun = Instant::now();
        let progress = Progress::of_a_whole("looking for loops");
        let asked = SidewaysProblem {
            bounds: self.bounds.of(&file),
            threads: threads::available(),
            ..SidewaysProblem::new(file.swimmer)
        };
        let found = sideways_watched(&asked, &|share| progress.at_share(share))?;
        drop(progress);
        let seconds = begun.elapsed().as_secs_f64();
        unfolded(&found.gait)?;
        say_if_beyond(&file, &found.gait);
        if let Some(path) = &self.output {
            found.gait.gait_file(&file.name).save(path)?;
        }
        output.answer(&Answer::new(&file.name, &found, seconds, self.output));
        Ok(())
    }
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(skip)]
    name: String,
    /// Across the heading at the first sample, positive.
    lateral_over_length: f64,
    /// Along it.
    displacement_over_length: f64,
    /// What bridges to another start, which do not count, would come near to; null where nobody knows how far gaits carry.
    bridged_supremum_over_length: Option<f64>,
    /// Y over L of a known gait that moves farther across and is no optimum.
    #[serde(skip_serializing_if = "Option::is_none")]
    outdone_over_length: Option<f64>,
    /// Null: these gaits do not rotate, and what bridges would bring is the length above.
    bridged_supremum_rad: Option<f64>,
    rotation_rad: f64,
    /// Of the displacement against the mean heading.
    heading_rad: Option<f64>,
    /// Loops found, of which this is the best certified one.
    loops: usize,
    arcs: Vec<Arc>,
    #[serde(flatten)]
    closing: Closing,
}

impl Answer {
    fn new(name: &str, found: &Found, seconds: f64, file: Option<PathBuf>) -> Self {
        let gait = &found.gait;
        Self {
            name: name.to_owned(),
            lateral_over_length: found.lateral_over_length,
            displacement_over_length: gait.displacement_over_length,
            bridged_supremum_over_length: found.bridged_supremum_over_length,
            outdone_over_length: found.outdone_over_length,
            bridged_supremum_rad: None,
            rotation_rad: gait.rotation,
            heading_rad: found.gait.heading(),
            loops: found.loops,
            arcs: gait.arcs.clone(),
            closing: Closing::new(gait, None, seconds, file),
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        let signed = |value: f64| (value * 1e9).round() / 1e9 + 0.0;
        rows.row(
            "sideways",
            format!("|Y|/L = {:.9}", self.lateral_over_length),
        )
        .row(
            "along the heading",
            format!("X/L = {:.9}", signed(self.displacement_over_length)),
        )
        .row(
            "with bridges",
            self.bridged_supremum_over_length.map_or_else(
                || "nobody knows how far: gaits that are no optima carry farther than every loop found".to_owned(),
                |supremum| format!("up to |Y|/L = {supremum:.9}"),
            ),
        )
        .row("net rotation", quantity::angle(self.rotation_rad));
        if let Some(farther) = self.outdone_over_length {
            rows.row(
                "outdone",
                format!(
                    "|Y|/L = {farther:.9} by a gait that touches its own image, which is no optimum"
                ),
            );
        }
        rows
        .row("arcs", self.arcs.len().to_string())
        .row(
            "best of",
            format!(
                "the {} simple loops found, each with its best first sample; `swimmer optimize displacement` finds gaits of \
                 other kinds",
                self.loops
            ),
        );
        self.closing.rows(&mut rows);
        write!(
            f,
            "{}, a local optimum of displacement sideways\n{rows}",
            self.name
        )
    }
}

impl From<SidewaysError> for Failure {
    /// A problem that makes no sense is bad input; one without an optimum was tried.
    fn from(error: SidewaysError) -> Self {
        match error {
            SidewaysError::Problem(_) => Self::bad_input(&error),
            SidewaysError::NoOptimum { .. } => Self::tried(&error),
        }
    }
}
