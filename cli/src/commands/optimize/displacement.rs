//! `swimmer optimize displacement`: the gait of most displacement per cycle.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use gait_optimizer::{
    DisplacementError, DisplacementProblem, Heading, OptimalGait, displacement, robust_displacement,
};
use serde::Serialize;
use swimmer_files::Bounds;

use crate::arguments::{length, load_swimmer, positive_angle};
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::Rows;

use super::answer::{Arc, Evidence, closing_rows, displacement_row, quarter_rows};
use super::robust::{RobustAnswer, Robustly};
use super::timing::{ServoTiming, TimingAnswer};

/// Find the gait of most displacement per cycle by the maximum principle, with its certificate
///
/// Signed, per full cycle, for the gait run counter-clockwise: with no bound or --max-angle alone the local optimum with
/// X > 0; with --min-angle or --sector the one with X < 0; --sign asks for the other.
#[derive(Debug, clap::Args)]
pub(crate) struct Displacement {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// No joint may turn further than this, either way
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    max_angle: Option<f64>,
    /// The leading joint of each quarter must turn at least this far
    #[arg(long, value_name = "ANGLE", value_parser = positive_angle)]
    min_angle: Option<f64>,
    /// Each quarter stays in its sector, φ₂ ≥ |φ₁|
    #[arg(long)]
    sector: bool,
    /// Links may not cross
    #[arg(long)]
    no_overlap: bool,
    /// Keep the centre lines of the side links this far apart, in metres; implies --no-overlap
    #[arg(long, value_name = "LENGTH_M", value_parser = length)]
    clearance: Option<f64>,
    /// The sign of X: + or -
    #[arg(long, value_name = "SIGN", value_parser = sign, allow_hyphen_values = true)]
    sign: Option<Heading>,
    #[command(flatten)]
    robustly: Robustly,
    #[command(flatten)]
    timing: ServoTiming,
    /// Write the gait, at constant power or as timed for the servos, as a gait file
    #[arg(short, long, value_name = "FILE")]
    output: Option<PathBuf>,
}

impl Displacement {
    pub(super) fn run(self, output: Output) -> Outcome {
        let file = load_swimmer(&self.swimmer)?;
        let uncertain = self.robustly.load()?;
        let begun = Instant::now();
        let problem = DisplacementProblem {
            bounds: Bounds {
                max_angle: self.max_angle,
                min_angle: self.min_angle,
                sector: self.sector,
                no_overlap: self.no_overlap || self.clearance.is_some(),
                clearance: self.clearance.unwrap_or(0.0),
            },
            heading: self.sign,
            ..DisplacementProblem::new(file.swimmer)
        };
        if let Some((uncertainty, over)) = uncertain {
            let found = robust_displacement(&problem, &uncertainty, over)?;
            let seconds = begun.elapsed().as_secs_f64();
            let timing = self
                .timing
                .write(&found.gait, &file.name, self.output.as_deref())?;
            output.answer(&RobustAnswer::new(
                format!("{}, most displacement, robust", file.name),
                "X/L",
                &found,
                timing,
                (seconds, self.output),
            ));
            return Ok(());
        }
        let gait = displacement(&problem)?;
        let seconds = begun.elapsed().as_secs_f64();
        let timing = self
            .timing
            .write(&gait, &file.name, self.output.as_deref())?;
        let found = Found::new(&file.name, &gait, timing, (seconds, self.output));
        output.answer(&found);
        Ok(())
    }
}

#[derive(Debug, Serialize)]
struct Found {
    #[serde(skip)]
    name: String,
    displacement_over_length: f64,
    displacement_m: f64,
    start_angle_rad: f64,
    end_angle_rad: f64,
    /// Of the quarter, in order.
    arcs: Vec<Arc>,
    /// Share of the cycle in which links cross.
    links_cross: f64,
    /// Under the servos' limit.
    #[serde(skip_serializing_if = "Option::is_none")]
    timing: Option<TimingAnswer>,
    certificate: Evidence,
    /// From the parsed swimmer to the certified gait.
    seconds: f64,
    /// The gait file that was written.
    #[serde(skip_serializing_if = "Option::is_none")]
    gait: Option<PathBuf>,
}

impl Found {
    fn new(
        name: &str,
        gait: &OptimalGait,
        timing: Option<TimingAnswer>,
        (seconds, file): (f64, Option<PathBuf>),
    ) -> Self {
        Self {
            name: name.to_owned(),
            displacement_over_length: gait.displacement_over_length,
            displacement_m: gait.displacement,
            start_angle_rad: gait.start_angle,
            end_angle_rad: gait.end_angle,
            arcs: gait.arcs.iter().map(Arc::from).collect(),
            links_cross: gait.links_cross,
            timing,
            certificate: (&gait.certificate).into(),
            seconds,
            gait: file,
        }
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        displacement_row(
            &mut rows,
            self.displacement_m,
            self.displacement_over_length,
        );
        quarter_rows(
            &mut rows,
            self.start_angle_rad,
            self.end_angle_rad,
            &self.arcs,
        );
        if let Some(timing) = &self.timing {
            timing.rows(&mut rows);
        }
        closing_rows(
            &mut rows,
            self.links_cross,
            &self.certificate,
            self.gait.as_ref(),
        );
        write!(f, "{}, most displacement\n{rows}", self.name)
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
            DisplacementError::Swimmer(_)
            | DisplacementError::Asymmetric { .. }
            | DisplacementError::Bound { .. }
            | DisplacementError::Clearance { .. } => Self::bad_input(&error),
            _ => Self::tried(&error),
        }
    }
}
