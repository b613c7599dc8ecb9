//! A campaign's text read, with a place for everything that cannot be meant.

use std::path::Path;

use serde::Deserialize;
use toml::Spanned;

use super::known::{self, RawKnown};
use super::{Campaign, CampaignRun, PointName, Reflector, Reflectors, RunTiming, TrackSettings};
use crate::{FileError, GaitSpec, SwimmerFile};

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawCampaign {
    swimmer: Spanned<String>,
    reflectors: RawReflectors,
    #[serde(default)]
    tracks: RawTracks,
    #[serde(default)]
    known: RawKnown,
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
    front_link: Option<Spanned<RawReflector>>,
    back_link: Option<Spanned<RawReflector>>,
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
    exclude: Option<Spanned<String>>,
}

/// The campaign of `text`; `is_there` says whether a file that a run names can be found.
pub(super) fn campaign(
    text: &str,
    path: &Path,
    is_there: &impl Fn(&Path) -> bool,
) -> Result<Campaign, FileError> {
    let raw: RawCampaign = crate::toml_text::parse(text, path)?;
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let error = |offset: usize, problem: String| FileError::at_offset(path, text, offset, problem);
    let swimmer =
        SwimmerFile::find_from(raw.swimmer.get_ref(), folder).map_err(|cause| match cause {
            FileError::Read { .. } => error(raw.swimmer.span().start, cause.to_string()),
            other => other,
        })?;
    let is_preset = SwimmerFile::preset(raw.swimmer.get_ref()).is_some();
    let swimmer_path = (!is_preset).then(|| folder.join(raw.swimmer.get_ref()));
    let reflectors = reflectors(raw.reflectors, &error)?;
    if raw.run.is_empty() {
        return Err(error(
            text.len(),
            "no [[run]]: a campaign needs at least one".to_owned(),
        ));
    }
    let tracks = track_settings(raw.tracks, &error)?;
    let known = known::known(raw.known, &error)?;
    let places: Vec<usize> = raw.run.iter().map(|run| run.track.span().start).collect();
    let runs: Vec<CampaignRun> = raw
        .run
        .into_iter()
        .map(|raw| run(raw, folder, is_there, &error))
        .collect::<Result<_, _>>()?;
    if let (Some(place), true) = (places.first(), runs.iter().all(|run| run.exclude.is_some())) {
        return Err(error(
            *place,
            "all runs are excluded: a campaign needs at least one that counts".to_owned(),
        ));
    }
    Ok(Campaign {
        swimmer,
        swimmer_path,
        reflectors,
        tracks,
        known,
        runs,
    })
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

fn reflectors(
    raw: RawReflectors,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<Reflectors, FileError> {
    let back_place = raw.back.span().start;
    let reflectors = Reflectors {
        front: reflector(raw.front, error)?,
        back: reflector(raw.back.into_inner(), error)?,
        sides: match (raw.front_link, raw.back_link) {
            (Some(front), Some(back)) => Some([side(front, error)?, side(back, error)?]),
            (None, None) => None,
            (Some(lone), None) | (None, Some(lone)) => {
                let problem = "front_link and back_link go together: both joint angles are measured, or neither".to_owned();
                return Err(error(lone.span().start, problem));
            }
        },
    };
    let [front, back] = [reflectors.front.at, reflectors.back.at];
    if (front[0] - back[0]).hypot(front[1] - back[1]) <= 0.0 {
        return Err(error(
            back_place,
            "both reflectors sit at the same place, so they show no heading".to_owned(),
        ));
    }
    Ok(reflectors)
}

/// A side link's reflector: by name or columns or to be found, somewhere off the joint.
fn side(
    raw: Spanned<RawReflector>,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<Reflector, FileError> {
    let place = raw.span().start;
    let reflector = reflector(raw.into_inner(), error)?;
    if matches!(reflector.point, PointName::Near(_)) {
        let problem =
            "a side link's reflector is found by its name, its columns or \"auto\", not by a place";
        return Err(error(place, problem.to_owned()));
    }
    if reflector.at[0].hypot(reflector.at[1]) <= 0.0 {
        let problem = "a reflector on the joint shows no angle; `at` is its place from the joint outwards, in metres";
        return Err(error(place, problem.to_owned()));
    }
    Ok(reflector)
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
    is_there: &impl Fn(&Path) -> bool,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<CampaignRun, FileError> {
    let log_place = raw.log.as_ref().map_or(0, |log| log.span().start);
    let places = [raw.track.span().start, raw.gait.span().start, log_place];
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
    let exclude = match raw.exclude {
        Some(reason) if reason.get_ref().trim().is_empty() => {
            let problem = "exclude says why the run is not to be fitted".to_owned();
            return Err(error(reason.span().start, problem));
        }
        reason => reason.map(Spanned::into_inner),
    };
    let run = CampaignRun {
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
        exclude,
    };
    for (file, place) in run.files().into_iter().zip(places) {
        if let Some(file) = file.filter(|file| !is_there(file)) {
            let problem = format!(
                "there is no file {}; paths start from the campaign's folder",
                file.display()
            );
            return Err(error(place, problem));
        }
    }
    Ok(run)
}
