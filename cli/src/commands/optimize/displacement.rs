//! `swimmer optimize displacement`: the gait of most displacement per cycle.

use operations::optimize::GaitOutput;
use operations::optimize::displacement::{self, Output, Request, Sign, Symmetric};
use operations::{Context, SwimmerSource};

use super::Objective;
use super::robust::{self, Robustly};
use super::text::{add_closed, add_gait, add_quarter, titled};
use super::timing::ServoTiming;
use crate::bounds::QuarterBounds;
use crate::failure::Outcome;
use crate::quantity::Rows;

/// Find the simple gait of most displacement per cycle by the maximum principle, with its certificate
///
/// Simple closed curves with the paper's two symmetries, or any simple closed curve if the side links differ. The farthest gait of either sense, run so that it swims forwards (X > 0):
/// if that is clockwise, the arcs and the start angle printed are those of the counter-clockwise quarter. --sign takes the
/// local optimum of one sense instead, run counter-clockwise as in the paper: + for its gaits (a) and (b), - for (c) and (d).
#[derive(Debug, clap::Args)]
pub(crate) struct Displacement {
    #[command(flatten)]
    bounds: QuarterBounds,
    /// The sign of X, run counter-clockwise: + or -; the farther of both, swum forwards, unless given
    #[arg(long, value_name = "SIGN", value_parser = sign, allow_hyphen_values = true)]
    sign: Option<Sign>,
    #[command(flatten)]
    robustly: Robustly,
    #[command(flatten)]
    timing: ServoTiming,
}

impl Objective for Displacement {
    type Output = Output;

    fn search(&self, swimmer: SwimmerSource, context: &mut Context) -> Outcome<Output> {
        let request = Request {
            swimmer,
            bounds: self.bounds.into(),
            sign: self.sign,
            robust: self.robustly.request()?,
            timing: self.timing.request(),
        };
        Ok(displacement::run(&request, context)?)
    }

    fn gait(output: &mut Output) -> &mut GaitOutput {
        output.gait_mut()
    }

    fn text(output: &Output) -> String {
        let mut rows = Rows::default();
        let name = match output {
            Output::Robust(output) => return robust::text(output),
            Output::Closed(output) => {
                add_closed(&mut rows, &output.curve);
                &output.name
            }
            Output::Symmetric(output) => {
                add_quarter(&mut rows, &output.quarter);
                rows.row("best of", class(output));
                &output.name
            }
        };
        add_gait(&mut rows, output.gait());
        titled(&format!("{name}, a local optimum of displacement"), &rows)
    }
}

/// The class of gaits in which this one is the best.
fn class(output: &Symmetric) -> String {
    let of = match output.extremals {
        None => String::new(),
        Some(1) => "the only extremal found ".to_owned(),
        Some(count) => format!("the {count} extremals found "),
    };
    let is_clockwise = output.quarter.clockwise == Some(true);
    let sign_of_x = if (output.quarter.displacement_m > 0.0) == is_clockwise {
        "<"
    } else {
        ">"
    };
    let both = match output.sign {
        None => ", the farther sense",
        Some(_) => "",
    };
    format!(
        "{of}with the paper's symmetries and X {sign_of_x} 0 counter-clockwise{both}; `swimmer atlas --objective displacement` \
         looks beyond"
    )
}

fn sign(text: &str) -> Result<Sign, String> {
    match text {
        "+" => Ok(Sign::Plus),
        "-" => Ok(Sign::Minus),
        _ => Err("write + or -".to_owned()),
    }
}
