//! `swimmer track`: shows what the cameras see, and records it.

use std::fmt::{self, Write as _};
use std::path::PathBuf;
use std::time::Duration;

use pose_source::{
    BodyCount, Pace, PointCount, Received, Recorder, Settings, SourceError, SourceName, Stream,
    Summary, Survey, Tallies,
};
use serde::Serialize;

use crate::arguments::seconds;
use crate::failure::{Failure, Outcome};
use crate::interrupt::Interrupt;
use crate::new_file::may_be_written;
use crate::output::Output;
use crate::quantity::{Rows, Table};
use crate::recording::Recording;

/// Interval between two lines for people \[s\].
const LINE_EVERY_S: f64 = 1.0;
/// Interval at which Ctrl-C is checked.
const TURN: Duration = Duration::from_millis(100);
/// A motion-capture system that replies but streams nothing for this time is not streaming \[s\].
const PATIENCE_S: f64 = 10.0;
/// Number of points whose places fit into a line.
const SHOWN_POINTS: usize = 4;

/// Show what the cameras see, and record it: rate, points, latency, blanks, jumps
#[derive(Debug, clap::Args)]
pub(crate) struct Track {
    /// natnet[:HOST[,LOCAL]] (Motive), tcp:HOST:PORT (JSON lines), - (JSON lines on standard input), a recording, or twin
    source: SourceName,
    /// Record the frames here; nothing may be there yet
    #[arg(short, long, value_name = "FILE.csv|.mcap")]
    output: Option<PathBuf>,
    /// End after this many seconds of the camera clock
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    seconds: Option<f64>,
    /// Read a recording, or run the twin, as fast as possible instead of at its own pace
    #[arg(long)]
    fast: bool,
    #[command(flatten)]
    recording: Recording,
}

#[derive(Debug, Serialize)]
struct TrackOutput {
    source: String,
    description: Option<String>,
    frames: u64,
    duration_s: f64,
    rate_hz: Option<f64>,
    points: Vec<PointCount>,
    unlabeled: f64,
    bodies: Vec<BodyCount>,
    latency_ms: Option<f64>,
    jitter_ms: Option<f64>,
    blanks: u64,
    jumps: u64,
    lost_frames: u64,
    malformed: u64,
    dropped: u64,
    out_of_order: u64,
    recorded: Option<String>,
    warnings: Vec<String>,
}

impl Track {
    /// Reads to the end, or until Ctrl-C.
    pub(crate) fn run(self, output: Output) -> Outcome {
        let mut recorder = self.recorder()?;
        let interrupt = Interrupt::install()?;
        let settings = Settings {
            options: self.recording.options(),
            pace: if self.fast {
                Pace::Fast
            } else {
                Pace::Recorded
            },
        };
        let stream = Stream::open(&self.source, &settings)?;
        let mut survey = Survey::default();
        let (mut first_s, mut line_s) = (None, LINE_EVERY_S);
        let outcome = loop {
            if interrupt.requested() {
                break Ok(());
            }
            match stream.next(TURN) {
                Received::Frame(frame) => {
                    let begun_s = *first_s.get_or_insert(frame.stamp_s);
                    if self
                        .seconds
                        .is_some_and(|end| frame.stamp_s - begun_s >= end)
                    {
                        break Ok(());
                    }
                    if let Some(recorder) = &mut recorder {
                        recorder
                            .write(&frame)
                            .map_err(|error| Failure::tried(&error))?;
                    }
                    survey.push(&frame);
                }
                Received::Ended(outcome) => break outcome,
                Received::Nothing => self.check_patience(&stream, &survey)?,
            }
            if !self.fast && stream.now_s() >= line_s {
                line_s = stream.now_s() + LINE_EVERY_S;
                output.line(&line(stream.now_s(), &survey));
            }
        };
        let written = recorder.map(Recorder::finish).transpose();
        outcome?;
        written.map_err(|error| Failure::tried(&error))?;
        if survey.summary().frames == 0 {
            return Err(Failure::Tried(format!(
                "{} ended without a frame{}",
                self.source,
                malformed(&stream.tallies()).map_or_else(String::new, |text| format!(": {text}"))
            )));
        }
        output.print(&self.answer(survey.summary(), stream.tallies()));
        Ok(())
    }

    fn recorder(&self) -> Outcome<Option<Recorder>> {
        let Some(path) = &self.output else {
            return Ok(None);
        };
        may_be_written(path)?;
        match Recorder::create(path).map_err(|error| Failure::tried(&error))? {
            Some(recorder) => Ok(Some(recorder)),
            None => Err(Failure::BadInput(format!(
                "cannot record to {}: name a file that ends in .csv or .mcap",
                path.display()
            ))),
        }
    }

    /// A script may load a network first; a motion-capture system streams at once.
    fn check_patience(&self, stream: &Stream, survey: &Survey) -> Outcome {
        let waits = matches!(self.source, SourceName::NatNet(_)) && survey.summary().frames == 0;
        if waits && stream.now_s() > PATIENCE_S {
            let replied = stream.tallies().description.unwrap_or_default();
            return Err(Failure::Tried(format!(
                "{} replies ({replied}) and sends no frame: start its cameras, or playback in edit mode",
                self.source
            )));
        }
        Ok(())
    }

    fn answer(&self, summary: Summary, tallies: Tallies) -> TrackOutput {
        let live = matches!(
            self.source,
            SourceName::NatNet(_) | SourceName::Tcp(_) | SourceName::StandardInput
        );
        let milliseconds = |seconds: f64| 1e3 * seconds;
        let mut warnings: Vec<String> = malformed(&tallies).into_iter().collect();
        if tallies.restarts > 0 {
            warnings.push(format!(
                "the camera clock was set back {} times",
                tallies.restarts
            ));
        }
        if summary.upright {
            warnings.push(
                "the points move up and down more than in the plane: are the axes right? --axes says which of the source's are the \
                 tank's x and y"
                    .to_owned(),
            );
        }
        TrackOutput {
            source: self.source.to_string(),
            description: tallies.description,
            frames: summary.frames,
            duration_s: summary.duration_s,
            rate_hz: summary.rate_hz,
            points: summary.points,
            unlabeled: summary.unlabeled,
            bodies: summary.bodies,
            latency_ms: summary.latency_s.map(milliseconds),
            jitter_ms: summary.jitter_s.filter(|_| live).map(milliseconds),
            blanks: summary.blanks,
            jumps: summary.jumps,
            lost_frames: summary.lost_frames,
            malformed: tallies.malformed,
            dropped: tallies.dropped,
            out_of_order: tallies.out_of_order,
            recorded: self.output.as_ref().map(|path| path.display().to_string()),
            warnings,
        }
    }
}

fn malformed(tallies: &Tallies) -> Option<String> {
    let last = tallies.last_malformed.as_ref()?;
    Some(format!(
        "{} malformed lines or datagrams were skipped; the last: {last}",
        tallies.malformed
    ))
}

/// Present state in one line.
fn line(now_s: f64, survey: &Survey) -> String {
    let summary = survey.summary();
    let rate = summary
        .rate_hz
        .map_or_else(|| "no frames".to_owned(), |hz| format!("{hz:.1} Hz"));
    // Writing to a text cannot fail.
    let mut text = format!(
        "{now_s:7.1} s  {rate}  {} frames  {} blanks  {} jumps",
        summary.frames, summary.blanks, summary.jumps
    );
    if let Some(latency_s) = summary.latency_s {
        let _ = write!(text, "  latency {:.1} ms", latency_s * 1e3);
    }
    for (name, [x_m, y_m, _]) in survey.last_places().take(SHOWN_POINTS) {
        let _ = write!(text, "  {name} ({x_m:.3}, {y_m:.3}) m");
    }
    text
}

impl fmt::Display for TrackOutput {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let or_unknown = |value: Option<f64>, unit: &str| {
            value.map_or_else(
                || "unknown".to_owned(),
                |value| format!("{value:.1} {unit}"),
            )
        };
        let mut rows = Rows::default();
        if let Some(description) = &self.description {
            rows.row("source", description.clone());
        }
        let lost = if self.lost_frames > 0 {
            format!(", {} lost between them", self.lost_frames)
        } else {
            String::new()
        };
        rows.row("rate", or_unknown(self.rate_hz, "Hz"))
            .row(
                "frames",
                format!("{} in {:.2} s{lost}", self.frames, self.duration_s),
            )
            .row("latency", or_unknown(self.latency_ms, "ms"));
        if let Some(jitter_ms) = self.jitter_ms {
            rows.row("jitter", format!("{jitter_ms:.1} ms (95 %)"));
        }
        rows.row("blanks", format!("{} frames", self.blanks))
            .row("jumps", self.jumps.to_string())
            .row("unlabeled", format!("{:.2} points a frame", self.unlabeled));
        for body in &self.bodies {
            rows.row("body", format!("{}, in {} frames", body.name, body.present));
        }
        for (label, count) in [
            ("dropped", self.dropped),
            ("out of order", self.out_of_order),
        ] {
            if count > 0 {
                rows.row(label, format!("{count} frames"));
            }
        }
        write!(f, "{}\n{rows}", self.source)?;
        if !self.points.is_empty() {
            let mut table =
                Table::new(["point", "present", "blanks", "gaps", "longest gap", "jumps"]);
            for point in &self.points {
                table.line([
                    point.name.clone(),
                    point.present.to_string(),
                    point.blanks.to_string(),
                    point.gaps.to_string(),
                    format!("{:.2} s", point.longest_gap_s),
                    point.jumps.to_string(),
                ]);
            }
            write!(f, "\n\n{table}")?;
        }
        for warning in &self.warnings {
            write!(f, "\n  note: {warning}")?;
        }
        if let Some(recorded) = &self.recorded {
            write!(f, "\n\nThe frames are in {recorded}.")?;
        }
        Ok(())
    }
}

impl From<SourceError> for Failure {
    /// A recording that cannot be read is bad input; everything else was tried.
    fn from(error: SourceError) -> Self {
        match error {
            SourceError::Track(_)
            | SourceError::Read { .. }
            | SourceError::Unit { .. }
            | SourceError::Mcap { .. } => Self::bad_input(&error),
            SourceError::NatNet(_)
            | SourceError::Socket { .. }
            | SourceError::Twin(_)
            | SourceError::Thread(_) => Self::tried(&error),
        }
    }
}
