//! `swimmer tracks`: what a tracking file holds, without fitting.

use std::fmt;
use std::path::{Path, PathBuf};

use calibrate::TrackSurvey;
use operations::tracks::{self, Request};

use crate::context::perform;
use crate::failure::Outcome;
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

/// Survey of a file as text.
struct Text<'a> {
    file: &'a Path,
    survey: &'a TrackSurvey,
}

impl fmt::Display for Text<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let survey = self.survey;
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
        write!(f, "{}\n{rows}\n\n{table}", self.file.display())?;
        survey
            .warnings
            .iter()
            .try_for_each(|warning| write!(f, "\n  note: {warning}"))
    }
}

impl Tracks {
    /// Surveys the file.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let request = Request {
            file: self.file,
            recording: self.recording.request(),
        };
        let survey = perform(|context| tracks::run(&request, context))?;
        let text = Text {
            file: &request.file,
            survey: &survey,
        };
        output.rendered(&survey, &text);
        Ok(())
    }
}
