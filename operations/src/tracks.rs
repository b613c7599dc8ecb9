//! Survey of a tracking file: what it holds, without fitting.

use std::path::{Path, PathBuf};

use calibrate::{TrackOptions, TrackSurvey, survey_file};

use crate::{Context, Error, Files};

/// Survey of a tracking file.
#[derive(Debug, Clone, PartialEq)]
pub struct Request {
    /// The file.
    pub file: PathBuf,
    /// Properties of the recording that the file does not state.
    pub recording: Recording,
}

/// Properties of a recording that its file does not state.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Recording {
    /// Metres per unit of the file.
    pub scale: Option<f64>,
    /// Frames per second.
    pub rate: Option<f64>,
    /// The file's axes that are the tank's x and y.
    pub axes: Option<swimmer_files::Axes>,
    /// Least likelihood of a point that counts.
    pub likelihood: Option<f64>,
}

impl Recording {
    /// Options of the reader.
    pub fn options(&self) -> TrackOptions {
        TrackOptions {
            metres_per_unit: self.scale,
            rate_hz: self.rate,
            axes: self.axes,
            likelihood: self.likelihood,
            ..TrackOptions::default()
        }
    }
}

/// Surveys the file. The output is the JSON document of `swimmer tracks`.
///
/// # Errors
/// The file cannot be read.
pub fn run(request: &Request, context: &mut Context) -> Result<TrackSurvey, Error> {
    if context.files == Files::Unavailable {
        return Err(no_file_system(&request.file));
    }
    Ok(survey_file(&request.file, &request.recording.options())?)
}

fn no_file_system(file: &Path) -> Error {
    Error::refused(format!(
        "cannot read {}: there is no file system",
        file.display()
    ))
}
