//! What a campaign names, read: the one place of this crate that opens files.

use std::path::{Path, PathBuf};

use swimmer_files::{
    AnyGait, Campaign, PointName, Reflectors, RunTiming, TrackSettings, plays, read_link_log,
};

use crate::cycles::Timing;
use crate::error::CalibrateError;
use crate::tracks::{TrackFile, TrackOptions, TrackSurvey, read_tracks_with, survey_tracks};

/// One run, read.
#[derive(Debug, Clone)]
pub struct RunData {
    /// The tracking file's path, for messages.
    pub file: PathBuf,
    /// What it holds.
    pub track: TrackFile,
    /// The gait that was played.
    pub gait: AnyGait,
    /// The gait as it was named.
    pub gait_name: String,
    /// One cycle as commanded \[s\].
    pub period_s: f64,
    /// Which point the front reflector is, where it is not as for the other runs.
    pub front: Option<PointName>,
    /// When its cycles began, where that is known.
    pub timing: Timing,
}

impl RunData {
    /// The reflectors of this run, by those of all runs.
    pub(crate) fn reflectors(&self, common: &Reflectors) -> Reflectors {
        let mut own = common.clone();
        if let Some(front) = &self.front {
            own.front.point = front.clone();
        }
        own
    }
}

/// Everything that a campaign names, read.
#[derive(Debug, Clone, Default)]
pub struct CampaignData {
    /// The tracked runs that the campaign does not exclude, in its order.
    pub runs: Vec<RunData>,
    /// The gaits of those whose results are told, likewise.
    pub told: Vec<AnyGait>,
}

impl CampaignData {
    /// Reads tracks and gait files: the one place of this crate that opens files, and only those that the campaign names.
    ///
    /// # Errors
    /// [`CalibrateError`] for the first file that cannot be read.
    pub fn load(campaign: &Campaign) -> Result<Self, CalibrateError> {
        let common = track_options(&campaign.reflectors, &campaign.tracks);
        let read = |run: &swimmer_files::CampaignRun| {
            let mut options = common.clone();
            if let Some(PointName::Columns(x, y)) = &run.front {
                options.pairs.push([x.clone(), y.clone()]);
            }
            Ok(RunData {
                track: load_tracks(&run.track, &options)?,
                file: run.track.clone(),
                gait: run.gait.load()?,
                gait_name: run.gait.to_string(),
                period_s: run.period_s,
                front: run.front.clone(),
                timing: timing(&run.timing)?,
            })
        };
        let included = || campaign.included().map(|index| &campaign.runs[index]);
        Ok(Self {
            runs: included()
                .filter(|run| run.told.is_none())
                .map(read)
                .collect::<Result<_, CalibrateError>>()?,
            told: included()
                .filter(|run| run.told.is_some())
                .map(|run| Ok(run.gait.load()?))
                .collect::<Result<_, CalibrateError>>()?,
        })
    }
}

/// Reads the link log, if there is one, and finds the run's play in it.
fn timing(told: &RunTiming) -> Result<Timing, CalibrateError> {
    let Some(log) = &told.log else {
        return Ok(Timing {
            cycle_start_s: told.cycle_start_s,
            ..Timing::default()
        });
    };
    let mut plays = plays(&read_link_log(log)?.frames);
    let index = match (told.play, plays.len()) {
        (Some(number), count) if number <= count => number - 1,
        (None, 1) => 0,
        (number, count) => {
            let periods: Vec<String> = plays
                .iter()
                .map(|play| format!("{} cycles of {} s", play.cycle_starts.len(), play.period_s))
                .collect();
            let asked = number.map_or(String::new(), |number| format!(", and no number {number}"));
            return Err(CalibrateError::Play {
                log: log.clone(),
                problem: format!(
                    "the log holds {count} plays ({}){asked}; say by `play = 1`, 2, … which one this run was",
                    periods.join(", ")
                ),
            });
        }
    };
    Ok(Timing {
        cycle_start_s: told.cycle_start_s,
        play: Some(plays.swap_remove(index)),
        clock_offset_s: told.clock_offset_s,
    })
}

/// What reflectors and settings of a campaign say about its tracks.
///
/// ```
/// use calibrate::track_options;
/// use swimmer_files::{Campaign, TrackSettings};
///
/// let text = "swimmer = \"robot\"\n[reflectors]\nfront = { point = \"Front\", at = [0.03, 0.0] }\n\
///             back = { point = \"Back\", at = [-0.03, 0.0] }\n[[run]]\ntrack = \"a.csv\"\ngait = \"circle:1\"\nperiod_s = 9.0\n";
/// let campaign = Campaign::parse(text, "campaign.toml".as_ref())?;
/// let pixels = TrackSettings { scale: Some(0.001), ..TrackSettings::default() };
/// assert_eq!(track_options(&campaign.reflectors, &pixels).metres_per_unit, Some(0.001));
/// # Ok::<(), swimmer_files::FileError>(())
/// ```
pub fn track_options(reflectors: &Reflectors, settings: &TrackSettings) -> TrackOptions {
    let pair = |point: &PointName| match point {
        PointName::Columns(x, y) => Some([x.clone(), y.clone()]),
        PointName::Named(_) | PointName::Auto | PointName::Near(_) => None,
    };
    TrackOptions {
        metres_per_unit: settings.scale,
        rate_hz: settings.rate_hz,
        axes: settings.axes,
        likelihood: settings.likelihood,
        pairs: [&reflectors.front, &reflectors.back]
            .into_iter()
            .filter_map(|r| pair(&r.point))
            .collect(),
    }
}

/// Opens and reads a tracking file, one line at a time.
///
/// # Errors
/// [`CalibrateError`] when it cannot be opened or read.
pub fn load_tracks(file: &Path, options: &TrackOptions) -> Result<TrackFile, CalibrateError> {
    Ok(read_tracks_with(open(file)?, file, options)?)
}

/// Says what a tracking file holds, without keeping it.
///
/// # Errors
/// As [`load_tracks`].
pub fn survey_file(file: &Path, options: &TrackOptions) -> Result<TrackSurvey, CalibrateError> {
    Ok(survey_tracks(open(file)?, file, options)?)
}

fn open(file: &Path) -> Result<std::fs::File, CalibrateError> {
    std::fs::File::open(file).map_err(|cause| CalibrateError::Open {
        file: file.to_owned(),
        cause: cause.to_string(),
    })
}

/// Reads one tracking file for [`calibrate_run`](crate::calibrate_run); as [`CampaignData::load`], an edge to the file system.
///
/// # Errors
/// [`CalibrateError`] when it cannot be opened or read.
pub fn load_run(
    file: &Path,
    gait: &swimmer_files::GaitSpec,
    period_s: f64,
    options: &TrackOptions,
) -> Result<RunData, CalibrateError> {
    Ok(RunData {
        file: file.to_owned(),
        track: load_tracks(file, options)?,
        gait: gait.load()?,
        gait_name: gait.to_string(),
        period_s,
        front: None,
        timing: Timing::default(),
    })
}
