//! `swimmer optimize efficiency`: the gaits of most Lighthill efficiency.

use std::fmt;
use std::path::PathBuf;
use std::time::Instant;

use clap::ValueEnum;
use collocation::CollocationError;
use gait_optimizer::{
    Branch, EfficiencyError, EfficiencyProblem, Method, OptimalGait, efficiency, robust_efficiency,
};
use serde::Serialize;

use crate::arguments::load_swimmer;
use crate::bounds::WholeBounds;
use crate::failure::{Failure, Outcome};
use crate::output::{Output, verbose};
use crate::quantity::{self, Rows};

use super::answer::{Closing, Quarter, say_if_beyond};
use super::better::{Better, than_efficiency};
use super::robust::{RobustAnswer, Robustly, as_written, refused};
use super::timing::{ServoTiming, TimingAnswer};

/// Order of a robust gait's series unless told otherwise.
const ROBUST_ORDER: usize = 6;

/// Find a gait of most Lighthill efficiency by the maximum principle, with its certificate
///
/// Closed curves with the paper's two symmetries, run counter-clockwise at constant power. No guess is needed.
#[derive(Debug, clap::Args)]
pub(crate) struct Efficiency {
    /// purcell, robot, robot-slender or a swimmer file
    #[arg(long, value_name = "SWIMMER")]
    swimmer: String,
    /// Which optimum: small has X > 0, large has X < 0 and a start angle above 2 rad
    #[arg(long, value_name = "GAIT", default_value = "small")]
    gait: Which,
    /// What leads to the polish: Fourier series alone, collocation from a circle, or multiple shooting from a Fourier gait of low order
    #[arg(long, value_name = "METHOD", default_value = "auto")]
    method: How,
    #[command(flatten)]
    bounds: WholeBounds,
    #[command(flatten)]
    robustly: Robustly,
    /// Order of the Fourier series of a robust gait, 6 unless given
    #[arg(long, value_name = "N")]
    order: Option<usize>,
    #[command(flatten)]
    timing: ServoTiming,
    /// Write the gait, at constant power or as timed for the servos, as a gait file
    #[arg(short, long, value_name = "FILE")]
    pub(super) output: Option<PathBuf>,
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

impl Efficiency {
    pub(super) fn run(self, output: Output) -> Outcome {
        let file = load_swimmer(&self.swimmer)?;
        let branch = match self.gait {
            Which::Small => Branch::Small,
            Which::Large => Branch::Large,
        };
        let uncertain = self.robustly.load(&file)?;
        if uncertain.is_none() && self.order.is_some() {
            return Err(Failure::BadInput(
                "--order is that of a robust gait's Fourier series: give --robust FIT.json or --gain LOW HIGH"
                    .to_owned(),
            ));
        }
        let begun = Instant::now();
        let bounds = self.bounds.of(&file);
        if let Some((uncertainty, over)) = uncertain {
            let mut found = robust_efficiency(
                &file.swimmer,
                (branch, self.order.unwrap_or(ROBUST_ORDER)),
                &bounds,
                &uncertainty,
                over,
            )
            .map_err(|error| refused(error, &self.bounds))?;
            let seconds = begun.elapsed().as_secs_f64();
            let timing = self.timing.write(
                &as_written(&found.gait),
                (&file.name, &self.swimmer),
                self.output.as_deref(),
            )?;
            if let Some(timing) = &timing {
                found.gait.efficiency = timing.efficiency;
            }
            output.answer(&RobustAnswer::new(
                format!("{}, most efficiency, robust", file.name),
                "ξ",
                &found,
                timing,
                (seconds, self.output),
            ));
            return Ok(());
        }
        let problem = EfficiencyProblem {
            method: match self.method {
                How::Auto | How::Collocation => Method::Auto,
                How::Fourier => Method::Fourier,
                How::Shooting => Method::Shooting,
            },
            bounds,
            ..EfficiencyProblem::new(file.swimmer, branch)
        };
        let gait = match self.method {
            How::Collocation => collocation::efficiency(&problem)?,
            How::Auto | How::Fourier | How::Shooting => efficiency(&problem)?,
        };
        let seconds = begun.elapsed().as_secs_f64();
        let better = than_efficiency(&problem, &self.swimmer, &gait);
        say_if_beyond(&file, &gait);
        let timing =
            self.timing
                .write(&gait, (&file.name, &self.swimmer), self.output.as_deref())?;
        output.answer(&Found::new(
            file.name,
            &gait,
            timing,
            better,
            (seconds, self.output),
        ));
        Ok(())
    }
}

#[derive(Debug, Serialize)]
struct Found {
    #[serde(skip)]
    name: String,
    /// Of the gait that is written: as timed for the servos, else at constant power.
    efficiency: f64,
    /// Of the same curve at constant power, where the servos' timing is another.
    #[serde(skip_serializing_if = "Option::is_none")]
    efficiency_constant_power: Option<f64>,
    #[serde(flatten)]
    quarter: Quarter,
    /// Max-norm of the shooting conditions.
    #[serde(skip_serializing_if = "Option::is_none")]
    residual: Option<f64>,
    #[serde(skip_serializing_if = "Option::is_none")]
    power_variation: Option<f64>,
    /// What led to the start of the polish.
    #[serde(skip_serializing_if = "Option::is_none")]
    method: Option<&'static str>,
    /// The direct method's own value, before the polish.
    #[serde(skip_serializing_if = "Option::is_none")]
    direct_efficiency: Option<f64>,
    /// Of another class.
    #[serde(skip_serializing_if = "Option::is_none")]
    better: Option<Better>,
    #[serde(flatten)]
    closing: Closing,
}

impl Found {
    fn new(
        name: String,
        gait: &OptimalGait,
        timing: Option<TimingAnswer>,
        better: Option<Better>,
        (seconds, file): (f64, Option<PathBuf>),
    ) -> Self {
        let figures = gait.efficiency_figures;
        let timed = timing.as_ref().map(|timing| timing.efficiency);
        Self {
            name,
            efficiency: timed.unwrap_or(gait.efficiency),
            efficiency_constant_power: timed.map(|_| gait.efficiency),
            quarter: gait.into(),
            residual: figures.map(|figures| figures.residual),
            power_variation: figures.map(|figures| figures.power_variation),
            method: figures.map(|figures| figures.method),
            direct_efficiency: figures.and_then(|figures| figures.direct_efficiency),
            better,
            closing: Closing::new(gait, timing, seconds, file),
        }
    }
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row("efficiency ξ", format!("{:.12}", self.efficiency));
        if let Some(untimed) = self.efficiency_constant_power {
            rows.row("constant power", format!("ξ = {untimed:.12}"));
        }
        self.quarter.rows(&mut rows);
        if let Some(residual) = self.residual.filter(|_| verbose()) {
            let bound = if residual <= 1e-10 {
                "at most 1e-10"
            } else {
                "above 1e-10"
            };
            rows.row("residual", bound);
        }
        if let Some(method) = self.method.filter(|_| verbose()) {
            rows.row("method", method);
        }
        if let Some(direct) = self.direct_efficiency.filter(|_| verbose()) {
            let polished = self.efficiency_constant_power.unwrap_or(self.efficiency);
            let deviation = (direct / polished - 1.0).abs();
            rows.row(
                "before polish",
                format!("ξ off by {}", quantity::small(deviation)),
            );
        }
        rows.row(
            "best of",
            "the gaits with the paper's symmetries, in one neighbourhood; `swimmer atlas --objective efficiency` looks beyond",
        );
        if let Some(better) = &self.better {
            better.row(&mut rows);
        }
        self.closing.rows(&mut rows);
        write!(f, "{}, a local optimum of efficiency\n{rows}", self.name)
    }
}

impl From<EfficiencyError> for Failure {
    /// A problem that makes no sense is bad input; one without an optimum was tried.
    fn from(error: EfficiencyError) -> Self {
        if error.is_bad_input() {
            Self::bad_input(&error)
        } else {
            Self::tried_with_details(&error, error.details())
        }
    }
}

impl From<CollocationError> for Failure {
    fn from(error: CollocationError) -> Self {
        match error {
            CollocationError::Polish(error) => error.into(),
            other => Self::tried(&other),
        }
    }
}

#[cfg(test)]
mod tests {
    use swimmer_files::Bounds;

    use swimmer_files::{AnyGait, GaitFile};
    use swimmer_model::{Model, Swimmer, Tolerance, swim};

    use super::*;

    /// Servos at their limit cost efficiency, and what is told is that of the file.
    #[test]
    fn the_efficiency_is_that_of_the_gait_that_is_written() {
        let gait = efficiency(&EfficiencyProblem {
            bounds: Bounds {
                max_angle: Some(1.5),
                ..Bounds::default()
            },
            ..EfficiencyProblem::new(Swimmer::purcell(), Branch::Small)
        })
        .unwrap();
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("timed.gait");
        let told = |servos: ServoTiming| {
            let timing = servos
                .write(&gait, ("purcell", "purcell"), Some(&path))
                .unwrap();
            let found = Found::new("purcell".to_owned(), &gait, timing, None, (0.0, None));
            let file = AnyGait::from_file(&GaitFile::load(&path).unwrap()).unwrap();
            let model = Model::new(&Swimmer::purcell()).unwrap();
            let swum = swim(&model, &file, &Tolerance::default()).efficiency();
            (found, swum)
        };
        let (free, swum) = told(ServoTiming {
            max_rate: None,
            period: None,
        });
        assert!((free.efficiency / swum - 1.0).abs() < 1e-6);
        assert!(free.efficiency_constant_power.is_none());
        let (timed, swum) = told(ServoTiming {
            max_rate: Some(0.5),
            period: Some(15.12),
        });
        assert!((timed.efficiency / swum - 1.0).abs() < 1e-9, "{swum}");
        assert!(timed.efficiency < 0.95 * free.efficiency);
        assert_eq!(timed.efficiency_constant_power, Some(gait.efficiency));
        assert!(format!("{timed}").contains(&format!("{:.12}", timed.efficiency)));
    }
}
