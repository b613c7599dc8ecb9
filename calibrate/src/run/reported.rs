//! A run with stated results: nothing is followed, cut or measured.

use std::path::PathBuf;

use swimmer_files::{AnyGait, CampaignRun, ReportedResults, SwimmerFile};

use super::RunResult;
use crate::cycles::Cycles;
use crate::error::CalibrateError;
use crate::fit::errors::RunErrors;
use crate::poses::PoseTrack;
use crate::prediction::Played;

/// Stated results of a run, and its gait.
pub(crate) struct ReportedRun {
    index: usize,
    pub(super) file: PathBuf,
    pub(super) gait: String,
    pub(super) cycles: Cycles,
    pub(super) played: Played,
}

impl ReportedRun {
    pub(crate) fn begin(
        index: usize,
        (run, reported): (&CampaignRun, &ReportedResults),
        gait: &AnyGait,
        swimmer: &SwimmerFile,
    ) -> Result<Self, CalibrateError> {
        let period_s = run.period_s;
        let played = Played::commanded(gait, swimmer.servo.as_ref(), period_s);
        Ok(Self {
            index,
            file: run.track.clone(),
            gait: run.gait.to_string(),
            cycles: Cycles::reported(reported, period_s),
            played: played.map_err(|cause| CalibrateError::Prediction {
                file: run.track.clone(),
                cause,
            })?,
        })
    }

    pub(super) fn finish(self) -> RunResult {
        RunResult {
            index: self.index,
            file: self.file,
            gait: self.gait,
            cycles: self.cycles,
            poses: PoseTrack::none(),
            warnings: Vec::new(),
            reflector_distance_m: f64::NAN,
            joints: None,
            played: self.played,
            errors: RunErrors::default(),
        }
    }
}
