//! `swimmer optimize efficiency`: the gaits of most Lighthill efficiency.

use clap::ValueEnum;
use operations::optimize::efficiency::{self, Method, Optimum, Output, Request, Symmetric};
use operations::optimize::{EfficiencyFigures, GaitOutput};
use operations::{Context, SwimmerSource};

use super::Objective;
use super::robust::{self, Robustly};
use super::text::{add_closed, add_gait, add_quarter, titled};
use super::timing::ServoTiming;
use crate::bounds::CycleBounds;
use crate::failure::Outcome;
use crate::output::verbose;
use crate::quantity::{self, Rows};

/// Find a gait of most Lighthill efficiency by the maximum principle, with its certificate
///
/// Closed curves with the paper's two symmetries, or any closed curve if the side links differ, run counter-clockwise at constant power. No guess is needed.
#[derive(Debug, clap::Args)]
pub(crate) struct Efficiency {
    /// Local optimum: small has X > 0, large has X < 0 and a start angle above 2 rad
    #[arg(long, value_name = "GAIT", default_value = "small")]
    gait: Which,
    /// Method of the initial guess: Fourier series alone, collocation from a circle, or multiple shooting from a Fourier gait of
    /// low order
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    method: How,
    #[command(flatten)]
    bounds: CycleBounds,
    #[command(flatten)]
    robustly: Robustly,
    /// Order of the Fourier series of a robust gait, 6 unless given
    #[arg(long, value_name = "N")]
    order: Option<usize>,
    #[command(flatten)]
    timing: ServoTiming,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum Which {
    Small,
    Large,
}

#[derive(Debug, Clone, Copy, ValueEnum)]
enum How {
    Auto,
    Fourier,
    Collocation,
    Shooting,
}

impl Objective for Efficiency {
    type Output = Output;

    fn search(&self, swimmer: SwimmerSource, context: &mut Context) -> Outcome<Output> {
        let request = Request {
            swimmer,
            optimum: match self.gait {
                Which::Small => Optimum::Small,
                Which::Large => Optimum::Large,
            },
            method: match self.method {
                How::Auto => Method::Auto,
                How::Fourier => Method::Fourier,
                How::Collocation => Method::Collocation,
                How::Shooting => Method::Shooting,
            },
            bounds: self.bounds.into(),
            robust: self.robustly.request()?,
            order: self.order,
            timing: self.timing.request(),
        };
        Ok(efficiency::run(&request, context)?)
    }

    fn gait(output: &mut Output) -> &mut GaitOutput {
        output.gait_mut()
    }

    fn text(output: &Output) -> String {
        let mut rows = Rows::default();
        let name = match output {
            Output::Robust(output) => return robust::text(output),
            Output::Closed(output) => {
                rows.row("efficiency ξ", format!("{:.12}", output.efficiency));
                add_closed(&mut rows, &output.curve);
                &output.name
            }
            Output::Symmetric(output) => {
                add_symmetric(&mut rows, output);
                &output.name
            }
        };
        add_gait(&mut rows, output.gait());
        titled(&format!("{name}, a local optimum of efficiency"), &rows)
    }
}

/// Adds a gait with the paper's symmetries.
fn add_symmetric(rows: &mut Rows, output: &Symmetric) {
    rows.row("efficiency ξ", format!("{:.12}", output.efficiency));
    if let Some(constant_power) = output.efficiency_constant_power {
        rows.row("constant power", format!("ξ = {constant_power:.12}"));
    }
    add_quarter(rows, &output.quarter);
    if let Some(figures) = output.figures.filter(|_| verbose()) {
        add_figures(rows, &figures, output);
    }
    rows.row(
        "best of",
        "the gaits with the paper's symmetries, in one neighbourhood; `swimmer atlas --objective efficiency` looks beyond",
    );
}

/// Adds details for experts.
fn add_figures(rows: &mut Rows, figures: &EfficiencyFigures, output: &Symmetric) {
    let bound = if figures.residual.is_some_and(|residual| residual <= 1e-10) {
        "at most 1e-10"
    } else {
        "above 1e-10"
    };
    rows.row("residual", bound).row("method", figures.method);
    if let Some(direct) = figures.direct_efficiency {
        let polished = output
            .efficiency_constant_power
            .unwrap_or(output.efficiency);
        let deviation = quantity::small((direct / polished - 1.0).abs());
        rows.row("before polish", format!("ξ off by {deviation}"));
    }
}
