//! A campaign's text read, with a place for everything that cannot be meant.

use std::path::Path;

use toml::Spanned;

use super::body::body;
use super::known;
use super::raw::{RawCampaign, RawPoint, RawReflector, RawReflectors, RawRun, RawTracks};
use super::reported;
use super::table::table;
use super::{Campaign, CampaignRun, PointName, Reflector, Reflectors, RunTiming, TrackSettings};
use crate::{FileError, GaitSpec, Quantity, SwimmerFile};

/// The campaign of `text`; `is_there` says whether a file that a run names can be found, `find` reads the swimmer that it names, from
/// its folder on.
pub(super) fn campaign(
    text: &str,
    path: &Path,
    is_there: &impl Fn(&Path) -> bool,
    find: impl Fn(&str, &Path) -> Result<SwimmerFile, FileError>,
) -> Result<Campaign, FileError> {
    let raw: RawCampaign = crate::toml_text::parse(text, path)?;
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let error = |offset: usize, problem: String| FileError::at_offset(path, text, offset, problem);
    let swimmer = find(raw.swimmer.get_ref(), folder).map_err(|cause| match cause {
        FileError::Read { .. } => error(raw.swimmer.span().start, cause.to_string()),
        other => other,
    })?;
    let is_preset = SwimmerFile::preset(raw.swimmer.get_ref()).is_some();
    let swimmer_path = (!is_preset).then(|| folder.join(raw.swimmer.get_ref()));
    let reflectors = if let Some(reported) = raw.reflectors {
        reflectors(reported, swimmer.swimmer.links.middle / 2.0, &error)?
    } else {
        // Only a track needs them.
        if let Some(track) = raw.run.iter().find_map(|run| run.track.as_ref()) {
            let problem = "no [reflectors] say which points of this track are the robot's front and back, and where they sit";
            return Err(error(track.span().start, problem.to_owned()));
        }
        usual_reflectors(swimmer.swimmer.links.middle / 2.0)
    };
    if raw.run.is_empty() {
        return Err(error(
            text.len(),
            "no [[run]]: a campaign needs at least one".to_owned(),
        ));
    }
    let tracks = track_settings(raw.tracks, &error)?;
    let known = known::known(raw.known, &error)?;
    let places: Vec<usize> = raw.run.iter().map(|run| run.gait.span().start).collect();
    let runs: Vec<CampaignRun> = raw
        .run
        .into_iter()
        .map(|raw| {
            let reported = raw.track.is_none();
            if reported {
                reported_runs(&raw, (text, path), &error)
            } else {
                Ok(vec![run(raw, folder, is_there, &error)?])
            }
        })
        .collect::<Result<Vec<_>, _>>()?
        .concat();
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

/// The reflectors of a campaign; `half` is that of the middle link \[m\].
fn reflectors(
    raw: RawReflectors,
    half: f64,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<Reflectors, FileError> {
    let back_place = raw.back.as_ref().map_or(0, |back| back.span().start);
    let usual = usual_reflectors(half);
    let (front, back, body) = match (raw.front, raw.back, raw.body) {
        (Some(front), Some(back), None) => (
            reflector(front.into_inner(), error)?,
            reflector(back.into_inner(), error)?,
            None,
        ),
        (None, None, Some(raw)) => (usual.front, usual.back, Some(body(raw, error)?)),
        (front, back, Some(_)) => {
            let lone = front.or(back).map_or(0, |lone| lone.span().start);
            let problem =
                "the middle link is tracked by `body` or by `front` and `back`; remove one of them"
                    .to_owned();
            return Err(error(lone, problem));
        }
        (front, back, None) => {
            let lone = front.or(back).map_or(0, |lone| lone.span().start);
            let problem = "[reflectors] needs `front` and `back`, or `body`".to_owned();
            return Err(error(lone, problem));
        }
    };
    let reflectors = Reflectors {
        front,
        back,
        body,
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

/// At the ends of the middle link, to be found.
fn usual_reflectors(half: f64) -> Reflectors {
    let at = |along: f64| Reflector {
        point: PointName::Auto,
        at: [along, 0.0],
    };
    Reflectors {
        front: at(half),
        back: at(-half),
        body: None,
        sides: None,
    }
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
    for value in at {
        let slip = Quantity::Length.checked(value).err();
        if let Some(slip) = slip {
            return Err(error(raw.at.span().start, format!("at = {at:?}: {slip}")));
        }
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
    let nothing = Spanned::new(0..0, String::new());
    let track = raw.track.clone().unwrap_or(nothing);
    let also = raw
        .first_number()
        .or_else(|| Some(("results", raw.results.as_ref()?.span().start)));
    if let Some((key, place)) = also {
        let problem = format!("{key} next to a track: a run is tracked or reported, not both");
        return Err(error(place, problem));
    }
    let log_place = raw.log.as_ref().map_or(0, |log| log.span().start);
    let places = [track.span().start, raw.gait.span().start, log_place];
    if track.get_ref().is_empty() {
        return Err(error(
            track.span().start,
            "track is the path of a tracking file".to_owned(),
        ));
    }
    let gait: GaitSpec = raw
        .gait
        .get_ref()
        .parse()
        .map_err(|cause| error(raw.gait.span().start, format!("gait: {cause}")))?;
    let (period_s, exclude) = (period(&raw, error)?, excluded(&raw, error)?);
    // Keys about the log need a log.
    if let (None, Some((name, place))) = (&raw.log, raw.of_log()) {
        let problem = format!("{name} is about the robot's log; name it by `log`");
        return Err(error(place, problem));
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
    if let Some(play) = raw.play.as_ref().filter(|play| *play.get_ref() == 0) {
        let problem = "play counts the log's plays from 1".to_owned();
        return Err(error(play.span().start, problem));
    }
    let run = CampaignRun {
        track: folder.join(track.into_inner()),
        reported: None,
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

fn period(raw: &RawRun, error: &impl Fn(usize, String) -> FileError) -> Result<f64, FileError> {
    let period_s = *raw.period_s.get_ref();
    if period_s.is_finite() && period_s > 0.0 {
        return Ok(period_s);
    }
    let problem = format!("period_s = {period_s} must be a positive number of seconds");
    Err(error(raw.period_s.span().start, problem))
}

fn excluded(
    raw: &RawRun,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<Option<String>, FileError> {
    match &raw.exclude {
        Some(reason) if reason.get_ref().trim().is_empty() => {
            let problem = "exclude says why the run is not to be fitted".to_owned();
            Err(error(reason.span().start, problem))
        }
        reason => Ok(reason.as_ref().map(|reason| reason.get_ref().clone())),
    }
}

/// The runs of a `[[run]]` without a track: one by its numbers, or those of a table.
fn reported_runs(
    raw: &RawRun,
    (text, path): (&str, &Path),
    error: &impl Fn(usize, String) -> FileError,
) -> Result<Vec<CampaignRun>, FileError> {
    let folder = path.parent().unwrap_or_else(|| Path::new(""));
    let gait_place = raw.gait.span().start;
    if let Some((key, place)) = raw.of_track() {
        let problem = format!("{key} is about a track, and this run has none");
        return Err(error(place, problem));
    }
    let (period_s, exclude) = (period(raw, error)?, excluded(raw, error)?);
    let run = |track, gait: GaitSpec, reported| CampaignRun {
        track,
        reported: Some(reported),
        gait: gait.from_folder(folder),
        period_s,
        front: None,
        timing: RunTiming::default(),
        exclude: exclude.clone(),
    };
    let number = |key: &str| raw.number(key).map(|number| *number.get_ref());
    let Some(results) = &raw.results else {
        let reported = reported::reported(number).map_err(|(key, problem)| {
            let place = raw.number(&key).map_or(gait_place, |n| n.span().start);
            let problem = if key.is_empty() {
                format!("{problem}; with one, track is the path of its tracking file")
            } else {
                problem
            };
            error(place, problem)
        })?;
        let gait = raw.gait.get_ref().parse();
        let gait = gait.map_err(|cause| error(gait_place, format!("gait: {cause}")))?;
        let (line, _) = crate::file_error::line_and_column(text, gait_place);
        let track = format!("{}:{line}", path.display());
        return Ok(vec![run(track.into(), gait, reported)]);
    };
    if let Some((_, place)) = raw.first_number() {
        let problem = "numbers next to a table of results: the table has them all".to_owned();
        return Err(error(place, problem));
    }
    let file = folder.join(results.get_ref());
    let rows = table(&file, raw.gait.get_ref()).map_err(|cause| match cause {
        FileError::Read { .. } => error(results.span().start, cause.to_string()),
        other => other,
    })?;
    let named = |(line, gait, reported)| {
        let track = format!("{}:{line}", file.display());
        run(track.into(), gait, reported)
    };
    Ok(rows.into_iter().map(named).collect())
}
