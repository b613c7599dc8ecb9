//! Tracking files to poses, cycles and fitted parameters.
//!
//! ```text
//! bytes ──read_tracks──► TrackFile ──poses──► PoseTrack ──► Cycles ──► Fit: r_s, χ, intervals, residuals
//!          (tracks)                 (poses)             (cycles)    (fit)
//! ```
//! If reflectors on the side links measure the joint angles, the model follows these instead of the command (`joints`).
//! [`weigh_evidence`] computes, on demand, likelihood, profiles, ridge, bootstrap and outliers; [`fit_nuisance`] fits nuisance
//! parameters, [`assess`] judges if the result can be used, and [`advise`] proposes further runs. Lengths are metres, angles
//! radians, times seconds. Nothing here opens a file, except [`CampaignData::load`] and
//! [`load_run`], which read what the caller names. [`predict`] is the model's side of the fit, for anyone who wants to know
//! beforehand what the cameras will see.
//!
//! A fit of six runs with stated results, as in a paper's figure:
//!
//! ```
//! use std::fmt::Write;
//! use calibrate::{CampaignData, EvidenceOptions, FitOptions, JointEstimate, NuisanceParameter, advise, amplitude_by_sway, assess};
//! use calibrate::{calibrate_campaign, fit_nuisance};
//! use calibrate::{other_gaits, predict, weigh_evidence};
//! use swimmer_files::{AnyGait, Campaign, SwimmerFile};
//!
//! let truth = SwimmerFile::preset("robot").unwrap();
//! let mut text = "swimmer = \"robot-slender\"\n".to_owned();
//! for degrees in [40_u8, 50, 60, 70, 80, 90] {
//!     let cycle = predict(&truth, &AnyGait::circle(f64::from(degrees).to_radians()), 30.0).unwrap();
//!     write!(
//!         text,
//!         "[[run]]\ngait = \"circle:{degrees}deg\"\nperiod_s = 30.0\ncycles = 5\nx_mm = {:?}\nx_se_mm = 0.01\n\
//!          delta_y_mm = {:?}\ndelta_y_se_mm = 0.01\ndelta_theta_deg = {:?}\ndelta_theta_se_deg = 0.01\n",
//!         1e3 * cycle.x_m,
//!         1e3 * cycle.delta_y_m,
//!         cycle.delta_theta_rad.to_degrees(),
//!     )?;
//! }
//! let mut campaign = Campaign::parse(&text, "campaign.toml".as_ref())?;
//! campaign.swimmer.swimmer.tangential_drag = truth.swimmer.tangential_drag;
//!
//! let data = CampaignData::load(&campaign)?;
//! let found = calibrate_campaign(&campaign, &data, FitOptions::default())?;
//! assert!((found.fit.chi / truth.swimmer.chi - 1.0).abs() < 1e-3);
//! assert!((found.fit.sphere_radius / truth.swimmer.sphere_radius - 1.0).abs() < 1e-3);
//!
//! // Each run swam the gait that is stated; the same sway with a stated amplitude of 44° is reported.
//! assert!(other_gaits(&campaign, &found.runs, &found.swimmer).is_empty());
//! campaign.runs[0].gait = swimmer_files::GaitSpec::Circle { amplitude: 44_f64.to_radians(), clockwise: false };
//! let other = other_gaits(&campaign, &found.runs, &found.swimmer)[0];
//! assert!((other.sways_like_rad.to_degrees() - 40.0).abs() < 0.1, "{other}");
//! let (_, factor) = amplitude_by_sway(&found.runs[0], &campaign.runs[0].gait, 30.0, &truth).unwrap();
//! assert!((factor - 40.0 / 44.0).abs() < 1e-3);
//!
//! let evidence = weigh_evidence(&found, EvidenceOptions { draws: 50, seed: 1 })?;
//! let estimate = JointEstimate::of(&found)?;
//! let assessment = assess(&found, &estimate, Some(&evidence));
//! assert_ne!(assessment.verdict.word(), "do not use", "{:?}", assessment.reasons);
//! assert!(!advise(&campaign, &found, &estimate)?.candidates.is_empty());
//! let scale = fit_nuisance(&found, &[NuisanceParameter::Scale])?;
//! assert_eq!(scale.parameters.len(), 3);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

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
mod link_log;
mod median;
pub mod nuisance;
pub mod poses;
mod prediction;
mod quantities;
mod run;
mod sides;
pub mod student;
pub mod tracks;
mod walls;
mod wrong_gait;

pub use advice::{Advice, Candidate, advise};
pub use assessment::{Assessment, JointEstimate, Verdict, assess};
pub use campaign::calibrate_campaign;
pub use cycles::{
    Cycle, CycleError, CycleWarning, Cycles, LeftOut, Loss, Periodicity, Phase, Statistics, Timing,
};
pub use data::{
    CampaignData, RunData, load_run, load_run_of, load_tracks, survey_file, track_options,
};
pub use error::{CalibrateError, FitError};
pub use evidence::{Evidence, EvidenceOptions, weigh_evidence};
pub use fit::{
    CampaignFit, ExcludedRun, Fit, FitOptions, FitWarning, Intervals, RunResidual, c_t_form,
};
pub use joints::{Measured, MeasuredJoints, MeasuredServo, SideFollower, SideSighting};
pub use nuisance::{NuisanceFit, NuisanceParameter, fit_nuisance};
pub use poses::{
    Drift, End, FollowReport, FollowedPair, FrontRule, Jump, Origin, PairFollower, PoseError,
    PoseOptions, PoseSample, PoseTrack, PoseWarning, Sighting, Stretch, pose_of_pair, poses,
    usual_reflectors,
};
pub use prediction::{PredictedCycle, PredictionError, joint_path, predict};
pub use run::{RunResult, calibrate_run};
pub use tracks::{
    PointKind, PointPresence, TrackError, TrackFile, TrackFormat, TrackOptions, TrackPoint,
    TrackProblem, TrackSurvey, TrackWarning, Unit, UsedPoints, is_called, read_tracks,
    read_tracks_with, survey_tracks,
};
pub use wrong_gait::{OtherGait, amplitude_by_sway, other_gaits};
