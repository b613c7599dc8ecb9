//! `swimmer certify`: checks any gait against the necessary conditions of an optimum.

use std::fmt;

use gait_optimizer::{Certificate, CertifyError, Objective, Verdict, certify, farthest_in_period};
use serde::Serialize;
use swimmer_files::{AnyGait, Bounds, GaitFile, GaitSpec};

use crate::arguments::{gait, load_gait, load_swimmer, say_if_for_another};
use crate::bounds::QuarterBounds;
use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::own_robot::{PERIOD_S, say_if_beyond};
use crate::quantity;

/// Hold a gait against the necessary conditions of an optimum, each with its number and tolerance
///
/// Objective and bounds are those of the gait file unless given here: naming one bound replaces all of the file's. A gait for speed
/// has to be the fastest of any period, unless its file states the period for which it is optimal; if it is only the farthest in its own
/// period, that period is named.
/// A gait that fails, or that its samples leave undecided, ends with status 1, its whole certificate printed.
#[derive(Debug, clap::Args)]
pub(crate) struct Certify {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// circle:AMPLITUDE, square:AMPLITUDE or a gait file; add :cw to reverse it
    #[arg(long, value_name = "GAIT", value_parser = gait)]
    gait: GaitSpec,
    /// displacement, efficiency, turning, sideways or speed
    #[arg(long, value_name = "OBJECTIVE", value_parser = objective)]
    objective: Option<Objective>,
    /// For speed: certify the gait as the farthest in its own period, instead of the fastest of any period
    #[arg(long)]
    fixed_period: bool,
    #[command(flatten)]
    bounds: QuarterBounds,
}

/// Samples of a circle or a square.
const SAMPLES: usize = 1024;

impl Certify {
    /// Certifies the gait and prints the certificate.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let swimmer = load_swimmer(&self.swimmer)?;
        let mut file = self.load()?;
        if self.fixed_period {
            // The conditions are the same for every rate of the servos, and so for every length of the period.
            file.optimal_period.get_or_insert(1.0);
        }
        say_if_for_another(&swimmer, &file, &self.gait);
        let objective = self.objective.unwrap_or(file.objective);
        if objective == Objective::Unspecified {
            return Err(Failure::BadInput(format!(
                "{} does not tell what it shall be optimal for; add --objective displacement, efficiency, turning, sideways or speed",
                self.gait.readable()
            )));
        }
        if let Ok(curve) = AnyGait::from_file(&file) {
            say_if_beyond(&swimmer, &curve, PERIOD_S);
        }
        let told = self.bounds.of(&swimmer);
        let bounds = if told == Bounds::default() {
            file.bounds
        } else {
            told
        };
        let certificate = certify(&swimmer.swimmer, &file, objective, &bounds)?;
        let title = format!(
            "{}, {}, {} {objective}, {bounds}",
            swimmer.name,
            self.gait.readable(),
            if objective.is_joined() {
                "fastest"
            } else {
                "most"
            }
        );
        let checks = certificate.checks();
        let failed = checks.iter().filter(|check| !check.pass).count();
        let of = checks.len();
        let verdict = certificate.verdict();
        let own_period = objective == Objective::Speed
            && file.optimal_period.is_none()
            && verdict != Verdict::Pass;
        let passes_for_period_rad = if own_period {
            farthest_in_period(&swimmer.swimmer, &file, &bounds)?
        } else {
            None
        };
        output.answer(&Answer {
            title,
            certificate,
            passes_for_period_rad,
        });
        match verdict {
            Verdict::Pass => Ok(()),
            Verdict::Fail => Err(Failure::Answered(format!(
                "the gait is no certified optimum: {failed} of {of} conditions do not hold"
            ))),
            Verdict::Undecided => Err(Failure::Answered(format!(
                "undecided from these samples: {failed} of {of} conditions do not hold, and so few or so rounded samples may be \
                 the reason; write more of them, with all digits"
            ))),
        }
    }

    /// Loads the gait with everything that its file states.
    fn load(&self) -> Outcome<GaitFile> {
        match &self.gait {
            GaitSpec::File { path, reversed } => {
                let file = GaitFile::load(path)?;
                Ok(if *reversed { file.reversed() } else { file })
            }
            closed_form => Ok(GaitFile::sampled(&load_gait(closed_form)?, SAMPLES)),
        }
    }
}

fn objective(text: &str) -> Result<Objective, String> {
    match text.parse() {
        Ok(Objective::Unspecified) | Err(_) => Err(
            "an objective is one of displacement, efficiency, turning, sideways, speed".to_owned(),
        ),
        Ok(objective) => Ok(objective),
    }
}

impl From<CertifyError> for Failure {
    /// No condition can be evaluated: bad input.
    fn from(error: CertifyError) -> Self {
        Self::bad_input(&error)
    }
}

#[derive(Debug, Serialize)]
struct Answer {
    #[serde(skip)]
    title: String,
    #[serde(flatten)]
    certificate: Certificate,
    /// Angle that the faster servo turns in the period for which the gait goes farthest, if it is not the fastest of any period.
    #[serde(skip_serializing_if = "Option::is_none")]
    passes_for_period_rad: Option<f64>,
}

impl fmt::Display for Answer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let checks = self.certificate.checks();
        let mut table = quantity::Table::new(["condition", "number", "", "tolerance", ""]);
        for check in checks {
            let sign = if check.condition.is_from_below() {
                "≥"
            } else {
                "≤"
            };
            table.line([
                check.condition.key().to_owned(),
                format!("{:.2e}", check.value),
                sign.to_owned(),
                format!("{:.1e}", check.tolerance),
                if check.pass { "holds" } else { "FAILS" }.to_owned(),
            ]);
        }
        let failed = checks.iter().filter(|check| !check.pass).count();
        let of = checks.len();
        let verdict = match (failed, self.certificate.verdict()) {
            (0, _) => format!("all {of} conditions hold"),
            (_, Verdict::Undecided) => {
                format!("undecided from these samples: {failed} of {of} conditions do not hold")
            }
            _ => format!("{failed} of {of} conditions fail"),
        };
        write!(f, "{}\n{table}\n  {verdict}", self.title)?;
        if let Some(turned) = self.passes_for_period_rad {
            write!(
                f,
                "\n  it is the farthest gait in its own period ({turned:.4} rad at the full rate of the faster servo), but a gait of \
                 another period is faster; --fixed-period certifies it as the farthest"
            )?;
        }
        Ok(())
    }
}
