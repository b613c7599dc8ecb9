//! Tracking files to poses, cycles and fitted parameters.
//!
//! ```text
//! bytes ──read_tracks──► TrackFile ──poses──► PoseTrack ──► Cycles ──► Fit: r_s, χ, intervals, residuals
//!          (tracks)                 (poses)             (cycles)    (fit)
//! ```
//! [`weigh_evidence`] then tells, on demand, what the data say beyond the fit: likelihood, profiles, ridge, bootstrap, outliers;
//! [`fit_further`] fits what else may be off, and [`advise`] says what to measure next.
//! Lengths are metres, angles radians, times seconds. Nothing here opens a file, except [`CampaignData::load`] and
//! [`load_run`], which read what the caller names. [`predict`] is the model's side of the fit, for anyone who wants to know
//! beforehand what the cameras will see.

// Formulas in the docs read like the paper's: c_t, r_s.
#![allow(clippy::doc_markdown)]

mod advice;
mod campaign;
pub mod cycles;
pub mod evidence;
pub mod fit;
pub mod further;
mod golden;
mod median;
pub mod poses;
mod prediction;
pub mod tracks;

pub use advice::{Advice, Candidate, advise};
pub use campaign::{
    CalibrateError, CampaignData, CampaignFit, RunData, RunResult, calibrate_campaign,
    calibrate_run, load_run, load_tracks, track_options,
};
pub use cycles::{
    Cycle, CycleError, CycleWarning, Cycles, LeftOut, Phase, Repeats, Statistics, Timing,
};
pub use evidence::{Evidence, EvidenceOptions, weigh_evidence};
pub use fit::{Fit, FitError, FitOptions, FitWarning, Intervals, RunResidual, c_t_form};
pub use further::{Further, FurtherFit, fit_further};
pub use poses::{
    FrontRule, Jump, Origin, PoseError, PoseOptions, PoseSample, PoseTrack, PoseWarning, poses,
    usual_reflectors,
};
pub use prediction::{PredictedCycle, PredictionError, joint_path, predict};
pub use tracks::{
    PointKind, TrackError, TrackFile, TrackFormat, TrackOptions, TrackPoint, TrackProblem,
    TrackWarning, Unit, read_tracks, read_tracks_with,
};
