//! `swimmer optimize efficiency`: the gaits of most Lighthill efficiency.

use clap::ValueEnum;
use collocation::CollocationError;
use gait_optimizer::{
    Branch, EfficiencyError, EfficiencyProblem, Method, OptimalGait, efficiency, robust_efficiency,
};
use swimmer_files::Bounds;

use super::closed::Closed;
use super::output::{add_quarter, say_if_beyond};
use super::robust::{Robustly, refused, robust_gait};
use super::timing::{ServoTiming, Timed};
use super::{Objective, SearchResult, Task};
use crate::bounds::CycleBounds;
use crate::document::Document;
use crate::failure::{Failure, Outcome};
use crate::output::verbose;
use crate::playable::searched;
use crate::quantity;

/// Default order of a robust gait's series.
const ROBUST_ORDER: usize = 6;

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
    fn search(&self, task: &Task) -> Outcome<SearchResult> {
        let branch = match self.gait {
            Which::Small => Branch::Small,
            Which::Large => Branch::Large,
        };
        let problem = EfficiencyProblem {
            method: match self.method {
                How::Auto | How::Collocation => Method::Auto,
                How::Fourier => Method::Fourier,
                How::Shooting => Method::Shooting,
            },
            bounds: self.bounds.of(&task.file),
            ..EfficiencyProblem::new(task.file.swimmer, branch)
        };
        if let Some((uncertainty, over)) = self.robustly.load(&task.file)? {
            let order = (branch, self.order.unwrap_or(ROBUST_ORDER));
            let (swimmer, bounds) = (&problem.swimmer, &problem.bounds);
            let found = task
                .timed(|| robust_efficiency(swimmer, order, bounds, &uncertainty, over))
                .map_err(|error| refused(error, &self.bounds))?;
            return robust_gait(task, ("efficiency", "ξ"), found, &self.timing);
        }
        if self.order.is_some() {
            return Err(Failure::BadInput(
                "--order is that of a robust gait's Fourier series: give --robust FIT.json or --gain LOW HIGH"
                    .to_owned(),
            ));
        }
        if !task.file.swimmer.is_symmetric() {
            return self.without_symmetry(task, problem.bounds);
        }
        let search = |bounds| {
            let problem = EfficiencyProblem { bounds, ..problem };
            match self.method {
                How::Collocation => collocation::efficiency(&problem).map_err(Failure::from),
                How::Auto | How::Fourier | How::Shooting => Ok(efficiency(&problem)?),
            }
        };
        let robot = (&task.file, self.bounds.playable());
        let gait = task.timed(|| searched(robot, problem.bounds, |gait| gait, search))?;
        say_if_beyond(task, &gait);
        let timed = self.timing.of(task, &gait)?;
        let document = document_of(&task.file.name, &gait, timed.as_ref());
        Ok(SearchResult::gait(document, task, &gait, timed))
    }
}

impl Efficiency {
    /// Best gait of the closed-curve search, for side links that differ.
    fn without_symmetry(&self, task: &Task, bounds: Bounds) -> Outcome<SearchResult> {
        if matches!(self.gait, Which::Large) || !matches!(self.method, How::Auto) {
            return Err(Failure::BadInput(
                "--gait large and --method are of gaits with the paper's symmetries, and the side links of this swimmer differ: \
                 leave them out"
                    .to_owned(),
            ));
        }
        let objective = swimmer_files::Objective::Efficiency;
        let found = Closed::search(task, objective, bounds, self.bounds.playable())?;
        let gait = found.gait();
        say_if_beyond(task, gait);
        let timed = self.timing.of(task, gait)?;
        let name = &task.file.name;
        let mut document = Document::new(format!("{name}, a local optimum of efficiency"));
        let as_written = timed
            .as_ref()
            .map_or(gait.efficiency, |timed| timed.efficiency);
        document
            .key("efficiency", as_written)
            .row("efficiency ξ", format!("{as_written:.12}"));
        found.add(&mut document, objective);
        Ok(SearchResult::gait(document, task, gait, timed))
    }
}

/// Output of a gait: its efficiency is that of the written gait.
fn document_of(name: &str, gait: &OptimalGait, timed: Option<&Timed>) -> Document {
    let mut document = Document::new(format!("{name}, a local optimum of efficiency"));
    let as_written = timed.map_or(gait.efficiency, |timed| timed.efficiency);
    document
        .key("efficiency", as_written)
        .row("efficiency ξ", format!("{as_written:.12}"));
    if timed.is_some() {
        document
            .key("efficiency_constant_power", gait.efficiency)
            .row("constant power", format!("ξ = {:.12}", gait.efficiency));
    }
    add_quarter(&mut document, gait);
    if let Some(figures) = gait.efficiency_figures {
        document
            // Max-norm of the shooting conditions.
            .key("residual", figures.residual)
            .key("power_variation", figures.power_variation)
            // Method of the initial guess, with that method's own value.
            .key("method", figures.method)
            .key_if("direct_efficiency", figures.direct_efficiency);
        if verbose() {
            let bound = if figures.residual <= 1e-10 {
                "at most 1e-10"
            } else {
                "above 1e-10"
            };
            document
                .row("residual", bound)
                .row("method", figures.method);
        }
        if let Some(direct) = figures.direct_efficiency.filter(|_| verbose()) {
            let deviation = quantity::small((direct / gait.efficiency - 1.0).abs());
            document.row("before polish", format!("ξ off by {deviation}"));
        }
    }
    document.row(
        "best of",
        "the gaits with the paper's symmetries, in one neighbourhood; `swimmer atlas --objective efficiency` looks beyond",
    );
    document
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
    use std::cell::Cell;

    use swimmer_files::AnyGait;
    use swimmer_model::{Model, Swimmer, Tolerance, swim};

    use super::*;
    use crate::arguments::load_swimmer;

    /// Servos at their limit cost efficiency, and the reported value is that of the file.
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
        let task = Task {
            file: load_swimmer("purcell").unwrap(),
            output: None,
            seconds: Cell::default(),
        };
        let found = |max_rate, period| {
            let timed = ServoTiming { max_rate, period }.of(&task, &gait).unwrap();
            let document = document_of("purcell", &gait, timed.as_ref());
            let found = SearchResult::gait(document, &task, &gait, timed);
            let file = AnyGait::from_file(&found.gaits[0].1).unwrap();
            let model = Model::new(&Swimmer::purcell()).unwrap();
            let swum = swim(&model, &file, &Tolerance::default()).efficiency();
            let keys = serde_json::to_value(&found.document).unwrap();
            let efficiency = keys["efficiency"].as_f64().unwrap();
            let untimed = keys.get("efficiency_constant_power").cloned();
            (efficiency, untimed, swum, found.document.to_string())
        };
        let (free, untimed, swum, _) = found(None, None);
        assert!((free / swum - 1.0).abs() < 1e-6);
        assert!(untimed.is_none());
        let (timed, untimed, swum, text) = found(Some(0.5), Some(15.12));
        assert!((timed / swum - 1.0).abs() < 1e-9, "{swum}");
        assert!(timed < 0.95 * free);
        assert_eq!(untimed.unwrap().as_f64(), Some(gait.efficiency));
        assert!(text.contains(&format!("{timed:.12}")));
    }
}
