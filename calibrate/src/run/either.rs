//! A run of a campaign, with a track or with stated results, during the fit.

use std::path::Path;

use swimmer_model::Swimmer;

use super::{Opposed, ReportedRun, Run, RunResult, opposed};
use crate::cycles::{Cycles, Projection};
use crate::error::CalibrateError;
use crate::fit::errors::RunErrors;
use crate::prediction::Played;

/// A run with a track or with stated results.
pub(crate) enum EitherRun<'a> {
    Tracked(Box<Run<'a>>),
    Reported(Box<ReportedRun>),
}

impl EitherRun<'_> {
    pub(crate) fn file(&self) -> &Path {
        match self {
            Self::Tracked(run) => &run.data.file,
            Self::Reported(run) => &run.file,
        }
    }

    pub(crate) fn period_s(&self) -> f64 {
        match self {
            Self::Tracked(run) => run.clock.period_s(),
            Self::Reported(run) => run.cycles.period_s,
        }
    }

    pub(crate) fn played(&self) -> Played {
        match self {
            Self::Tracked(run) => run.played(),
            Self::Reported(run) => run.played.clone(),
        }
    }

    /// Variances that the scatter between cycles does not show.
    pub(crate) fn errors(
        &self,
        cycles: &Cycles,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<RunErrors, CalibrateError> {
        match self {
            Self::Tracked(run) => run.errors(cycles, swimmer, projection),
            Self::Reported(_) => Ok(RunErrors::default()),
        }
    }

    pub(crate) fn start(
        &self,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<f64, CalibrateError> {
        match self {
            Self::Tracked(run) => run.start(swimmer, projection),
            Self::Reported(_) => Ok(0.0),
        }
    }

    pub(crate) fn settled(
        &mut self,
        start_s: f64,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<Cycles, CalibrateError> {
        match self {
            Self::Tracked(run) => run.settled(start_s, swimmer, projection),
            Self::Reported(run) => Ok(run.cycles.clone()),
        }
    }

    /// Returns `true` if X has the opposite sign of the model's, and about its size.
    pub(crate) fn opposes(
        &self,
        cycles: &Cycles,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<Option<Opposed>, CalibrateError> {
        let (played, name) = match self {
            Self::Tracked(run) => (&run.commanded, &run.data.gait_name),
            Self::Reported(run) => (&run.played, &run.gait),
        };
        Ok(opposed(
            cycles,
            played.path.predict(swimmer, projection)?.0.x_m,
            name.ends_with(":cw"),
        ))
    }

    pub(crate) fn finish(self, cycles: Cycles, errors: RunErrors) -> RunResult {
        match self {
            Self::Tracked(run) => run.finish(cycles, errors),
            Self::Reported(run) => run.finish(),
        }
    }
}
