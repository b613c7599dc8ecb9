//! Reader of the spec: a TOML file with strict keys. Lengths are metres, angles radians or text such as `"90deg"`.

use std::ops::Range;
use std::path::Path;

use forecast::Tank;
use serde::{Deserialize, Serialize};
use swimmer_files::{FileError, GaitSpec, check_playable_period, parse_angle};
use toml::Spanned;

use crate::adaptive::{CampaignGoal, USUAL_ACCURACY_M};

/// Most repeats, cycles, gaits and attempts: more is a slip of the keyboard.
const MOST: u32 = 10_000;
/// Largest pose and tank \[m\].
const LARGEST_M: f64 = 100.0;

/// Experiment as a person writes it.
///
/// ```
/// use experiment::unattended::{GaitSource, Spec};
///
/// let text = r#"
/// swimmer = "robot"
/// repeats = 5
/// period = 12.0
/// [tank]
/// length = 1.2
/// width = 0.8
/// [[gait]]
/// name = "b"
/// optimize = "displacement --playable --sign +"
/// neighbours = 0.1
/// [[gait]]
/// gait = "circle:70deg"
/// "#;
/// let spec = Spec::parse(text, "spec.toml".as_ref())?;
/// assert_eq!((spec.gaits.len(), spec.gaits[1].name.as_str()), (2, "circle-70deg"));
/// assert!(matches!(spec.gaits[0].source, GaitSource::Optimize(_)));
///
/// let mistaken = Spec::parse(&text.replace("repeats", "repeat"), "spec.toml".as_ref());
/// assert!(mistaken.unwrap_err().to_string().starts_with("spec.toml:3:"));
/// # Ok::<(), swimmer_files::FileError>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct Spec {
    /// Preset or swimmer file, relative to the spec.
    pub swimmer: String,
    /// Folder with the gaits that drive to the start pose, relative to the spec. `None`: they are computed.
    pub drive: Option<String>,
    /// Walls.
    pub tank: Tank,
    /// Distance kept from the walls \[m\].
    pub margin_m: f64,
    /// Pose at the start of every trial.
    pub start: StartPose,
    /// Gaits, in the file's order.
    pub gaits: Vec<SpecGait>,
    /// Repeats of each gait; each repeat is a block. 0 in an adaptive campaign.
    pub repeats: u32,
    /// Goal of an adaptive campaign; `None`: every gait is repeated as often as the others.
    pub adaptive: Option<AdaptiveSpec>,
    /// Cycles of a trial before those that count: the servos take up their dead band.
    pub run_in: u32,
    /// Seconds at rest before a trial, for the fluid to come to rest.
    pub settle_s: f64,
    /// Seed of the order.
    pub seed: u64,
    /// Level of intervals, and of the tests one less it.
    pub level: f64,
    /// Stop rules.
    pub stop: StopRules,
}

/// Pose at the start of every trial, with the tolerance in which it counts as reached.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StartPose {
    /// Position along the tank \[m\].
    pub x_m: f64,
    /// Position across the tank \[m\].
    pub y_m: f64,
    /// Heading \[rad\].
    pub heading_rad: f64,
    /// Distance that counts as reached \[m\].
    pub within_m: f64,
    /// Angle that counts as reached \[rad\].
    pub within_rad: f64,
}

/// Gait of a spec.
#[derive(Debug, Clone, PartialEq)]
pub struct SpecGait {
    /// Name in plans and reports.
    pub name: String,
    /// Origin of its curve.
    pub source: GaitSource,
    /// Size of its two neighbours as a share more and less than its own; `None`: it has none.
    pub neighbours: Option<f64>,
    /// Duration of a cycle.
    pub period: SpecPeriod,
    /// Counted cycles of a trial.
    pub cycles: u32,
}

/// Goal of an adaptive campaign.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub struct AdaptiveSpec {
    /// Half width of the interval of χ, as a share of χ.
    pub chi_share: f64,
    /// Half width of the interval of r_s \[m\].
    pub sphere_radius_m: f64,
    /// Longest tank time, of rests and plays \[s\].
    pub budget_s: f64,
    /// Expected standard deviation of a length in a trial \[m\].
    pub accuracy_m: f64,
}

impl AdaptiveSpec {
    /// The goal with intervals of this level.
    pub fn goal(&self, level: f64) -> CampaignGoal {
        CampaignGoal {
            chi_share: self.chi_share,
            sphere_radius_m: self.sphere_radius_m,
            level,
            budget_s: self.budget_s,
            accuracy_m: self.accuracy_m,
        }
    }
}

/// Origin of a gait.
#[derive(Debug, Clone, PartialEq)]
pub enum GaitSource {
    /// A shape or a file.
    Gait(GaitSpec),
    /// Words after `swimmer optimize`.
    Optimize(Vec<String>),
}

/// Duration of a cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum SpecPeriod {
    /// Seconds.
    Seconds(f64),
    /// The shortest that the servos can play.
    Shortest,
}

/// Rules that end a trial or the run.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct StopRules {
    /// Attempts of a trial before it is given up.
    pub attempts: u32,
    /// Failed attempts in a row that end the run.
    pub failures_in_a_row: u32,
    /// Seconds without a pose that end the run.
    pub lost_s: f64,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Angle {
    Radians(f64),
    Text(String),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RawPeriod {
    Seconds(f64),
    Word(String),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    swimmer: String,
    drive: Option<String>,
    repeats: Option<Spanned<u32>>,
    adaptive: Option<RawAdaptive>,
    cycles: Option<Spanned<u32>>,
    run_in: Option<Spanned<u32>>,
    period: Option<Spanned<RawPeriod>>,
    settle: Option<Spanned<f64>>,
    seed: Option<u64>,
    level: Option<Spanned<f64>>,
    tank: Spanned<RawTank>,
    #[serde(default)]
    start: RawStart,
    #[serde(default)]
    stop: RawStop,
    #[serde(default)]
    gait: Vec<Spanned<RawGait>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawTank {
    length: f64,
    width: f64,
    margin: Option<f64>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawAdaptive {
    chi: Option<Spanned<f64>>,
    sphere_radius: Option<Spanned<f64>>,
    hours: Option<Spanned<f64>>,
    accuracy: Option<Spanned<f64>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawStart {
    x: Option<Spanned<f64>>,
    y: Option<Spanned<f64>>,
    heading: Option<Spanned<Angle>>,
    within: Option<Spanned<f64>>,
    within_angle: Option<Spanned<Angle>>,
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawStop {
    attempts: Option<Spanned<u32>>,
    failures_in_a_row: Option<Spanned<u32>>,
    lost: Option<Spanned<f64>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawGait {
    name: Option<Spanned<String>>,
    gait: Option<Spanned<String>>,
    optimize: Option<Spanned<String>>,
    neighbours: Option<Spanned<f64>>,
    period: Option<Spanned<RawPeriod>>,
    cycles: Option<Spanned<u32>>,
}

struct Text<'a> {
    text: &'a str,
    path: &'a Path,
}

impl Text<'_> {
    fn wrong(&self, span: &Range<usize>, problem: impl Into<String>) -> FileError {
        let before = self.text.get(..span.start).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before
            .rsplit('\n')
            .next()
            .map_or(0, |text| text.chars().count());
        FileError::at(self.path, line, column + 1, problem)
    }

    fn number(
        &self,
        value: Option<&Spanned<f64>>,
        default: f64,
        allowed: impl Fn(f64) -> bool,
        problem: &str,
    ) -> Result<f64, FileError> {
        let Some(value) = value else {
            return Ok(default);
        };
        let number = *value.get_ref();
        if number.is_finite() && allowed(number) {
            Ok(number)
        } else {
            Err(self.wrong(&value.span(), format!("{number} is {problem}")))
        }
    }

    fn count(
        &self,
        value: Option<&Spanned<u32>>,
        default: u32,
        least: u32,
    ) -> Result<u32, FileError> {
        let Some(value) = value else {
            return Ok(default);
        };
        let count = *value.get_ref();
        if (least..=MOST).contains(&count) {
            Ok(count)
        } else {
            let problem = format!("{count} is not between {least} and {MOST}");
            Err(self.wrong(&value.span(), problem))
        }
    }

    fn angle(&self, value: Option<&Spanned<Angle>>, default: f64) -> Result<f64, FileError> {
        let Some(value) = value else {
            return Ok(default);
        };
        let radians = match value.get_ref() {
            Angle::Radians(radians) => Ok(*radians),
            Angle::Text(text) => parse_angle(text).map_err(|error| error.to_string()),
        };
        let radians = radians.map_err(|problem| self.wrong(&value.span(), problem))?;
        if radians.abs() <= std::f64::consts::TAU {
            Ok(radians)
        } else {
            let problem = format!("{radians} is no angle in radians; write \"90deg\" for degrees");
            Err(self.wrong(&value.span(), problem))
        }
    }

    fn period(&self, value: &Spanned<RawPeriod>) -> Result<SpecPeriod, FileError> {
        let wrong = |problem: String| self.wrong(&value.span(), problem);
        match value.get_ref() {
            RawPeriod::Seconds(seconds) => {
                check_playable_period(*seconds).map_err(|error| wrong(error.to_string()))?;
                Ok(SpecPeriod::Seconds(*seconds))
            }
            RawPeriod::Word(word) if word == "shortest" => Ok(SpecPeriod::Shortest),
            RawPeriod::Word(word) => Err(wrong(format!(
                "`{word}` is no period; write seconds, or \"shortest\""
            ))),
        }
    }
}

impl Spec {
    /// Reads a spec.
    ///
    /// # Errors
    /// [`FileError`] with the place.
    pub fn load(path: &Path) -> Result<Self, FileError> {
        let text = std::fs::read_to_string(path).map_err(|source| FileError::Read {
            path: path.to_path_buf(),
            source,
        })?;
        Self::parse(&text, path)
    }

    /// Reads the text of a spec; `path` is for the errors only.
    ///
    /// # Errors
    /// [`FileError`] with the place.
    pub fn parse(text: &str, path: &Path) -> Result<Self, FileError> {
        let place = Text { text, path };
        let raw: Raw = toml::from_str(text).map_err(|error| {
            let span = error.span().unwrap_or_default();
            place.wrong(&span, error.message().to_owned())
        })?;
        let tank = raw.tank.get_ref();
        let margin_m = tank.margin.unwrap_or(0.01);
        let sides = [tank.length, tank.width];
        let is_tank = sides
            .iter()
            .all(|side| *side > 2.0 * margin_m && *side <= LARGEST_M)
            && margin_m >= 0.0;
        if !is_tank {
            let problem = "length and width are inner measures in metres, larger than twice the margin and at most 100";
            return Err(place.wrong(&raw.tank.span(), problem));
        }
        if raw.gait.is_empty() {
            return Err(place.wrong(
                &(text.len()..text.len()),
                "no [[gait]]: an experiment has at least one",
            ));
        }
        let period = raw.period.as_ref().map(|period| place.period(period));
        let defaults = Defaults {
            period: period.transpose()?.unwrap_or(SpecPeriod::Seconds(30.0)),
            cycles: place.count(raw.cycles.as_ref(), 3, 1)?,
        };
        let mut gaits: Vec<SpecGait> = Vec::with_capacity(raw.gait.len());
        for gait in &raw.gait {
            let read = read_gait(&place, gait, defaults)?;
            if gaits.iter().any(|before| before.name == read.name) {
                let problem = format!("two gaits are named `{}`; give each a name", read.name);
                return Err(place.wrong(&gait.span(), problem));
            }
            gaits.push(read);
        }
        let start = &raw.start;
        let positive = |value: f64| value > 0.0;
        let inside = |value: f64| value.abs() <= LARGEST_M;
        Ok(Self {
            tank: Tank {
                length: tank.length,
                width: tank.width,
            },
            margin_m,
            start: StartPose {
                x_m: place.number(start.x.as_ref(), 0.0, inside, "no position in metres")?,
                y_m: place.number(start.y.as_ref(), 0.0, inside, "no position in metres")?,
                heading_rad: place.angle(start.heading.as_ref(), 0.0)?,
                within_m: place.number(
                    start.within.as_ref(),
                    0.01,
                    positive,
                    "no distance in metres",
                )?,
                within_rad: place.angle(start.within_angle.as_ref(), 2_f64.to_radians())?,
            },
            gaits,
            repeats: read_repeats(&place, &raw)?,
            adaptive: raw
                .adaptive
                .as_ref()
                .map(|raw| read_adaptive(&place, raw))
                .transpose()?,
            run_in: place.count(raw.run_in.as_ref(), 1, 0)?,
            settle_s: place.number(
                raw.settle.as_ref(),
                20.0,
                |value| (0.0..=86_400.0).contains(&value),
                "no time in seconds up to a day",
            )?,
            seed: raw.seed.unwrap_or(1),
            level: place.number(
                raw.level.as_ref(),
                0.95,
                |value| value > 0.5 && value < 1.0,
                "no level between 0.5 and 1",
            )?,
            stop: StopRules {
                attempts: place.count(raw.stop.attempts.as_ref(), 3, 1)?,
                failures_in_a_row: place.count(raw.stop.failures_in_a_row.as_ref(), 3, 1)?,
                lost_s: place.number(
                    raw.stop.lost.as_ref(),
                    2.0,
                    |value| (0.1..=3600.0).contains(&value),
                    "no time in seconds from 0.1 to an hour",
                )?,
            },
            swimmer: raw.swimmer,
            drive: raw.drive,
        })
    }
}

#[derive(Clone, Copy)]
struct Defaults {
    period: SpecPeriod,
    cycles: u32,
}

/// Repeats of each gait, or 0 for an adaptive campaign.
fn read_repeats(place: &Text<'_>, raw: &Raw) -> Result<u32, FileError> {
    match (&raw.repeats, &raw.adaptive) {
        (Some(repeats), None) => place.count(Some(repeats), 1, 1),
        (None, Some(_)) => Ok(0),
        (Some(repeats), Some(_)) => {
            let problem = "an [adaptive] campaign has no `repeats`: it plays each gait as often as that helps";
            Err(place.wrong(&repeats.span(), problem))
        }
        (None, None) => {
            let problem = "no `repeats`: say how often each gait is played, or give the goal of an [adaptive] campaign";
            Err(place.wrong(&(0..0), problem))
        }
    }
}

fn read_adaptive(place: &Text<'_>, raw: &RawAdaptive) -> Result<AdaptiveSpec, FileError> {
    let share = |value: f64| value > 0.0 && value < 1.0;
    let length = |value: f64| value > 0.0 && value < LARGEST_M;
    let hours = place.number(
        raw.hours.as_ref(),
        10.0,
        |hours| hours > 0.0 && hours <= 8760.0,
        "no time in hours up to a year",
    )?;
    Ok(AdaptiveSpec {
        chi_share: place.number(
            raw.chi.as_ref(),
            0.01,
            share,
            "no share between 0 and 1, as 0.01 for χ ± 1 %",
        )?,
        sphere_radius_m: place.number(
            raw.sphere_radius.as_ref(),
            1e-3,
            length,
            "no length in metres",
        )?,
        budget_s: 3600.0 * hours,
        accuracy_m: place.number(
            raw.accuracy.as_ref(),
            USUAL_ACCURACY_M,
            length,
            "no length in metres",
        )?,
    })
}

fn read_gait(
    place: &Text<'_>,
    raw: &Spanned<RawGait>,
    defaults: Defaults,
) -> Result<SpecGait, FileError> {
    let gait = raw.get_ref();
    let source = match (&gait.gait, &gait.optimize) {
        (Some(spec), None) => {
            let parsed = spec.get_ref().parse::<GaitSpec>();
            let parsed = parsed.map_err(|error| place.wrong(&spec.span(), error.to_string()))?;
            GaitSource::Gait(parsed)
        }
        (None, Some(words)) => {
            let split: Vec<String> = words
                .get_ref()
                .split_whitespace()
                .map(str::to_owned)
                .collect();
            if split.is_empty() {
                let problem = "name an objective, as \"displacement --playable\"";
                return Err(place.wrong(&words.span(), problem));
            }
            GaitSource::Optimize(split)
        }
        _ => {
            let problem = "a [[gait]] has either `gait` or `optimize`";
            return Err(place.wrong(&raw.span(), problem));
        }
    };
    let name = match (&gait.name, &source) {
        (Some(name), _) => {
            if !is_name(name.get_ref()) {
                let problem = "a name has letters, digits, `-`, `+`, `.` and `_`, at most 40";
                return Err(place.wrong(&name.span(), problem));
            }
            name.get_ref().clone()
        }
        (None, GaitSource::Gait(_)) => {
            let text = gait.gait.as_ref().map_or("", |spec| spec.get_ref());
            let file = text.rsplit(['/', '\\']).next().unwrap_or(text);
            let name: String = file.strip_suffix(".gait").unwrap_or(file).to_owned();
            let name = name.replace(':', "-");
            if !is_name(&name) {
                return Err(place.wrong(&raw.span(), "give this gait a `name`"));
            }
            name
        }
        (None, GaitSource::Optimize(words)) => words.first().cloned().unwrap_or_default(),
    };
    let share = |value: f64| value > 0.0 && value < 1.0;
    let neighbours = gait.neighbours.as_ref();
    let neighbours = neighbours
        .map(|value| {
            place.number(
                Some(value),
                0.0,
                share,
                "no share between 0 and 1, as 0.1 for 10 % more and less",
            )
        })
        .transpose()?;
    let period = gait.period.as_ref().map(|period| place.period(period));
    Ok(SpecGait {
        name,
        source,
        neighbours,
        period: period.transpose()?.unwrap_or(defaults.period),
        cycles: place.count(gait.cycles.as_ref(), defaults.cycles, 1)?,
    })
}

/// Returns `true` for a name that is a file name on every system.
fn is_name(name: &str) -> bool {
    let allowed = |c: char| c.is_ascii_alphanumeric() || "-+._".contains(c);
    !name.is_empty() && name.len() <= 40 && name.chars().all(allowed) && !name.starts_with('.')
}

#[cfg(test)]
mod tests {
    use super::*;

    const GOOD: &str = "swimmer = \"robot\"\nrepeats = 2\n[tank]\nlength = 1.2\nwidth = 0.8\n[[gait]]\ngait = \"circle:50deg\"\n";

    fn error(text: &str) -> String {
        Spec::parse(text, "s.toml".as_ref())
            .unwrap_err()
            .to_string()
    }

    #[test]
    fn mistakes_are_named_with_their_place() {
        let cases = [
            (
                GOOD.replace("repeats = 2", "repeats = 0"),
                "s.toml:2:11: 0 is not",
            ),
            (
                GOOD.replace("width = 0.8", "width = -1.0"),
                "s.toml:3:1: length",
            ),
            (
                GOOD.replace("width", "wide"),
                "s.toml:5:1: unknown field `wide`",
            ),
            (
                GOOD.replace("circle", "cirle"),
                "s.toml:7:8: there is no gait",
            ),
            (
                format!("{GOOD}optimize = \"speed\"\n"),
                "s.toml:6:1: a [[gait]]",
            ),
            (
                format!("{GOOD}[[gait]]\ngait = \"circle:50deg\"\n"),
                "s.toml:8:1: two gaits",
            ),
            (
                format!("{GOOD}neighbours = 10\n"),
                "s.toml:8:14: 10 is no share",
            ),
            (
                format!("{GOOD}period = \"quick\"\n"),
                "s.toml:8:10: `quick`",
            ),
            (format!("{GOOD}name = \"../a\"\n"), "s.toml:8:8: a name"),
            (
                format!("{GOOD}[start]\nheading = 90\n"),
                "s.toml:9:11: 90 is no angle",
            ),
            (
                format!("{GOOD}[adaptive]\n"),
                "s.toml:2:11: an [adaptive] campaign",
            ),
            (
                GOOD.replace("repeats = 2\n", ""),
                "s.toml:1:1: no `repeats`",
            ),
            (
                format!(
                    "{}[adaptive]\nchi = 1.5\n",
                    GOOD.replace("repeats = 2\n", "")
                ),
                "s.toml:8:7: 1.5 is no share",
            ),
        ];
        for (text, expected) in cases {
            let found = error(&text);
            assert!(found.starts_with(expected), "{found}, expected {expected}");
        }
    }

    #[test]
    fn defaults_are_those_of_the_file() {
        let spec = Spec::parse(
            &format!("{GOOD}cycles = 20\nperiod = \"shortest\"\n[[gait]]\ngait = \"circle:1.2\"\n"),
            "s.toml".as_ref(),
        )
        .unwrap();
        assert_eq!((spec.gaits[0].cycles, spec.gaits[1].cycles), (20, 3));
        assert_eq!(spec.gaits[0].period, SpecPeriod::Shortest);
        assert_eq!(spec.gaits[1].period, SpecPeriod::Seconds(30.0));
        assert_eq!(spec.gaits[1].name, "circle-1.2");
    }
}
