//! `swimmer certify`: checks any gait against the necessary conditions of an optimum.

use std::fmt;

use gait_optimizer::{Objective, Verdict};
use operations::{Context, Files, GaitSource, SwimmerSource, certify, warn_if_for_another};
use swimmer_files::GaitSpec;

use crate::arguments::gait;
use crate::bounds::QuarterBounds;
use crate::failure::{Failure, Outcome};
use crate::output::{Output, asides};
use crate::quantity;

/// Hold a gait against the necessary conditions of an optimum, each with its number and tolerance
///
/// Objective and bounds are those of the gait file unless given here: naming one bound replaces all of the file's. A gait for speed
/// has to be the fastest of any period, unless its file states the period for which it is optimal; if it is only the farthest in its own
/// period, that period is named.
/// A gait that fails, or that its samples leave undecided, ends with status 1, its whole certificate printed.
#[derive(Debug, clap::Args)]
pub(crate) struct Certify {
    /// A preset that `swimmer swimmers` lists, or a swimmer file
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

impl Certify {
    /// Certifies the gait and prints the certificate.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let mut context = Context::on_disk();
        let certified = self.certified(&mut context);
        asides(&context);
        let (swimmer_name, certified) = certified?;
        let title = format!(
            "{swimmer_name}, {}, {} {}, {}",
            self.gait.readable(),
            if certified.objective.is_joined() {
                "fastest"
            } else {
                "most"
            },
            certified.objective,
            certified.bounds
        );
        output.rendered(
            &certified,
            &Text {
                title: &title,
                output: &certified,
            },
        );
        let checks = certified.certificate.checks();
        let failed = checks.iter().filter(|check| !check.pass).count();
        let of = checks.len();
        match certified.certificate.verdict() {
            Verdict::Pass => Ok(()),
            Verdict::Fail => Err(Failure::AlreadyPrinted(format!(
                "the gait is no certified optimum: {failed} of {of} conditions do not hold"
            ))),
            Verdict::Undecided => Err(Failure::AlreadyPrinted(format!(
                "undecided from these samples: {failed} of {of} conditions do not hold, and so few or so rounded samples may be \
                 the reason; write more of them, with all digits"
            ))),
        }
    }

    /// Name of the swimmer, and the certificate.
    fn certified(
        &self,
        context: &mut Context,
    ) -> Result<(String, certify::Output), operations::Error> {
        let swimmer = SwimmerSource::from(self.swimmer.as_str()).load(context)?;
        let gait = GaitSource::from(self.gait.clone()).file(Files::Disk)?;
        warn_if_for_another(&swimmer, &gait, &self.gait.to_string(), context);
        if self.objective.is_none() && gait.objective == Objective::Unspecified {
            return Err(operations::Error::refused(format!(
                "{} names no objective; add --objective displacement, efficiency, turning, sideways or speed",
                self.gait.readable()
            )));
        }
        let options = certify::Options {
            objective: self.objective,
            fixed_period: self.fixed_period,
            bounds: self.bounds.into(),
        };
        let certified = certify::run(&swimmer, gait, &options, context)?;
        Ok((swimmer.name, certified))
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

/// Output as text.
struct Text<'a> {
    title: &'a str,
    output: &'a certify::Output,
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let checks = self.output.certificate.checks();
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
        let verdict = match (failed, self.output.certificate.verdict()) {
            (0, _) => format!("all {of} conditions hold"),
            (_, Verdict::Undecided) => {
                format!("undecided from these samples: {failed} of {of} conditions do not hold")
            }
            _ => format!("{failed} of {of} conditions fail"),
        };
        write!(f, "{}\n{table}\n  {verdict}", self.title)?;
        if let Some(turned) = self.output.passes_for_period_rad {
            write!(
                f,
                "\n  it is the farthest gait in its own period ({turned:.4} rad at the full rate of the faster servo), but a gait of \
                 another period is faster; --fixed-period certifies it as the farthest"
            )?;
        }
        Ok(())
    }
}
