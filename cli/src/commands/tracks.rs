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
struct Holdings {
    #[serde(skip)]
    file: String,
    format: String,
    /// Null where a single frame tells no rate.
    rate_hz: Option<f64>,
    unit: String,
    frames: usize,
    points: Vec<Point>,
    warnings: Vec<String>,
}

#[derive(Debug, Serialize)]
struct Point {
    name: String,
    kind: String,
    id: String,
    /// Frames in which it was seen.
    present: usize,
    gaps: usize,
    /// Frames of its longest gap.
    longest_gap: usize,
}

impl fmt::Display for Holdings {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let mut rows = Rows::default();
        rows.row("format", &self.format)
            .row(
                "rate",
                self.rate_hz
                    .map_or_else(|| "unknown".to_owned(), |rate| format!("{rate} Hz")),
            )
            .row("unit", &self.unit)
            .row("frames", self.frames.to_string());
        let mut table = Table::new(["point", "kind", "present", "gaps", "longest gap"]);
        for point in &self.points {
            table.line([
                point.name.clone(),
                point.kind.clone(),
                point.present.to_string(),
                point.gaps.to_string(),
                point.longest_gap.to_string(),
            ]);
        }
        write!(f, "{}\n{rows}\n\n{table}", self.file)?;
        self.warnings
            .iter()
            .try_for_each(|warning| write!(f, "\n  note: {warning}"))
    }
}

impl Tracks {
    /// Reads the file and answers.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let survey = survey_file(&self.file, &self.recording.options())?;
        output.answer(&Holdings::new(self.file.display().to_string(), survey));
        Ok(())
    }
}

impl Holdings {
    fn new(file: String, survey: TrackSurvey) -> Self {
        Self {
            file,
            format: survey.format.to_string(),
            rate_hz: Some(survey.rate_hz).filter(|rate| *rate > 0.0),
            unit: survey.unit.to_string(),
            frames: survey.frames,
            points: survey
                .points
                .into_iter()
                .map(|point| Point {
                    name: point.name,
                    kind: point.kind.to_string(),
                    id: point.id,
                    present: point.present,
                    gaps: point.gaps,
                    longest_gap: point.longest_gap,
                })
                .collect(),
            warnings: survey.warnings.iter().map(ToString::to_string).collect(),
        }
    }
}

impl From<TrackError> for Failure {
    /// A tracking file that cannot be read is bad input, whatever is wrong with it.
    fn from(error: TrackError) -> Self {
        Self::bad_input(&error)
    }
}
