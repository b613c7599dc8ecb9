//! Axes of a spec, and the selection of their points as designs.

use toml::Spanned;

use super::{Number, Raw, RawAxis, Text};
use crate::plan::{Axis, Design, Scale, Values};
use crate::{Field, SweepError};

/// Reads the axes and the selection of the designs.
pub(super) fn designs(source: &Text<'_>, raw: &Raw) -> Result<(Vec<Axis>, Design), SweepError> {
    let kind = raw.design.as_ref().map_or("grid", |kind| kind.get_ref());
    let span = raw.design.as_ref().map_or(0..0, Spanned::span);
    let seed = raw.seed.as_ref().map_or(1, |seed| *seed.get_ref());
    let count = || {
        raw.count
            .as_ref()
            .map(|count| *count.get_ref())
            .ok_or_else(|| {
                source.wrong(
                    span.clone(),
                    format!("a {kind} design needs count = the number of points"),
                )
            })
    };
    let design = match kind {
        "grid" => {
            if let Some(count) = &raw.count {
                return Err(source.wrong(
                    count.span(),
                    "the points of a grid are counted axis by axis: put count into each [[axis]], or say design = \"random\"",
                ));
            }
            Design::Grid
        }
        "random" => Design::Random {
            count: count()?,
            seed,
        },
        "sobol" => Design::Sobol {
            count: count()?,
            seed: u32::try_from(seed).map_err(|_| {
                source.wrong(
                    raw.seed.as_ref().map_or(0..0, Spanned::span),
                    "the seed of a sobol design is at most 4294967295",
                )
            })?,
        },
        other => {
            return Err(source.wrong(
                span,
                format!("design = \"{other}\" is not one of grid, random and sobol"),
            ));
        }
    };
    let mut axes: Vec<Axis> = Vec::new();
    for told in raw.axis.iter().flatten() {
        let axis = axis(source, told, design == Design::Grid)?;
        let name = told.get_ref().name.span();
        if let Some(other) = axes.iter().find(|other| other.name.clashes(axis.name)) {
            return Err(source.wrong(
                name,
                format!(
                    "{} and {} say the same thing twice: keep one",
                    other.name, axis.name
                ),
            ));
        }
        if axis.name == Field::NoOverlap && raw.bounds.clearance.is_some() {
            return Err(source.wrong(
                name,
                "a clearance keeps the links apart in every design: leave it out, or make bounds.clearance the axis",
            ));
        }
        axes.push(axis);
    }
    if axes.is_empty() {
        return Err(source.wrong(
            0..0,
            "no [[axis]]: say what changes, as name = \"drag.chi\" with values, or with from, to and count",
        ));
    }
    Ok((axes, design))
}

const CHOICE: &str = "say values = [false, true], in a grid";
const OBJECTIVES: &str = "say values = [\"displacement\", \"efficiency small\", \"efficiency large\", \"speed\", \"turning\", \"sideways\"], or some \
                          of them, in a grid";

fn axis(source: &Text<'_>, told: &Spanned<RawAxis>, grid: bool) -> Result<Axis, SweepError> {
    let raw = told.get_ref();
    let name = field(source, &raw.name)?;
    let span = told.span();
    let mistake = |problem: &str| source.wrong(span.clone(), format!("axis {name}: {problem}"));
    let wrong = |problem: &str| Err(mistake(problem));
    let number = |number: &Number| match (number, name.chooses()) {
        (Number::Angle(word), _) if name == Field::Objective => {
            name.parse(word).ok_or_else(|| mistake(OBJECTIVES))
        }
        _ if name == Field::Objective => Err(mistake(OBJECTIVES)),
        (Number::Choice(choice), true) => Ok(f64::from(u8::from(*choice))),
        (Number::Choice(_), false) => {
            Err(mistake("its values are numbers, neither true nor false"))
        }
        (_, true) => Err(mistake(CHOICE)),
        (number, false) => source.number(name, number, &span),
    };
    if name == Field::Objective && raw.values.is_none() {
        return wrong(OBJECTIVES);
    }
    if name.chooses() && raw.values.is_none() {
        return wrong(CHOICE);
    }
    let values = match (&raw.values, &raw.from, &raw.to) {
        (Some(values), None, None) => {
            if !grid {
                return wrong(
                    "a random or sobol design draws between from and to, not from values",
                );
            }
            if raw.count.is_some() || raw.scale.is_some() {
                return wrong("count and scale go with from and to, not with values");
            }
            let values: Result<Vec<f64>, _> = values.get_ref().iter().map(number).collect();
            Values::List { values: values? }
        }
        (None, Some(from), Some(to)) => Values::Range {
            from: number(from)?,
            to: number(to)?,
            count: match (&raw.count, grid) {
                (Some(count), true) => *count.get_ref(),
                (None, true) => return wrong("a grid needs count = the number of values"),
                (Some(_), false) => return wrong("count belongs to the whole design here"),
                (None, false) => 0,
            },
            scale: raw.scale.unwrap_or(Scale::Lin),
        },
        _ => return wrong("say values = [...], or from and to"),
    };
    let axis = Axis { name, values };
    let ends = match &axis.values {
        Values::List { values } => values.clone(),
        Values::Range { from, to, .. } => vec![*from, *to],
    };
    if ends.is_empty() || (grid && axis.count() == 0) {
        return wrong("it has no values");
    }
    let bad = |value: &&f64| {
        !value.is_finite() || **value < 0.0 || (**value == 0.0 && !name.may_be_zero())
    };
    if let Some(value) = ends.iter().find(bad) {
        return wrong(&format!("{value} is no value of it"));
    }
    if let Values::Range {
        scale: Scale::Log,
        from,
        to,
        ..
    } = axis.values
        && (from <= 0.0 || to <= 0.0)
    {
        return wrong("on a log scale from and to must be above zero");
    }
    Ok(axis)
}

fn field(source: &Text<'_>, name: &Spanned<String>) -> Result<Field, SweepError> {
    let told = name.get_ref().as_str();
    if let Some(field) = Field::ALL.into_iter().find(|field| field.name() == told) {
        return Ok(field);
    }
    if told.starts_with("fluid.") || told.starts_with("servo.") || told == "name" {
        return Err(source.wrong(
            name.span(),
            format!(
                "{told} does not change which gait is best, so all designs would be alike; for the servos' limits take \
                 bounds.max_angle and max_rate"
            ),
        ));
    }
    let nearest = Field::ALL
        .into_iter()
        .map(|field| (strsim::jaro_winkler(field.name(), told), field))
        .max_by(|(a, _), (b, _)| a.total_cmp(b))
        .filter(|(near, _)| *near > 0.8)
        .map_or_else(String::new, |(_, field)| {
            format!(" (did you mean {field}?)")
        });
    let all: Vec<_> = Field::ALL.into_iter().map(Field::name).collect();
    Err(source.wrong(
        name.span(),
        format!(
            "there is no field {told}{nearest}; an axis is one of {}",
            all.join(", ")
        ),
    ))
}
