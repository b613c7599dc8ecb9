//! TOML to swimmer: every key known, every value in range, every complaint with its place.

use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use swimmer_model::{Links, Swimmer, TangentialDrag};
use toml::Spanned;

use super::{Fluid, ServoFile, SwimmerFile};
use crate::{FileError, Quantity};

type Number = Spanned<f64>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    name: Option<String>,
    links: Spanned<RawLinks>,
    drag: RawDrag,
    sphere: Option<RawSphere>,
    fluid: Option<RawFluid>,
    servo: Option<RawServo>,
    /// Says where the file comes from, not what swims.
    #[serde(rename = "provenance")]
    _provenance: Option<crate::Provenance>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawLinks {
    middle: Number,
    side: Option<Number>,
    front: Option<Number>,
    back: Option<Number>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDrag {
    chi: Number,
    c_t: RawTangential,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum RawTangential {
    LogAspect(Number),
    HalfThickness(Number),
    OverViscosity(Number),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSphere {
    radius: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFluid {
    kinematic_viscosity: Number,
    density: Number,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawServo {
    max_angle: Option<Number>,
    max_rate: Option<Number>,
    dead_band: Option<Number>,
    slope_rad_per_us: Option<Number>,
    centre_us: Option<Number>,
    torque_n_m: Option<Number>,
    no_load_rate: Option<Number>,
}

/// A TOML text being read: makes errors with places out of byte ranges.
struct Source<'a> {
    text: &'a str,
    path: &'a Path,
}

impl Source<'_> {
    fn error(&self, span: &Range<usize>, problem: impl Into<String>) -> FileError {
        FileError::at_offset(self.path, self.text, span.start, problem)
    }

    fn positive(&self, key: &str, number: &Number) -> Result<f64, FileError> {
        let value = *number.get_ref();
        if value.is_finite() && value > 0.0 {
            Ok(value)
        } else {
            Err(self.error(
                &number.span(),
                format!("{key} = {value} must be a positive number"),
            ))
        }
    }

    /// Reads a positive number of a quantity, and refuses a slip of its unit.
    fn quantity(&self, key: &str, number: &Number, quantity: Quantity) -> Result<f64, FileError> {
        let value = self.positive(key, number)?;
        let slip = |slip: crate::Slip| self.error(&number.span(), slip.of_key(key));
        quantity.checked(value).map_err(slip)
    }

    fn length(&self, key: &str, number: &Number) -> Result<f64, FileError> {
        self.quantity(key, number, Quantity::Length)
    }

    /// Refuses a number that can only be degrees where radians are read.
    fn radians(&self, key: &str, number: Option<&Number>, limit: f64) -> Result<(), FileError> {
        let Some(number) = number.filter(|number| number.get_ref().abs() > limit) else {
            return Ok(());
        };
        let value = *number.get_ref();
        Err(self.error(
            &number.span(),
            format!(
                "{key} = {value} is in radians: did you mean {value}°? Write {key} = {:.6}",
                value.to_radians()
            ),
        ))
    }

    fn not_negative(&self, key: &str, number: &Number) -> Result<f64, FileError> {
        let value = *number.get_ref();
        if value.is_finite() && value >= 0.0 {
            Ok(value)
        } else {
            Err(self.error(
                &number.span(),
                format!("{key} = {value} must be zero or a positive number"),
            ))
        }
    }
}

pub(super) fn swimmer_file(text: &str, path: &Path) -> Result<SwimmerFile, FileError> {
    let raw: RawFile = crate::toml_text::parse(text, path)?;
    let source = Source { text, path };
    let links = links(&source, &raw.links)?;
    let swimmer = Swimmer {
        links,
        chi: source.positive("chi", &raw.drag.chi)?,
        tangential_drag: tangential(&source, &raw.drag.c_t, &links)?,
        sphere_radius: match &raw.sphere {
            Some(sphere) => source.not_negative("radius", &sphere.radius)?,
            None => 0.0,
        },
    };
    swimmer.validate().map_err(|invalid| {
        source.error(
            &raw.links.span(),
            format!("this swimmer cannot be: {invalid}"),
        )
    })?;
    Ok(SwimmerFile {
        name: raw.name.unwrap_or_else(|| stem(path)),
        swimmer,
        fluid: raw.fluid.map(|raw| fluid(&source, &raw)).transpose()?,
        servo: raw.servo.map(|raw| servo(&source, &raw)).transpose()?,
    })
}

fn links(source: &Source<'_>, raw: &Spanned<RawLinks>) -> Result<Links<f64>, FileError> {
    let table = raw.get_ref();
    let middle = source.length("middle", &table.middle)?;
    let (front, back) = match (&table.side, &table.front, &table.back) {
        (Some(side), None, None) => {
            let side = source.length("side", side)?;
            (side, side)
        }
        (None, Some(front), Some(back)) => {
            (source.length("front", front)?, source.length("back", back)?)
        }
        _ => {
            let problem =
                "[links] needs `side` (both side links alike) or `front` and `back`, not a mixture";
            return Err(source.error(&raw.span(), problem));
        }
    };
    Ok(Links {
        middle,
        front,
        back,
    })
}

fn tangential(
    source: &Source<'_>,
    raw: &RawTangential,
    links: &Links<f64>,
) -> Result<TangentialDrag<f64>, FileError> {
    Ok(match raw {
        RawTangential::LogAspect(number) => {
            TangentialDrag::LogAspect(source.positive("log_aspect", number)?)
        }
        RawTangential::HalfThickness(number) => {
            let thickness = source.positive("half_thickness", number)?;
            let shortest = links.middle.min(links.front).min(links.back);
            if thickness >= shortest {
                let problem = format!(
                    "half_thickness = {thickness} m is no less than the shortest link, {shortest} m: ln(l/a) must be positive"
                );
                return Err(source.error(&number.span(), problem));
            }
            TangentialDrag::HalfThickness(thickness)
        }
        RawTangential::OverViscosity(number) => {
            TangentialDrag::OverViscosity(source.positive("over_viscosity", number)?)
        }
    })
}

fn fluid(source: &Source<'_>, raw: &RawFluid) -> Result<Fluid, FileError> {
    Ok(Fluid {
        kinematic_viscosity: source.positive("kinematic_viscosity", &raw.kinematic_viscosity)?,
        density: source.positive("density", &raw.density)?,
    })
}

fn servo(source: &Source<'_>, raw: &RawServo) -> Result<ServoFile, FileError> {
    let ServoFile {
        max_angle,
        max_rate,
        dead_band,
        slope_rad_per_us,
        centre_us,
        torque: _,
        no_load_rate: _,
    } = ServoFile::default();
    let positive = |key: &str, number: &Option<Number>, standard: f64| {
        number
            .as_ref()
            .map_or(Ok(standard), |number| source.positive(key, number))
    };
    for (key, number, limit) in [
        ("dead_band", &raw.dead_band, LARGEST_DEAD_BAND),
        ("slope_rad_per_us", &raw.slope_rad_per_us, LARGEST_SLOPE),
    ] {
        source.radians(key, number.as_ref(), limit)?;
    }
    let quantity = |key: &str, number: &Option<Number>, quantity: Quantity, standard: f64| {
        number.as_ref().map_or(Ok(standard), |number| {
            source.quantity(key, number, quantity)
        })
    };
    let known = |key: &str, number: &Option<Number>| {
        let number = number.as_ref();
        number
            .map(|number| source.positive(key, number))
            .transpose()
    };
    Ok(ServoFile {
        max_angle: quantity("max_angle", &raw.max_angle, Quantity::Angle, max_angle)?,
        max_rate: quantity("max_rate", &raw.max_rate, Quantity::Rate, max_rate)?,
        dead_band: match &raw.dead_band {
            Some(number) => source.not_negative("dead_band", number)?,
            None => dead_band,
        },
        slope_rad_per_us: positive("slope_rad_per_us", &raw.slope_rad_per_us, slope_rad_per_us)?,
        centre_us: quantity("centre_us", &raw.centre_us, Quantity::Pulse, centre_us)?,
        torque: known("torque_n_m", &raw.torque_n_m)?,
        no_load_rate: raw
            .no_load_rate
            .as_ref()
            .map(|number| source.quantity("no_load_rate", number, Quantity::Rate))
            .transpose()?,
    })
}

/// Half-width of a dead band beyond which no servo is of use, and degrees were meant \[rad\].
const LARGEST_DEAD_BAND: f64 = 0.5;
/// Ten times the slope of the steepest sail winch \[rad/µs\]: beyond it, degrees were meant.
const LARGEST_SLOPE: f64 = 0.27;

fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(
        || "swimmer".to_owned(),
        |stem| stem.to_string_lossy().into_owned(),
    )
}
