//! Errors of a calibration, from a campaign's files to its fit.

use std::path::PathBuf;

use swimmer_files::{FileError, LinkLogError};
use swimmer_model::InvalidSwimmer;

use crate::cycles::CycleError;
use crate::poses::PoseError;
use crate::prediction::PredictionError;
use crate::tracks::TrackError;

/// Error of a calibration.
#[derive(Debug, thiserror::Error)]
pub enum CalibrateError {
    /// A tracking file or a link log cannot be opened.
    #[error("cannot read {}: {cause}", file.display())]
    Open {
        /// The file.
        file: PathBuf,
        /// Why, and what to do about it.
        cause: String,
    },
    /// A tracking file is broken, or in a format that is not read.
    #[error(transparent)]
    Track(#[from] TrackError),
    /// A gait file is wrong.
    #[error(transparent)]
    File(#[from] FileError),
    /// A link log is broken.
    #[error(transparent)]
    Log(#[from] LinkLogError),
    /// A link log does not say which of its plays a run was.
    #[error("{}: {problem}", log.display())]
    Play {
        /// The log.
        log: PathBuf,
        /// Missing key.
        problem: String,
    },
    /// A track gave no poses.
    #[error("{}: {cause}", file.display())]
    Poses {
        /// The tracking file.
        file: PathBuf,
        /// Why.
        cause: PoseError,
    },
    /// A track gave no cycles.
    #[error("{}: {cause}", file.display())]
    Cycles {
        /// The tracking file.
        file: PathBuf,
        /// Why.
        cause: CycleError,
    },
    /// A gait could not have been played.
    #[error("{}: {cause}", file.display())]
    Prediction {
        /// The tracking file of the run.
        file: PathBuf,
        /// Why.
        cause: PredictionError,
    },
    /// Nothing was fitted.
    #[error(transparent)]
    Fit(#[from] FitError),
}

impl CalibrateError {
    /// Returns `true` if the input is at fault (exit 2), `false` if the outcome is (exit 1).
    pub fn is_bad_input(&self) -> bool {
        match self {
            Self::Open { .. }
            | Self::Track(_)
            | Self::File(_)
            | Self::Log(_)
            | Self::Play { .. }
            | Self::Prediction { .. } => true,
            Self::Poses { cause, .. } => {
                matches!(
                    cause,
                    PoseError::NoPoint { .. }
                        | PoseError::SamePlace
                        | PoseError::SamePoint { .. }
                        | PoseError::NoScale { .. }
                        | PoseError::NoBody { .. }
                        | PoseError::BodyUnseen { .. }
                        | PoseError::BodyAxis { .. }
                )
            }
            Self::Fit(cause) => matches!(
                cause,
                FitError::Level { .. } | FitError::Swimmer(_) | FitError::Measured { .. }
            ),
            Self::Cycles { .. } => false,
        }
    }
}

impl From<InvalidSwimmer> for CalibrateError {
    fn from(cause: InvalidSwimmer) -> Self {
        Self::Fit(FitError::Swimmer(cause))
    }
}

/// Error of a fit.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum FitError {
    /// The starting swimmer is invalid.
    #[error("{0}")]
    Swimmer(#[from] InvalidSwimmer),
    /// A level that is no share.
    #[error("the level of the intervals is {level}; give a share between 0 and 1, such as 0.95")]
    Level {
        /// The level.
        level: f64,
    },
    /// One of X, ΔY, Δθ is zero in all runs, so the criterion is undefined.
    #[error("{quantity} is zero in all runs, so the criterion cannot be scaled by it")]
    NothingMeasured {
        /// Name of the quantity.
        quantity: &'static str,
    },
    /// X has the other sign than the model's in too many runs.
    #[error(
        "in {opposed} of {runs} runs the robot swam against the model ({files}; X of the first: {measured_m:.5} m, model \
         {predicted_m:.5} m); either the gaits ran {direction} `gait`), or front and back reflectors are exchanged (exchange `at`)"
    )]
    SignOpposes {
        /// In how many.
        opposed: usize,
        /// Number of runs.
        runs: usize,
        /// Which.
        files: String,
        /// The first one's X \[m\].
        measured_m: f64,
        /// Displacement of the model \[m\].
        predicted_m: f64,
        /// The direction that the first one must have run in, and the change of its name.
        direction: &'static str,
    },
    /// The data do not determine some combination of the requested parameters.
    #[error(
        "these runs do not determine {parameters} together; fit fewer parameters, or measure other gaits and amplitudes"
    )]
    Undetermined {
        /// Their names.
        parameters: String,
    },
    /// The parameter was measured.
    #[error(
        "{parameter} cannot be fitted: the reflectors on the side links show the joint angles of all runs, so that it is measured \
         (`joints` in the answer); leave it out of --fit-also"
    )]
    Measured {
        /// The parameter.
        parameter: &'static str,
    },
    /// No start led anywhere.
    #[error(
        "the fit did not converge from any of {starts} starts; look at X, ΔY and Δθ of the runs first"
    )]
    NoConvergence {
        /// Number of starts.
        starts: usize,
    },
}
