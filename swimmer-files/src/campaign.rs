//! The campaign file: the runs of one experiment, and where the reflectors sit. Paths in it are relative to it.

mod body;
mod known;
mod raw;
mod read;
mod reported;
mod table;
mod tank;

use std::path::{Path, PathBuf};

use crate::file_error::read_text;
use crate::{Axes, FileError, GaitSpec, SwimmerFile};
pub use known::{Known, KnownValue};
pub use reported::{ReportedResults, ReportedValue};
pub use tank::{TankWalls, WallPlane};

/// A campaign, with its swimmer read and its paths resolved.
///
/// ```
/// use swimmer_files::Campaign;
///
/// let text = r#"
/// swimmer = "robot"
/// [reflectors]
/// front = { point = "Front", at = [0.0355, 0.0] }
/// back = { point = "Back", at = [-0.0355, 0.0] }
/// [[run]]
/// track = "eps030.csv"
/// gait = "circle:30deg"
/// period_s = 30.0
/// "#;
/// let campaign = Campaign::parse(text, "campaign.toml".as_ref())?;
/// assert_eq!(campaign.included().count(), 1);
///
/// let mistaken = Campaign::parse(&text.replace("30.0", "-1"), "campaign.toml".as_ref());
/// assert!(mistaken.unwrap_err().to_string().starts_with("campaign.toml:9:"));
/// # Ok::<(), swimmer_files::FileError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    /// The swimmer; its sphere radius and χ are only starting values of a fit.
    pub swimmer: SwimmerFile,
    /// Path that it was read from; `None` for a preset.
    pub swimmer_path: Option<PathBuf>,
    /// The two reflectors on the middle link.
    pub reflectors: Reflectors,
    /// Properties of the tracking files that they do not state.
    pub tracks: TrackSettings,
    /// Prior knowledge of the quantities that a fit otherwise assumes.
    pub known: Known,
    /// The runs, in the file's order.
    pub runs: Vec<CampaignRun>,
}

/// Properties of a campaign's tracking files that they do not state (the `[tracks]` table).
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct TrackSettings {
    /// `scale`: metres per unit of the files (per pixel).
    pub scale: Option<f64>,
    /// `rate_hz`: rows a second, for files with frame numbers and no times.
    pub rate_hz: Option<f64>,
    /// `axes`: which of the files' axes are the tank's x and y, as `x,-y`.
    pub axes: Option<Axes>,
    /// `likelihood`: the least that counts.
    pub likelihood: Option<f64>,
}

/// The reflectors on the robot.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflectors {
    /// The front one of the two on the middle link; with a [`RigidBody`] a place on the link that it carries.
    pub front: Reflector,
    /// The back one, likewise.
    pub back: Reflector,
    /// `body`: the rigid body that the tracking program made of the middle link, in place of two reflectors.
    pub body: Option<RigidBody>,
    /// `front_link`, `back_link`: one on each side link, which show the joint angles.
    pub sides: Option<[Reflector; 2]>,
}

/// A rigid body of the tracking program (position and orientation) that is fixed to the middle link.
///
/// ```
/// use swimmer_files::{Campaign, RigidBody};
///
/// let text = "swimmer = \"robot\"\n[reflectors]\nbody = \"Swimmer 1\"\n\
///             [[run]]\ntrack = \"a.csv\"\ngait = \"circle:1\"\nperiod_s = 10.0\n";
/// let campaign = Campaign::parse(text, "campaign.toml".as_ref())?;
/// assert_eq!(campaign.reflectors.body, Some(RigidBody::named("Swimmer 1".to_owned())));
/// # Ok::<(), swimmer_files::FileError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct RigidBody {
    /// Its name in the tracking file.
    pub name: String,
    /// Place of its pivot on the middle link \[m\]: along it from its centre to the front, and to the left of it.
    pub at: [f64; 2],
    /// Axis of the body by which its heading is read: 0, 1, 2 for x, y, z, and −1 if it points backwards. `None` for the axis that
    /// lies along the tank's x when the body is not turned.
    pub axis: Option<(usize, f64)>,
    /// Direction of the front link from that axis, counter-clockwise \[rad\].
    pub heading_rad: f64,
}

impl RigidBody {
    /// A body at the middle of the link, whose own axis shows the heading.
    pub fn named(name: String) -> Self {
        Self {
            name,
            at: [0.0; 2],
            axis: None,
            heading_rad: 0.0,
        }
    }
}

/// One reflector: what the tracking file calls it and where it sits.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflector {
    /// Its name in the tracking file.
    pub point: PointName,
    /// Its place \[m\]. On the middle link: along it from its centre to the front, and to the left of it. On a side link: from
    /// the joint outwards, and to the left of that.
    pub at: [f64; 2],
}

/// Identifies a reflector among the points of a tracking file.
#[derive(Debug, Clone, PartialEq)]
pub enum PointName {
    /// A marker's name (`point = "Front"`).
    Named(String),
    /// Two columns of a plain table (`point = ["x1", "y1"]`).
    Columns(String, String),
    /// To be found from the tracks themselves (`point = "auto"`), front and back by the direction of travel.
    Auto,
    /// To be found from the tracks themselves, and the one of the two that is nearer to this place of the tank (x, y) \[m\] in
    /// the first frame (`point = { near = [0.4, 0.2] }`).
    Near([f64; 2]),
}

impl std::str::FromStr for PointName {
    type Err = String;

    /// Syntax of the command line: `auto`, a place `X,Y` in metres, two columns `x1,y1`, or a name.
    fn from_str(text: &str) -> Result<Self, String> {
        let text = text.trim();
        if text.is_empty() {
            return Err("write a point's name, X,Y in metres, or auto".to_owned());
        }
        if text == "auto" {
            return Ok(Self::Auto);
        }
        let Some((x, y)) = text.split_once(',') else {
            return Ok(Self::Named(text.to_owned()));
        };
        let (x, y) = (x.trim(), y.trim());
        match (x.parse::<f64>(), y.parse::<f64>()) {
            (Ok(x), Ok(y)) if x.is_finite() && y.is_finite() => Ok(Self::Near([x, y])),
            (Err(_), Err(_)) => Ok(Self::Columns(x.to_owned(), y.to_owned())),
            _ => Err(format!(
                "`{text}` is neither a place X,Y in metres nor two columns"
            )),
        }
    }
}

/// Known starts of a run's cycles.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct RunTiming {
    /// `cycle_start_s`: the cameras' time at which a cycle began, as by the flash of the robot's LED \[s\].
    pub cycle_start_s: Option<f64>,
    /// `log`: the link log of the session.
    pub log: Option<PathBuf>,
    /// `play`: which of the log's plays this is, counted from 1.
    pub play: Option<usize>,
    /// `clock_offset_s`: the robot's clock at the cameras' time 0 \[s\].
    pub clock_offset_s: Option<f64>,
}

/// One run: a track or reported results, the gait that was played, its period.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignRun {
    /// The tracking file; for reported results the place at which they are written (`campaign.toml:12`, `figure.csv:3`).
    pub track: PathBuf,
    /// Reported results, if given instead of a track.
    pub reported: Option<ReportedResults>,
    /// The gait that was played.
    pub gait: GaitSpec,
    /// One cycle \[s\].
    pub period_s: f64,
    /// `front`: point of the front reflector in this run's file, if it differs from `[reflectors]`.
    pub front: Option<PointName>,
    /// Known starts of its cycles.
    pub timing: RunTiming,
    /// `exclude`: why it is not to be fitted.
    pub exclude: Option<String>,
}

impl Campaign {
    /// Reads a campaign file and the swimmer that it names; tracks, gait files and logs must be there and are not opened.
    ///
    /// # Errors
    /// [`FileError`] with the place in this file, or in the swimmer file.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let is_there = |file: &Path| !matches!(file.try_exists(), Ok(false));
        read::campaign(&read_text(path)?, path, &is_there, SwimmerFile::find_from)
    }

    /// Reads a campaign's text; relative paths start from the folder of `path`. The existence of the runs' files is not checked.
    ///
    /// # Errors
    /// As [`Campaign::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        read::campaign(text, path, &|_| true, SwimmerFile::find_from)
    }

    /// The same where no file system is at hand (a page in a browser): `text_of` gives the text of the swimmer file that the
    /// campaign names.
    ///
    /// # Errors
    /// As [`Campaign::parse`]; the swimmer is a file whose text is not given.
    ///
    /// ```
    /// use swimmer_files::{Campaign, SwimmerFile};
    ///
    /// let text = "swimmer = \"ours.toml\"\n[[run]]\ngait = \"circle:1\"\nperiod_s = 9.0\nx_mm = 8.0\nx_se_mm = 0.1\n";
    /// let ours = |name: &std::path::Path| name.ends_with("ours.toml").then(|| SwimmerFile::preset("robot").unwrap().to_toml());
    /// assert_eq!(Campaign::parse_with(text, "campaign.toml".as_ref(), ours)?.swimmer.name, "robot");
    /// assert!(Campaign::parse_with(text, "campaign.toml".as_ref(), |_| None).is_err());
    /// # Ok::<(), swimmer_files::FileError>(())
    /// ```
    pub fn parse_with(
        text: &str,
        path: &Path,
        text_of: impl Fn(&Path) -> Option<String>,
    ) -> Result<Self, FileError> {
        let find = |name: &str, folder: &Path| {
            if let Some(preset) = SwimmerFile::preset(name) {
                return Ok(preset);
            }
            let file = folder.join(name);
            let text = text_of(&file).ok_or_else(|| FileError::Read {
                path: file.clone(),
                source: std::io::ErrorKind::NotFound.into(),
            })?;
            SwimmerFile::parse(&text, &file)
        };
        read::campaign(text, path, &|_| true, find)
    }

    /// The places of the runs that are not excluded.
    pub fn included(&self) -> impl Iterator<Item = usize> {
        let runs = self.runs.iter().enumerate();
        runs.filter_map(|(index, run)| run.exclude.is_none().then_some(index))
    }

    /// The files that a campaign is made of, each once: itself, its swimmer where that is a file, tracks, gait files, link logs.
    ///
    /// # Errors
    /// As [`Campaign::load`].
    pub fn files(path: &Path) -> Result<Vec<PathBuf>, FileError> {
        let campaign = Self::load(path)?;
        let mut files = vec![path.to_path_buf()];
        files.extend(campaign.swimmer_path);
        for run in campaign.runs {
            files.extend(run.files().into_iter().flatten().cloned());
        }
        let mut seen = std::collections::HashSet::new();
        files.retain(|file| seen.insert(file.clone()));
        Ok(files)
    }
}

impl CampaignRun {
    /// Its track or table of results, and its gait and log where these are files.
    fn files(&self) -> [Option<&PathBuf>; 3] {
        let gait = match &self.gait {
            GaitSpec::File { path, .. } => Some(path),
            _ => None,
        };
        let track = match &self.reported {
            None => Some(&self.track),
            Some(reported) => reported.table.as_ref(),
        };
        [track, gait, self.timing.log.as_ref()]
    }
}
