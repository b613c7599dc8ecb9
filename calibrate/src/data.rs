//! Files of a campaign. Only this module of the crate opens files.

use std::fs::File;
use std::io::{self, Read};
use std::path::{Path, PathBuf};

use swimmer_files::{
    AnyGait, Campaign, CampaignRun, GaitFile, PointName, Reflectors, TrackSettings, parse_link_log,
};

use crate::cycles::Timing;
use crate::error::CalibrateError;
use crate::link_log::Logged;
use crate::tracks::{
    TrackFile, TrackOptions, TrackSurvey, UsedPoints, read_tracks_with, survey_tracks,
};

/// One run, read.
#[derive(Debug, Clone)]
pub struct RunData {
    /// The tracking file's path, for messages.
    pub file: PathBuf,
    /// Its content.
    pub track: TrackFile,
    /// The gait that was played.
    pub gait: AnyGait,
    /// The gait as it was named.
    pub gait_name: String,
    /// One cycle as commanded \[s\].
    pub period_s: f64,
    /// Point of the front reflector, if it differs from the other runs.
    pub front: Option<PointName>,
    /// Known starts of its cycles.
    pub timing: Timing,
}

impl RunData {
    /// The reflectors of this run, by those of all runs.
    pub(crate) fn reflectors(&self, common: &Reflectors) -> Reflectors {
        reflectors_of(common, self.front.as_ref())
    }
}

/// The reflectors of a run whose front one, or rigid body, may be another than that of all runs.
fn reflectors_of(common: &Reflectors, front: Option<&PointName>) -> Reflectors {
    let mut own = common.clone();
    match (front, &mut own.body) {
        (Some(PointName::Named(name)), Some(body)) => body.name.clone_from(name),
        (Some(front), _) => own.front.point = front.clone(),
        (None, _) => {}
    }
    own
}

/// Everything that a campaign names, read.
#[derive(Debug, Clone, Default)]
pub struct CampaignData {
    /// The tracked runs that the campaign does not exclude, in its order.
    pub runs: Vec<RunData>,
    /// The gaits of runs whose results are stated, likewise.
    pub reported_gaits: Vec<AnyGait>,
    /// Contradictions between link logs and campaign, each with its run's file.
    pub doubts: Vec<String>,
}

impl CampaignData {
    /// Reads tracks, gait files and link logs: the one place of this crate that opens files, and only those that the campaign names.
    ///
    /// # Errors
    /// [`CalibrateError`] for the first file that cannot be read.
    pub fn load(campaign: &Campaign) -> Result<Self, CalibrateError> {
        Self::load_by(campaign, opened)
    }

    /// The same where no file system is at hand (a page in a browser): `open` gives what a file holds, or says why not and what to do.
    ///
    /// # Errors
    /// As [`CampaignData::load`].
    ///
    /// ```
    /// use calibrate::CampaignData;
    /// use swimmer_files::Campaign;
    ///
    /// let text = "swimmer = \"robot\"\n[reflectors]\nfront = { point = \"a\", at = [0.03, 0.0] }\n\
    ///             back = { point = \"b\", at = [-0.03, 0.0] }\n[[run]]\ntrack = \"run.csv\"\ngait = \"circle:1\"\nperiod_s = 9.0\n";
    /// let campaign = Campaign::parse(text, "campaign.toml".as_ref())?;
    /// let seen = |_: &std::path::Path| Ok("t,a_x,a_y,b_x,b_y\n0.0,1.0,0.0,0.94,0.0\n0.1,1.0,0.0,0.94,0.0\n".as_bytes());
    /// assert_eq!(CampaignData::load_by(&campaign, seen).unwrap().runs[0].track.frames(), 2);
    /// # Ok::<(), swimmer_files::FileError>(())
    /// ```
    pub fn load_by<R: Read>(
        campaign: &Campaign,
        open: impl Fn(&Path) -> io::Result<R>,
    ) -> Result<Self, CalibrateError> {
        let mut files = Files {
            common: track_options(&campaign.reflectors, &campaign.tracks),
            reflectors: &campaign.reflectors,
            open,
            logs: Vec::new(),
        };
        let mut data = Self::default();
        for run in campaign.included().map(|index| &campaign.runs[index]) {
            if run.reported.is_some() {
                data.reported_gaits.push(files.gait(run)?);
            } else {
                let (run, doubts) = files.run(run)?;
                data.runs.push(run);
                data.doubts.extend(doubts);
            }
        }
        Ok(data)
    }
}

/// Reader of a campaign's files, one after the other.
struct Files<'a, O> {
    /// Options of all tracks.
    common: TrackOptions,
    reflectors: &'a Reflectors,
    open: O,
    /// Several runs may have been plays of one log.
    logs: Vec<(PathBuf, Logged)>,
}

impl<R: Read, O: Fn(&Path) -> io::Result<R>> Files<'_, O> {
    fn open(&self, file: &Path) -> Result<R, CalibrateError> {
        (self.open)(file).map_err(|cause| unreadable(file, &cause))
    }

    fn run(&mut self, run: &CampaignRun) -> Result<(RunData, Vec<String>), CalibrateError> {
        let gait = self.gait(run)?;
        let (timing, doubts) = self.timing(run, &gait)?;
        let mut options = self.common.clone();
        if let Some(PointName::Columns(x, y)) = &run.front {
            options.pairs.push([x.clone(), y.clone()]);
        }
        let reflectors = reflectors_of(self.reflectors, run.front.as_ref());
        options.used = Some(UsedPoints::of(&reflectors));
        let data = RunData {
            track: read_tracks_with(self.open(&run.track)?, &run.track, &options)?,
            file: run.track.clone(),
            gait,
            gait_name: run.gait.to_string(),
            period_s: run.period_s,
            front: run.front.clone(),
            timing,
        };
        Ok((data, doubts))
    }

    fn gait(&self, run: &CampaignRun) -> Result<AnyGait, CalibrateError> {
        run.gait.load_by(|path| {
            let mut text = String::new();
            let read = self.open(path)?.read_to_string(&mut text);
            read.map_err(|cause| unreadable(path, &cause))?;
            Ok(GaitFile::parse(&text, path)?)
        })
    }

    /// Known starts of the run's cycles, and contradictions of its link log.
    fn timing(
        &mut self,
        run: &CampaignRun,
        gait: &AnyGait,
    ) -> Result<(Timing, Vec<String>), CalibrateError> {
        let Some(path) = &run.timing.log else {
            let timing = Timing {
                cycle_start_s: run.timing.cycle_start_s,
                ..Timing::default()
            };
            return Ok((timing, Vec::new()));
        };
        let known = self.logs.iter().position(|(known, _)| known == path);
        let known = known.unwrap_or(self.logs.len());
        if known == self.logs.len() {
            let mut bytes = Vec::new();
            let read = self.open(path)?.read_to_end(&mut bytes);
            read.map_err(|cause| unreadable(path, &cause))?;
            let log = parse_link_log(&bytes, path)?.into();
            self.logs.push((path.clone(), log));
        }
        let (_, log) = &self.logs[known];
        let timing = log.timing(path, run)?;
        let doubts = timing.play.as_ref().map(|play| log.doubts(play, run, gait));
        let name = run.track.file_name().unwrap_or(run.track.as_os_str());
        let named = |doubt| format!("{}: {doubt}", name.display());
        let doubts = doubts.into_iter().flatten().map(named).collect();
        Ok((timing, doubts))
    }
}

fn unreadable(file: &Path, cause: &io::Error) -> CalibrateError {
    CalibrateError::Open {
        file: file.to_owned(),
        cause: cause.to_string(),
    }
}

/// A file of this machine.
fn opened(file: &Path) -> io::Result<File> {
    let next = |cause: io::Error| {
        io::Error::new(
            cause.kind(),
            format!("{cause}; check the path and its permissions"),
        )
    };
    File::open(file).map_err(next)
}

/// Options for a campaign's tracks, by its reflectors and settings.
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
        used: Some(UsedPoints::of(reflectors)),
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

fn open(file: &Path) -> Result<File, CalibrateError> {
    opened(file).map_err(|cause| unreadable(file, &cause))
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
    let (curve, name) = (gait.load()?, gait.to_string());
    load_run_of(file, curve, name, period_s, options)
}

/// The same for a gait that is loaded; `name` is for messages.
///
/// # Errors
/// As [`load_run`].
pub fn load_run_of(
    file: &Path,
    gait: AnyGait,
    name: String,
    period_s: f64,
    options: &TrackOptions,
) -> Result<RunData, CalibrateError> {
    Ok(RunData {
        file: file.to_owned(),
        track: load_tracks(file, options)?,
        gait,
        gait_name: name,
        period_s,
        front: None,
        timing: Timing::default(),
    })
}
