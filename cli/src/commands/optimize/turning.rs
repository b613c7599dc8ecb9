//! `swimmer optimize turning`: the simple closed gait of most rotation per cycle.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use gait_optimizer::{Arc, Turning as Found, TurningError, TurningProblem, turning};
use serde::Serialize;
use swimmer_files::Bounds;

use crate::arguments::load_swimmer;
use crate::bounds::WholeBounds;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::{self, Rows};

use super::answer::{Closing, arc_rows, say_if_beyond, unfolded};

/// Find the simple closed gait that turns the swimmer most per cycle, with its certificate
///
/// It runs counter-clockwise round one connected region of the θ curvature and turns the swimmer to the left; reversed, to
/// the right. Without a bound the joints stay within half a turn, where a side link lies folded on the middle one.
#[derive(Debug, clap::Args)]
pub(crate) struct Turning {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    #[command(flatten)]
    bounds: WholeBounds,
    /// Write the gait, at constant power, as a gait file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
}

impl Turning {
    pub(super) fn run(self, output: Output) -> Outcome {
        let file = load_swimmer(&self.swimmer)?;
        let begun = Instant::now();
        let found = turning(&TurningProblem {
            swimmer: file.swimmer,
            bounds: self.bounds.of(&file),
        })?;
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
    #[serde(skip)]
    bounds: Bounds,
    rotation_rad: f64,
    /// What loops that join all regions by bridges come near to.
    bridged_supremum_rad: f64,
    /// Connected regions of that sign.
    regions: usize,
    displacement_over_length: f64,
    lateral_over_length: f64,
    /// Of the cycle, in order.
    arcs: Vec<Arc>,
    #[serde(flatten)]
    closing: Closing,
}

impl Answer {
    fn new(name: &str, found: &Found, seconds: f64, file: Option<PathBuf>) -> Self {
        let gait = &found.gait;
        Self {
            name: name.to_owned(),
            bounds: gait.bounds,
            rotation_rad: gait.rotation,
            bridged_supremum_rad: found.bridged_supremum,
            regions: found.regions,
            displacement_over_length: gait.displacement_over_length,
            lateral_over_length: gait.lateral_over_length,
            arcs: gait.arcs.clone(),
            closing: Closing::new(gait, None, seconds, file),
        }
    }
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row(
            "rotation",
            format!(
                "{} per cycle, {:.10} rad",
                quantity::angle(self.rotation_rad),
                self.rotation_rad
            ),
        )
        .row(
            "with bridges",
            format!(
                "below {} ({} regions)",
                quantity::angle(self.bridged_supremum_rad),
                self.regions
            ),
        )
        .row(
            "displacement",
            format!(
                "X/L = {:.8}, Y/L = {:.8}",
                self.displacement_over_length, self.lateral_over_length
            ),
        );
        arc_rows(&mut rows, &self.arcs);
        let regions = match self.regions {
            1 => "the one region of positive θ curvature".to_owned(),
            count => format!("each of the {count} regions of positive θ curvature"),
        };
        rows.row(
            "best of",
            format!(
                "simple loops, round {regions}: no other simple loop within one region turns more"
            ),
        );
        self.closing.rows(&mut rows);
        write!(f, "{}, most rotation, {}\n{rows}", self.name, self.bounds)
    }
}

impl From<TurningError> for Failure {
    /// A problem that makes no sense is bad input; one without a gait was tried.
    fn from(error: TurningError) -> Self {
        match error {
            TurningError::Problem(_) => Self::bad_input(&error),
            _ => Self::tried(&error),
        }
    }
}
