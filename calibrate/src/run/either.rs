//! A run of a campaign, tracked or told, as the fit goes round with it.

use std::path::Path;

use swimmer_model::Swimmer;

use super::{Opposed, Run, RunResult, Told, opposed};
use crate::cycles::{Cycles, Projection};
use crate::error::CalibrateError;
use crate::prediction::Played;
use crate::quantities::QUANTITIES;

/// Tracked or told.
pub(crate) enum EitherRun<'a> {
    Tracked(Box<Run<'a>>),
    Told(Box<Told>),
}

impl EitherRun<'_> {
    pub(crate) fn file(&self) -> &Path {
        match self {
            Self::Tracked(run) => &run.data.file,
            Self::Told(run) => &run.file,
        }
    }

    pub(crate) fn period_s(&self) -> f64 {
        match self {
            Self::Tracked(run) => run.clock.period_s(),
            Self::Told(run) => run.cycles.period_s,
        }
    }

    pub(crate) fn played(&self) -> Played {
        match self {
            Self::Tracked(run) => run.played(),
            Self::Told(run) => run.played.clone(),
        }
    }

    pub(crate) fn path_variances(
        &self,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<[f64; QUANTITIES], CalibrateError> {
        match self {
            Self::Tracked(run) => run.path_variances(swimmer, projection),
            Self::Told(_) => Ok([0.0; QUANTITIES]),
        }
    }

    pub(crate) fn start(
        &self,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<f64, CalibrateError> {
        match self {
            Self::Tracked(run) => run.start(swimmer, projection),
            Self::Told(_) => Ok(0.0),
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
            Self::Told(run) => Ok(run.cycles.clone()),
        }
    }

    /// Whether X has the other sign than the model's, and about its size.
    pub(crate) fn opposes(
        &self,
        cycles: &Cycles,
        swimmer: &Swimmer<f64>,
        projection: &Projection,
    ) -> Result<Option<Opposed>, CalibrateError> {
        let told = match self {
            Self::Tracked(run) => &run.told,
            Self::Told(run) => &run.played,
        };
        Ok(opposed(
            cycles,
            told.path.predict(swimmer, projection)?.0.x_m,
        ))
    }

    pub(crate) fn finish(self, cycles: Cycles, path_variances: [f64; QUANTITIES]) -> RunResult {
        match self {
            Self::Tracked(run) => run.finish(cycles, path_variances),
            Self::Told(run) => run.finish(),
        }
    }
}
