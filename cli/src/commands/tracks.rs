//! `swimmer tracks`: what a tracking file holds, without fitting.

use std::fmt;
use std::path::PathBuf;

use calibrate::{TrackError, TrackSurvey, survey_file};
use serde::Serialize;

use crate::failure::{Failure, Outcome};
use crate::output::Output;
use crate::quantity::{Rows, Table};
use crate::recording::Recording;

/// Say what a tracking file holds: format, rate, unit, frames, points and their gaps
#[derive(Debug, clap::Args)]
pub(crate) struct Tracks {
    /// The tracking file
    file: PathBuf,
    #[command(flatten)]
    recording: Recording,
}

#[derive(Debug, Serialize)]
struct TracksOutput {
    #[serde(skip)]
    file: String,
    #[serde(flatten)]
    survey: TrackSurvey,
}

impl fmt::Display for TracksOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let survey = &self.survey;
        let rate = if survey.rate_hz > 0.0 {
            format!("{} Hz", survey.rate_hz)
        } else {
            "unknown".to_owned()
        };
        let mut rows = Rows::default();
        rows.row("format", survey.format.to_string())
            .row("rate", rate)
            .row("unit", survey.unit.to_string())
            .row("frames", survey.frames.to_string());
        let mut table = Table::new(["point", "kind", "present", "gaps", "longest gap"]);
        for point in &survey.points {
            table.line([
                point.name.clone(),
                point.kind.to_string(),
                point.present.to_string(),
                point.gaps.to_string(),
                point.longest_gap.to_string(),
            ]);
        }
        write!(f, "{}\n{rows}\n\n{table}", self.file)?;
        survey
            .warnings
            .iter()
            .try_for_each(|warning| write!(f, "\n  note: {warning}"))
    }
}

impl Tracks {
    /// Reads the file and answers.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let survey = survey_file(&self.file, &self.recording.options())?;
        output.print(&TracksOutput {
            file: self.file.display().to_string(),
            survey,
        });
        Ok(())
    }
}

impl From<TrackError> for Failure {
    /// A tracking file that cannot be read is bad input, whatever is wrong with it.
    fn from(error: TrackError) -> Self {
        Self::bad_input(&error)
    }
}
