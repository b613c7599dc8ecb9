//! Tracking files to poses, cycles and fitted parameters.
//!
//! ```text
//! bytes ──read_tracks──► TrackFile ──poses──► PoseTrack ──► Cycles ──► Fit: r_s, χ, intervals, residuals
//!          (tracks)                 (poses)             (cycles)    (fit)
//! ```
//! Where reflectors on the side links show the joint angles, the model swims these instead of the command (`joints`).
//! [`weigh_evidence`] then tells, on demand, what the data say beyond the fit: likelihood, profiles, ridge, bootstrap, outliers;
//! [`fit_further`] fits what else may be off, [`assess`] says whether the answer can be used, and [`advise`] what to measure next.
//! Lengths are metres, angles radians, times seconds. Nothing here opens a file, except [`CampaignData::load`] and
//! [`load_run`], which read what the caller names. [`predict`] is the model's side of the fit, for anyone who wants to know
//! beforehand what the cameras will see.

// Formulas in the docs read like the paper's: c_t, r_s.
#![allow(clippy::doc_markdown)]

mod advice;
pub mod assessment;
mod campaign;
pub mod cycles;
mod data;
mod error;
pub mod evidence;
pub mod fit;
mod golden;
pub mod joints;
mod least_squares;
mod median;
pub mod nuisance;
pub mod poses;
mod prediction;
mod quantities;
mod run;
mod sides;
pub mod tracks;

pub use advice::{Advice, Candidate, advise};
pub use assessment::{Assessment, Verdict, assess};
pub use campaign::calibrate_campaign;
pub use cycles::{
    Cycle, CycleError, CycleWarning, Cycles, LeftOut, Periodicity, Phase, Statistics, Timing,
};
pub use data::{CampaignData, RunData, load_run, load_tracks, survey_file, track_options};
pub use error::{CalibrateError, FitError};
pub use evidence::{Evidence, EvidenceOptions, weigh_evidence};
pub use fit::{
    CampaignFit, ExcludedRun, Fit, FitOptions, FitWarning, Intervals, RunResidual, c_t_form,
};
pub use joints::{Measured, MeasuredJoints, MeasuredServo};
pub use nuisance::{Further, FurtherFit, fit_further};
pub use poses::{
    Drift, FollowReport, FrontRule, Jump, Origin, PoseError, PoseOptions, PoseSample, PoseTrack,
    PoseWarning, Stretch, poses, usual_reflectors,
};
pub use prediction::{PredictedCycle, PredictionError, joint_path, predict};
pub use run::{RunResult, calibrate_run};
pub use tracks::{
    PointKind, PointPresence, TrackError, TrackFile, TrackFormat, TrackOptions, TrackPoint,
    TrackProblem, TrackSurvey, TrackWarning, Unit, read_tracks, read_tracks_with, survey_tracks,
};
