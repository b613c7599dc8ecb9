//! The campaign file: the runs of one experiment, and where the reflectors sit. Paths in it are relative to it.

use std::path::{Path, PathBuf};

use serde::Deserialize;
use toml::Spanned;

use crate::place::read_text;
use crate::{Axes, FileError, GaitSpec, SwimmerFile};

/// A campaign, with its swimmer read and its paths resolved.
#[derive(Debug, Clone, PartialEq)]
pub struct Campaign {
    /// The swimmer; its sphere radius and χ are only starting values of a fit.
    pub swimmer: SwimmerFile,
    /// Where it was read; `None` for a preset.
    pub swimmer_path: Option<PathBuf>,
    /// The two reflectors on the middle link.
    pub reflectors: Reflectors,
    /// What the tracking files do not say themselves.
    pub tracks: TrackSettings,
    /// The runs, in the file's order.
    pub runs: Vec<CampaignRun>,
}

/// What the tracking files of a campaign do not say themselves (the `[tracks]` table).
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

/// The two reflectors on the middle link.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflectors {
    /// The front one.
    pub front: Reflector,
    /// The back one.
    pub back: Reflector,
}

/// One reflector: what the tracking file calls it and where it sits.
#[derive(Debug, Clone, PartialEq)]
pub struct Reflector {
    /// Its name in the tracking file.
    pub point: PointName,
    /// Its place on the middle link \[m\]: along the link from its centre to the front, and to the left of it.
    pub at: [f64; 2],
}

/// Which of a tracking file's points a reflector is.
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

    /// As on the command line: `auto`, a place `X,Y` in metres, two columns `x1,y1`, or a name.
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

/// What is known of when a run's cycles began.
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

/// One run: a track, the gait that was swum, its period.
#[derive(Debug, Clone, PartialEq)]
pub struct CampaignRun {
    /// The tracking file.
    pub track: PathBuf,
    /// The gait that was played.
    pub gait: GaitSpec,
    /// One cycle \[s\].
    pub period_s: f64,
    /// `front`: which point the front reflector is in this run's file, where it is not as in `[reflectors]`.
    pub front: Option<PointName>,
    /// When its cycles began, where that is known.
    pub timing: RunTiming,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCampaign {
    swimmer: Spanned<String>,
    reflectors: RawReflectors,
    #[serde(default)]
    tracks: RawTracks,
    #[serde(default)]
    run: Vec<RawRun>,
}

#[derive(Default, Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTracks {
    scale: Option<Spanned<f64>>,
    rate_hz: Option<Spanned<f64>>,
    axes: Option<Spanned<String>>,
    likelihood: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawReflectors {
    front: RawReflector,
    back: Spanned<RawReflector>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawReflector {
    point: RawPoint,
    at: Spanned<[f64; 2]>,
}

#[derive(Deserialize)]
#[serde(
    untagged,
    expecting = "a point is a name, a pair of column names, { near = [x, y] }, or \"auto\""
)]
enum RawPoint {
    Name(String),
    Columns([String; 2]),
    Near { near: [f64; 2] },
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawRun {
    track: Spanned<String>,
    gait: Spanned<String>,
    period_s: Spanned<f64>,
    front: Option<Spanned<RawPoint>>,
    cycle_start_s: Option<Spanned<f64>>,
    log: Option<Spanned<String>>,
    play: Option<Spanned<usize>>,
    clock_offset_s: Option<Spanned<f64>>,
}

impl Campaign {
    /// Reads a campaign file and the swimmer that it names; tracks and gait files are not opened.
    ///
    /// # Errors
    /// [`FileError`] with the place in this file, or in the swimmer file.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        Self::parse(&read_text(path)?, path)
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
            files.push(run.track);
            if let GaitSpec::File { path, .. } = run.gait {
                files.push(path);
            }
            files.extend(run.timing.log);
        }
        let mut seen = std::collections::HashSet::new();
        files.retain(|file| seen.insert(file.clone()));
        Ok(files)
    }

    /// Reads a campaign's text; `path` says which folder its paths start from.
    ///
    /// # Errors
    /// As [`Campaign::load`].
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let raw: RawCampaign = crate::toml_text::parse(text, path)?;
        let folder = path.parent().unwrap_or_else(|| Path::new(""));
        let error =
            |offset: usize, problem: String| FileError::at_offset(path, text, offset, problem);
        let swimmer =
            SwimmerFile::find_from(raw.swimmer.get_ref(), folder).map_err(|cause| match cause {
                FileError::Read { .. } => error(raw.swimmer.span().start, cause.to_string()),
                other => other,
            })?;
        let is_preset = SwimmerFile::preset(raw.swimmer.get_ref()).is_some();
        let swimmer_path = (!is_preset).then(|| folder.join(raw.swimmer.get_ref()));
        let back_place = raw.reflectors.back.span().start;
        let reflectors = Reflectors {
            front: reflector(raw.reflectors.front, &error)?,
            back: reflector(raw.reflectors.back.into_inner(), &error)?,
        };
        let [front, back] = [reflectors.front.at, reflectors.back.at];
        if (front[0] - back[0]).hypot(front[1] - back[1]) <= 0.0 {
            return Err(error(
                back_place,
                "both reflectors sit at the same place, so they show no heading".to_owned(),
            ));
        }
        if raw.run.is_empty() {
            return Err(error(
                text.len(),
                "no [[run]]: a campaign needs at least one".to_owned(),
            ));
        }
        let tracks = track_settings(raw.tracks, &error)?;
        let runs = raw
            .run
            .into_iter()
            .map(|raw| run(raw, folder, &error))
            .collect::<Result<_, _>>()?;
        Ok(Self {
            swimmer,
            swimmer_path,
            reflectors,
            tracks,
            runs,
        })
    }
}

fn track_settings(
    raw: RawTracks,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<TrackSettings, FileError> {
    let positive = |value: Option<Spanned<f64>>, name: &str| {
        let Some(value) = value else { return Ok(None) };
        let number = *value.get_ref();
        if number.is_finite() && number > 0.0 {
            return Ok(Some(number));
        }
        let problem = format!("{name} = {number} must be a positive number");
        Err(error(value.span().start, problem))
    };
    let axes = raw.axes.map(|axes| {
        let parsed = axes.get_ref().parse();
        parsed.map_err(|cause| error(axes.span().start, cause))
    });
    Ok(TrackSettings {
        scale: positive(raw.scale, "scale")?,
        rate_hz: positive(raw.rate_hz, "rate_hz")?,
        axes: axes.transpose()?,
        likelihood: positive(raw.likelihood, "likelihood")?,
    })
}

fn reflector(
    raw: RawReflector,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<Reflector, FileError> {
    let at = *raw.at.get_ref();
    if !at.iter().all(|value| value.is_finite()) {
        return Err(error(
            raw.at.span().start,
            format!("at = {at:?} must be two finite lengths in metres"),
        ));
    }
    let point = point(raw.point).map_err(|problem| error(raw.at.span().start, problem))?;
    Ok(Reflector { point, at })
}

fn point(raw: RawPoint) -> Result<PointName, String> {
    match raw {
        RawPoint::Name(name) if name == "auto" => Ok(PointName::Auto),
        RawPoint::Name(name) => Ok(PointName::Named(name)),
        RawPoint::Columns([x, y]) => Ok(PointName::Columns(x, y)),
        RawPoint::Near { near } if near.iter().all(|v| v.is_finite()) => Ok(PointName::Near(near)),
        RawPoint::Near { near } => Err(format!(
            "near = {near:?} must be two finite lengths in metres"
        )),
    }
}

fn run(
    raw: RawRun,
    folder: &Path,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<CampaignRun, FileError> {
    if raw.track.get_ref().is_empty() {
        return Err(error(
            raw.track.span().start,
            "track is the path of a tracking file".to_owned(),
        ));
    }
    let gait: GaitSpec = raw
        .gait
        .get_ref()
        .parse()
        .map_err(|cause| error(raw.gait.span().start, format!("gait: {cause}")))?;
    let period_s = *raw.period_s.get_ref();
    if !(period_s.is_finite() && period_s > 0.0) {
        return Err(error(
            raw.period_s.span().start,
            format!("period_s = {period_s} must be a positive number of seconds"),
        ));
    }
    let front = raw.front.map(|front| {
        let place = front.span().start;
        point(front.into_inner()).map_err(|problem| error(place, problem))
    });
    let finite = |value: Option<Spanned<f64>>, name: &str| {
        let Some(value) = value else { return Ok(None) };
        let number = *value.get_ref();
        if number.is_finite() {
            return Ok(Some(number));
        }
        let problem = format!("{name} = {number} must be a finite number of seconds");
        Err(error(value.span().start, problem))
    };
    // What says something about the log says nothing without it.
    let of_log = [
        ("play", raw.play.as_ref().map(Spanned::span)),
        (
            "clock_offset_s",
            raw.clock_offset_s.as_ref().map(Spanned::span),
        ),
    ];
    let lonely = of_log
        .into_iter()
        .find_map(|(name, span)| Some((name, span?)));
    if let (None, Some((name, span))) = (&raw.log, lonely) {
        let problem = format!("{name} is about the robot's log; name it by `log`");
        return Err(error(span.start, problem));
    }
    if let Some(play) = raw.play.as_ref().filter(|play| *play.get_ref() == 0) {
        let problem = "play counts the log's plays from 1".to_owned();
        return Err(error(play.span().start, problem));
    }
    Ok(CampaignRun {
        track: folder.join(raw.track.into_inner()),
        gait: gait.from_folder(folder),
        period_s,
        front: front.transpose()?,
        timing: RunTiming {
            cycle_start_s: finite(raw.cycle_start_s, "cycle_start_s")?,
            log: raw.log.map(|log| folder.join(log.into_inner())),
            play: raw.play.map(Spanned::into_inner),
            clock_offset_s: finite(raw.clock_offset_s, "clock_offset_s")?,
        },
    })
}
