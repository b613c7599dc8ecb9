//! Reader of the spec of a sweep: swimmer, objective, axes. Errors state their position in the file.

mod axes;

use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use swimmer_files::{FileError, SwimmerFile, parse_angle, parse_rate};
use swimmer_model::InvalidSwimmer;
use toml::Spanned;

use crate::objective::Aim;
use crate::plan::{Axis, Content, Design, KeptBounds, Scale};
use crate::{Field, SweepError};
use axes::designs;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct Raw {
    swimmer: Spanned<String>,
    objective: Option<Spanned<String>>,
    gait: Option<Spanned<String>>,
    max_rate: Option<Spanned<RawRates>>,
    design: Option<Spanned<String>>,
    count: Option<Spanned<u64>>,
    seed: Option<Spanned<u64>>,
    starts: Option<Spanned<u32>>,
    block: Option<Spanned<u64>>,
    anchor: Option<Spanned<u64>>,
    #[serde(default)]
    bounds: RawBounds,
    axis: Option<Vec<Spanned<RawAxis>>>,
}

#[derive(Deserialize)]
#[serde(untagged)]
enum Number {
    Plain(f64),
    Angle(String),
    Choice(bool),
}

#[derive(Deserialize)]
#[serde(untagged)]
enum RawRates {
    Both(Number),
    Each([Number; 2]),
}

#[derive(Deserialize, Default)]
#[serde(deny_unknown_fields, default)]
struct RawBounds {
    max_angle: Option<Spanned<Number>>,
    min_angle: Option<Spanned<Number>>,
    sector: bool,
    no_overlap: bool,
    clearance: Option<Spanned<Number>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawAxis {
    name: Spanned<String>,
    values: Option<Spanned<Vec<Number>>>,
    from: Option<Number>,
    to: Option<Number>,
    count: Option<Spanned<u64>>,
    scale: Option<Scale>,
}

/// Most tasks of a plan: their keys are whole numbers in every program that reads the table.
const MOST_TASKS: u64 = 1 << 53;
/// Approximate default number of blocks, small enough to list folders quickly; and the least size of a block.
const BLOCKS: u64 = 10_000;
const LEAST_BLOCK: u64 = 64;
const MOST_BLOCK: u64 = 1 << 20;
/// Default interval between tasks of a block that are solved by a search, which checks the continuation between them.
const ANCHOR: u64 = 16;

struct Text<'a> {
    text: &'a str,
    path: &'a Path,
}

impl Text<'_> {
    fn wrong(&self, span: Range<usize>, problem: impl Into<String>) -> SweepError {
        let before = self.text.get(..span.start).unwrap_or_default();
        let line = before.matches('\n').count() + 1;
        let column = before
            .rsplit('\n')
            .next()
            .unwrap_or_default()
            .chars()
            .count()
            + 1;
        FileError::at(self.path, line, column, problem).into()
    }

    /// Reads a positive number of a field.
    fn positive(
        &self,
        field: Field,
        number: &Number,
        span: &Range<usize>,
    ) -> Result<f64, SweepError> {
        let value = self.number(field, number, span)?;
        if value > 0.0 && value.is_finite() {
            Ok(value)
        } else {
            let name = field.name();
            let name = name.strip_prefix("bounds.").unwrap_or(name);
            Err(self.wrong(span.clone(), format!("{name} = {value} must be above zero")))
        }
    }

    /// Reads a number of a field and refuses a value in a wrong unit.
    fn number(
        &self,
        field: Field,
        number: &Number,
        span: &Range<usize>,
    ) -> Result<f64, SweepError> {
        let parse = match field {
            Field::MaxRate => parse_rate,
            _ => parse_angle,
        };
        match number {
            Number::Plain(value) => match field.quantity().map(|of| of.checked(*value)) {
                Some(Err(slip)) => Err(self.wrong(span.clone(), slip.of_key(field.name()))),
                _ => Ok(*value),
            },
            Number::Choice(_) => Err(self.wrong(
                span.clone(),
                "a number is meant here, or an angle such as \"160deg\"",
            )),
            Number::Angle(text) => {
                parse(text).map_err(|error| self.wrong(span.clone(), error.to_string()))
            }
        }
    }
}

/// Reads a spec and returns the content of its plan.
pub(crate) fn read(text: &str, path: &Path) -> Result<Content, SweepError> {
    let raw: Raw = toml::from_str(text).map_err(|error| {
        let at = error.span().unwrap_or(0..0);
        Text { text, path }.wrong(at, error.message())
    })?;
    let source = Text { text, path };
    let folder = path.parent().unwrap_or(Path::new(""));
    let base = SwimmerFile::find_from(raw.swimmer.get_ref(), folder)?;
    let (axis, design) = designs(&source, &raw)?;
    let changes_drag = axis.iter().any(|axis| axis.name.is_of_the_drag());
    if let (true, Err(reason)) = (changes_drag, base.swimmer.common_drag()) {
        let problem = InvalidSwimmer::Uncommon(reason).to_string();
        return Err(source.wrong(raw.swimmer.span(), problem));
    }
    let objectives = objectives(&source, &raw, &axis)?;
    let tasks = tasks(&source, &raw, &axis, design)?;
    let max_rate = raw.max_rate.as_ref().map(|given| {
        let rate = |one| source.positive(Field::MaxRate, one, &given.span());
        match given.get_ref() {
            RawRates::Both(both) => rate(both).map(|rate| [rate; 2]),
            RawRates::Each([one, two]) => Ok([rate(one)?, rate(two)?]),
        }
    });
    let max_rate = max_rate.transpose()?;
    if objectives.contains(&Aim::Speed)
        && max_rate.is_none()
        && !axis.iter().any(|axis| axis.name == Field::MaxRate)
    {
        return Err(source.wrong(
            raw.objective.as_ref().map_or(0..0, Spanned::span),
            "without a limit of the servos there is no fastest gait: say max_rate = 1.0 (rad/s) or \"60deg\", or make it an axis",
        ));
    }
    Ok(Content {
        format: String::new(),
        version: String::new(),
        objective: objectives.first().copied().unwrap_or(Aim::Displacement),
        block: within(&source, "block", raw.block.as_ref(), 1..=MOST_BLOCK)?
            .unwrap_or_else(|| tasks.div_ceil(BLOCKS).next_power_of_two().max(LEAST_BLOCK))
            .min(MOST_BLOCK),
        anchor: within(&source, "anchor", raw.anchor.as_ref(), 1..=1_000)?.unwrap_or(ANCHOR),
        starts: raw.starts.as_ref().map(|starts| *starts.get_ref()),
        max_rate,
        swimmer: base.to_toml(),
        bounds: bounds(&source, &raw.bounds)?,
        design,
        axis,
    })
}

fn within(
    source: &Text<'_>,
    name: &str,
    number: Option<&Spanned<u64>>,
    range: std::ops::RangeInclusive<u64>,
) -> Result<Option<u64>, SweepError> {
    let Some(number) = number else {
        return Ok(None);
    };
    if range.contains(number.get_ref()) {
        return Ok(Some(*number.get_ref()));
    }
    Err(source.wrong(
        number.span(),
        format!(
            "{name} = {} must be from {} to {}",
            number.get_ref(),
            range.start(),
            range.end()
        ),
    ))
}

/// Objectives of the gaits, given once or as an axis, with a check that all axes apply to them.
fn objectives(source: &Text<'_>, raw: &Raw, axes: &[Axis]) -> Result<Vec<Aim>, SweepError> {
    let axis = axes.iter().find(|axis| axis.name == Field::Objective);
    let objectives = match (&raw.objective, axis) {
        (Some(given), None) => vec![aim(source, raw, given)?],
        (None, Some(axis)) => (0..axis.count())
            .filter_map(|index| Aim::of_index(axis.value(index)))
            .collect(),
        (None, None) => {
            return Err(source.wrong(
                0..0,
                "no objective: say objective = \"displacement\", or make it an axis with values = [\"displacement\", \"speed\"]",
            ));
        }
        (Some(given), Some(_)) => {
            return Err(source.wrong(
                given.span(),
                "the objective is an axis, too: leave it out here",
            ));
        }
    };
    let of_quarters = raw.axis.iter().flatten().zip(axes);
    for (given, axis) in of_quarters.filter(|(_, axis)| axis.name.of_quarters()) {
        if objectives.iter().any(|aim| *aim != Aim::Displacement) {
            return Err(source.wrong(
                given.get_ref().name.span(),
                format!("{} is a bound of displacement gaits alone", axis.name),
            ));
        }
    }
    Ok(objectives)
}

fn aim(source: &Text<'_>, raw: &Raw, given: &Spanned<String>) -> Result<Aim, SweepError> {
    let word = given.get_ref().as_str();
    let gait = raw.gait.as_ref().map(|gait| gait.get_ref().as_str());
    if let (Some(gait), true) = (&raw.gait, word != "efficiency") {
        return Err(source.wrong(
            gait.span(),
            "small and large are the two efficiency gaits: leave `gait` out, or say objective = \"efficiency\"",
        ));
    }
    match (word, gait) {
        ("displacement", _) => Ok(Aim::Displacement),
        ("efficiency", Some("small") | None) => Ok(Aim::EfficiencySmall),
        ("efficiency", Some("large")) => Ok(Aim::EfficiencyLarge),
        ("efficiency", Some(other)) => Err(source.wrong(
            raw.gait.as_ref().map_or(0..0, Spanned::span),
            format!("gait = \"{other}\" is not one of small and large"),
        )),
        ("speed", _) => Ok(Aim::Speed),
        ("turning", _) => Ok(Aim::Turning),
        ("sideways", _) => Ok(Aim::Sideways),
        ("stub", _) => Ok(Aim::Stub),
        (other, _) => Err(source.wrong(
            given.span(),
            format!(
                "objective = \"{other}\" is none of displacement, efficiency, speed, turning, sideways (and stub, which solves \
                 nothing, to try out a scheduler)"
            ),
        )),
    }
}

fn bounds(source: &Text<'_>, raw: &RawBounds) -> Result<KeptBounds, SweepError> {
    let positive = |field: Field, number: &Option<Spanned<Number>>| {
        number
            .as_ref()
            .map(|number| source.positive(field, number.get_ref(), &number.span()))
            .transpose()
    };
    Ok(KeptBounds {
        max_angle: positive(Field::MaxAngle, &raw.max_angle)?,
        min_angle: positive(Field::MinAngle, &raw.min_angle)?,
        sector: raw.sector,
        no_overlap: raw.no_overlap,
        clearance: positive(Field::Clearance, &raw.clearance)?.unwrap_or(0.0),
    })
}

fn tasks(source: &Text<'_>, raw: &Raw, axes: &[Axis], design: Design) -> Result<u64, SweepError> {
    let tasks = match design {
        Design::Grid => axes
            .iter()
            .try_fold(1_u64, |product, axis| product.checked_mul(axis.count())),
        Design::Random { count, .. } | Design::Sobol { count, .. } => Some(count),
    };
    let span = raw.count.as_ref().map_or(0..0, Spanned::span);
    if let (Design::Sobol { .. }, Some(count)) = (design, tasks)
        && count > Design::MOST_SOBOL
    {
        return Err(source.wrong(
            span,
            format!(
                "a sobol design has at most {} points: take design = \"random\" for more",
                Design::MOST_SOBOL
            ),
        ));
    }
    tasks
        .filter(|tasks| (1..=MOST_TASKS).contains(tasks))
        .ok_or_else(|| source.wrong(span, "a plan has from 1 to 2^53 tasks"))
}
