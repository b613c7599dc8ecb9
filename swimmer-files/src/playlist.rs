//! The playlist: gaits that start and end at one shape, to be played one after the other without a pause. Gait files in it are
//! named from its own folder.

use std::fmt::Write as _;
use std::path::{Path, PathBuf};

use serde::Deserialize;
use swimmer_model::Gait as _;
use toml::Spanned;

use crate::file_error::read_text;
use crate::{
    AnyGait, FileError, GaitFile, GaitSpec, SwimmerHash, check_playable_period, write_atomically,
};

/// The version that is written, and the only one that is read.
const VERSION: u32 = 1;
const FORMAT: &str = "swimmer playlist";
/// Gaits join where their first and last shapes are no further apart than this \[rad\]: well below the unit of a robot's table.
const JOINED: f64 = 1e-5;
/// Largest number of steps, and of cycles per step.
const MOST: u32 = 1_000_000;

/// Gaits to be played one after the other.
///
/// ```
/// use swimmer_files::Playlist;
///
/// let text = r#"
/// format = "swimmer playlist"
/// version = 1
/// [[step]]
/// gait = "circle:70deg"
/// cycles = 3
/// period_s = 20.0
/// [[step]]
/// gait = "circle:70deg:cw"
/// cycles = 2
/// period_s = 12.5
/// "#;
/// let playlist = Playlist::parse(text, "way.playlist".as_ref())?;
/// assert_eq!(playlist.duration(), 85.0);
///
/// let apart = Playlist::parse(&text.replace("70deg:cw", "60deg"), "way.playlist".as_ref());
/// let problem = apart.unwrap_err().to_string();
/// assert!(problem.starts_with("way.playlist:9:8: step 2: "), "{problem}");
/// # Ok::<(), swimmer_files::FileError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Playlist {
    /// Name of the swimmer that it was made for.
    pub swimmer: Option<String>,
    /// In order, at least one.
    pub steps: Vec<PlaylistStep>,
}

/// A step of a playlist.
#[derive(Debug, Clone, PartialEq)]
pub struct PlaylistStep {
    /// The gait as it is named.
    pub gait: GaitSpec,
    /// One cycle of it.
    pub curve: AnyGait,
    /// Name and fingerprint of the swimmer that the gait was made for, if its file states them.
    pub made_for: Option<(Option<String>, SwimmerHash)>,
    /// Cycles.
    pub cycles: u32,
    /// Duration of a cycle \[s\].
    pub period: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPlaylist {
    format: Spanned<String>,
    version: Spanned<u32>,
    swimmer: Option<String>,
    #[serde(default)]
    step: Vec<RawStep>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawStep {
    gait: Spanned<String>,
    cycles: Spanned<i64>,
    period_s: Spanned<f64>,
}

impl Playlist {
    /// Reads a playlist and its gaits.
    ///
    /// # Errors
    /// [`FileError`] with the place in the playlist, or in the gait file.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        Self::parse(&read_text(path)?, path)
    }

    /// The same of a text that stands at this path; gait files are read from its folder.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let raw: RawPlaylist = crate::toml_text::parse(text, path)?;
        let error =
            |offset: usize, problem: String| FileError::at_offset(path, text, offset, problem);
        if raw.format.get_ref() != FORMAT {
            let problem = format!(
                "the format is {:?}; a playlist says {FORMAT:?}",
                raw.format.get_ref()
            );
            return Err(error(raw.format.span().start, problem));
        }
        if *raw.version.get_ref() != VERSION {
            let problem = format!(
                "version {} of the playlist; this program reads version {VERSION}: update it, or write the playlist anew",
                raw.version.get_ref()
            );
            return Err(error(raw.version.span().start, problem));
        }
        if raw.step.is_empty() || raw.step.len() > MOST as usize {
            let problem = "no [[step]]: a playlist has at least one, and at most a million";
            return Err(error(text.len(), problem.to_owned()));
        }
        let folder = path.parent().unwrap_or_else(|| Path::new(""));
        let mut steps: Vec<PlaylistStep> = Vec::with_capacity(raw.step.len());
        for (number, raw) in raw.step.iter().enumerate() {
            let at = |offset: usize, problem: String| {
                error(offset, format!("step {}: {problem}", number + 1))
            };
            let step = read_step(raw, folder, &at)?;
            let first = steps.first().unwrap_or(&step).curve.at(0.0).phi;
            let apart = [0.0, 1.0].map(|u| (step.curve.at(u).phi - first).amax());
            let apart = apart[0].max(apart[1]);
            if apart.is_nan() || apart > JOINED {
                let problem = format!(
                    "its gait starts or ends {apart:.2e} rad from where step 1 starts, ({:.4}, {:.4}) rad; gaits of a playlist \
                     start and end at one shape, as those of one `swimmer optimize steer` do",
                    first.x, first.y
                );
                return Err(at(raw.gait.span().start, problem));
            }
            steps.push(step);
        }
        Ok(Self {
            swimmer: raw.swimmer,
            steps,
        })
    }

    /// The playlist's text. Gaits keep the names that they were given, so files are relative to the playlist.
    pub fn to_text(&self) -> String {
        let mut text = format!(
            "# A playlist: gaits that start and end at one shape, to be played one after the other.\n\
             # Each step plays `cycles` cycles of `period_s` seconds of a gait, beside this file.\n\
             format = {FORMAT:?}\nversion = {VERSION}\n"
        );
        if let Some(swimmer) = &self.swimmer {
            let _ = writeln!(text, "swimmer = {}", quoted(swimmer));
        }
        for step in &self.steps {
            let _ = write!(
                text,
                "\n[[step]]\ngait = {}\ncycles = {}\nperiod_s = {:?}\n",
                quoted(&step.gait.to_string()),
                step.cycles,
                step.period
            );
        }
        text
    }

    /// Writes the playlist; its gait files are the caller's.
    ///
    /// # Errors
    /// [`FileError::Write`].
    pub fn save(&self, path: &Path) -> Result<(), FileError> {
        write_atomically(path, self.to_text().as_bytes())
    }

    /// Duration of all cycles \[s\].
    pub fn duration(&self) -> f64 {
        let of = |step: &PlaylistStep| f64::from(step.cycles) * step.period;
        self.steps.iter().map(of).sum()
    }
}

fn quoted(text: &str) -> String {
    toml::Value::String(text.to_owned()).to_string()
}

fn read_step(
    raw: &RawStep,
    folder: &Path,
    error: &impl Fn(usize, String) -> FileError,
) -> Result<PlaylistStep, FileError> {
    let place = raw.gait.span().start;
    let mut gait: GaitSpec = raw
        .gait
        .get_ref()
        .parse()
        .map_err(|cause| error(place, format!("{cause}")))?;
    let made_for;
    let curve;
    if let GaitSpec::File { path, reversed } = &mut gait {
        let beside: PathBuf = folder.join(&*path);
        let file = GaitFile::load(&beside).map_err(|cause| match cause {
            FileError::Read { .. } => error(place, cause.to_string()),
            other => other,
        })?;
        if let Some(spring) = file.passive {
            let problem = format!(
                "{} leaves the {} joint to a spring; a playlist drives both joints",
                beside.display(),
                spring.joint
            );
            return Err(error(place, problem));
        }
        curve = AnyGait::from_file(&file)
            .map_err(|cause| error(place, format!("{}: {cause}", beside.display())))?
            .reversed_if(*reversed);
        made_for = file.swimmer_hash.map(|hash| (file.swimmer_name, hash));
    } else {
        curve = gait.load()?;
        made_for = None;
    }
    let cycles = u32::try_from(*raw.cycles.get_ref())
        .ok()
        .filter(|cycles| (1..=MOST).contains(cycles))
        .ok_or_else(|| {
            let problem = format!("{} cycles; give 1 to a million", raw.cycles.get_ref());
            error(raw.cycles.span().start, problem)
        })?;
    let period = *raw.period_s.get_ref();
    check_playable_period(period)
        .map_err(|refused| error(raw.period_s.span().start, refused.to_string()))?;
    Ok(PlaylistStep {
        gait,
        curve,
        made_for,
        cycles,
        period,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const TEXT: &str = "format = \"swimmer playlist\"\nversion = 1\nswimmer = \"a \\\"robot\\\"\"\n\n[[step]]\ngait = \"one.gait\"\n\
                        cycles = 3\nperiod_s = 2.82\n\n[[step]]\ngait = \"one.gait:cw\"\ncycles = 1\nperiod_s = 3.0\n";

    fn folder() -> tempfile::TempDir {
        let folder = tempfile::tempdir().unwrap();
        GaitFile::sampled(&AnyGait::circle(1.0), 64)
            .save(&folder.path().join("one.gait"))
            .unwrap();
        GaitFile {
            passive: Some("back relaxation=0.35".parse().unwrap()),
            ..GaitFile::sampled(&AnyGait::circle(1.0), 64)
        }
        .save(&folder.path().join("spring.gait"))
        .unwrap();
        folder
    }

    #[test]
    fn what_is_written_reads_back() {
        let folder = folder();
        let path = folder.path().join("way.playlist");
        std::fs::write(&path, TEXT).unwrap();
        let read = Playlist::load(&path).unwrap();
        assert_eq!(read.swimmer.as_deref(), Some("a \"robot\""));
        read.save(&path).unwrap();
        assert_eq!(Playlist::load(&path).unwrap(), read);
        assert!((read.duration() - 11.46).abs() < 1e-12);
    }

    #[test]
    fn what_cannot_be_meant_is_told_with_its_place_and_step() {
        let folder = folder();
        let path = folder.path().join("way.playlist");
        for (from, to, place, says) in [
            (
                "swimmer playlist",
                "swimmer gait",
                (1, 10),
                "a playlist says",
            ),
            (
                "version = 1",
                "version = 2",
                (2, 11),
                "this program reads version 1",
            ),
            ("cycles = 3", "cycles = 0", (7, 10), "step 1: 0 cycles"),
            (
                "period_s = 3.0",
                "period_s = 0.01",
                (13, 12),
                "step 2: a period of 0.01 s",
            ),
            ("one.gait:cw", "two.gait", (11, 8), "step 2: cannot read"),
            (
                "one.gait:cw",
                "square:1.0",
                (11, 8),
                "start and end at one shape",
            ),
            ("cycles = 3", "cycle = 3", (7, 1), "unknown field `cycle`"),
            (
                "one.gait:cw",
                "spring.gait",
                (11, 8),
                "leaves the back joint to a spring",
            ),
        ] {
            let text = TEXT.replacen(from, to, 1);
            assert_ne!(text, TEXT);
            let error = Playlist::parse(&text, &path).unwrap_err();
            assert_eq!(error.place(), Some(place), "{error}");
            assert!(error.to_string().contains(says), "{error}");
        }
        let empty = TEXT.split("\n[[step]]").next().unwrap();
        let error = Playlist::parse(empty, &path).unwrap_err().to_string();
        assert!(error.contains("no [[step]]"), "{error}");
    }
}
