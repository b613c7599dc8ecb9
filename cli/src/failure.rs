//! The ways a command can go wrong, and the exit status each of them has.

use calibrate::{CalibrateError, TrackError};
use forecast::{ForecastError, TimingError};
use gait_optimizer::{AtlasError, SpeedError};
use operations::{Error, ErrorKind};
use swimmer_files::FileError;
use swimmer_model::{InvalidSwimmer, UncommonDrag};

use crate::new_folder::with_places;
use crate::output::verbose;

/// Failure of a command; the text names the action, its object, and the next step.
#[derive(Debug, thiserror::Error)]
pub(crate) enum Failure {
    /// It was tried and did not work: no convergence, the robot refused, no answer. Exit status 1.
    #[error("{0}")]
    Tried(String),
    /// The link to the robot was lost: the same may work once the robot replies again. Exit status 1.
    #[error("{0}")]
    LinkLost(String),
    /// It was tried and failed, and the printed output already says so: the reason goes to standard error alone. Exit status 1.
    #[error("{0}")]
    AlreadyPrinted(String),
    /// The arguments, or a named file, are invalid. Exit status 2.
    #[error("{0}")]
    BadInput(String),
}

/// Exit status of bad usage and of bad input.
pub(crate) const BAD_INPUT: u8 = 2;

/// The result of every command.
pub(crate) type Outcome<T = ()> = Result<T, Failure>;

impl Failure {
    /// A job that was tried and failed, with every cause that the error names.
    pub(crate) fn tried(error: &dyn std::error::Error) -> Self {
        Error::failed(error).into()
    }

    /// Input that cannot be used, with every cause that the error names.
    pub(crate) fn bad_input(error: &dyn std::error::Error) -> Self {
        Error::bad_input(error).into()
    }

    /// The exit status that scripts see.
    pub(crate) fn status(&self) -> u8 {
        match self {
            Self::Tried(_) | Self::LinkLost(_) | Self::AlreadyPrinted(_) => 1,
            Self::BadInput(_) => BAD_INPUT,
        }
    }

    /// The same for a caller in the same process.
    pub(crate) fn into_error(self) -> Error {
        let message = with_places(&self.to_string());
        match self {
            Self::BadInput(_) => Error::refused(message),
            Self::Tried(_) | Self::LinkLost(_) | Self::AlreadyPrinted(_) => {
                Error::unsuccessful(message)
            }
        }
    }
}

impl From<Error> for Failure {
    fn from(error: Error) -> Self {
        match error.kind {
            ErrorKind::BadInput => Self::BadInput(error.message),
            ErrorKind::Failed => Self::Tried(match error.details {
                None => error.message,
                Some(details) if verbose() => format!("{}\n  {details}", error.message),
                Some(_) => format!("{} (--verbose prints details)", error.message),
            }),
        }
    }
}

impl From<UncommonDrag> for Failure {
    fn from(reason: UncommonDrag) -> Self {
        Self::bad_input(&InvalidSwimmer::Uncommon(reason))
    }
}

/// Errors of libraries whose kind `operations` decides.
macro_rules! by_operations {
    ($($error:ty),* $(,)?) => {$(
        impl From<$error> for Failure {
            fn from(error: $error) -> Self {
                Error::from(error).into()
            }
        }
    )*};
}

by_operations!(
    AtlasError,
    CalibrateError,
    FileError,
    ForecastError,
    SpeedError,
    TimingError,
    TrackError,
);
