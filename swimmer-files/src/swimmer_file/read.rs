//! TOML to swimmer: every key known, every value in range, every complaint with its place.

use std::ops::Range;
use std::path::Path;

use serde::Deserialize;
use swimmer_model::{Link, Links, Medium, Swimmer, TangentialDrag};
use toml::Spanned;

use super::{Fluid, ServoFile, SwimmerFile};
use crate::swimmer_file::per_link::{LinkNumbers, OneOrPerLink};

use crate::{FileError, PassiveFile, Quantity, Spring};

type Number = Spanned<f64>;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawFile {
    name: Option<String>,
    links: Spanned<RawLinks>,
    medium: Option<Spanned<RawMedium>>,
    drag: Option<Spanned<RawDrag>>,
    sphere: Option<Spanned<RawSphere>>,
    fluid: Option<Spanned<RawFluid>>,
    servo: Option<RawServo>,
    passive: Option<Spanned<RawPassive>>,
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
struct RawMedium {
    kind: Spanned<Kind>,
    aspect: Option<Number>,
    density: Option<Number>,
}

#[derive(Clone, Copy, PartialEq, Deserialize)]
#[serde(rename_all = "snake_case")]
enum Kind {
    Viscous,
    Perfect,
    Wheels,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawDrag {
    chi: Spanned<OneOrPerLink>,
    c_t: RawTangential,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum RawTangential {
    LogAspect(Number),
    HalfThickness(Number),
    OverViscosity(Spanned<OneOrPerLink>),
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawSphere {
    radius: Number,
    on: Option<RawLink>,
}

#[derive(Deserialize)]
#[serde(rename_all = "snake_case")]
enum RawLink {
    Middle,
    Front,
    Back,
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

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
struct RawPassive {
    joint: Spanned<String>,
    relaxation_s: Option<Number>,
    stiffness_n_m: Option<Number>,
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

    /// Reads a positive number for each link.
    fn per_link(&self, numbers: &LinkNumbers) -> Result<Links<f64>, FileError> {
        Ok(Links {
            middle: self.positive("middle", &numbers.middle)?,
            front: self.positive("front", &numbers.front)?,
            back: self.positive("back", &numbers.back)?,
        })
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
    let medium = medium(&source, raw.medium.as_ref())?;
    let swimmer = if medium == Medium::Viscous {
        let Some(drag) = &raw.drag else {
            return Err(source.error(&(0..0), "missing field `drag`"));
        };
        viscous(&source, links, drag.get_ref(), raw.sphere.as_ref())?
    } else {
        let unused = [
            ("drag", raw.drag.as_ref().map(Spanned::span)),
            ("sphere", raw.sphere.as_ref().map(Spanned::span)),
            ("fluid", raw.fluid.as_ref().map(Spanned::span)),
        ];
        if let Some((table, Some(span))) = unused.into_iter().find(|(_, span)| span.is_some()) {
            let problem = format!(
                "[{table}] has an effect in a viscous fluid only: leave it out, or write kind = \"viscous\" in [medium]"
            );
            return Err(source.error(&span, problem));
        }
        Swimmer {
            links,
            medium,
            ..Swimmer::purcell()
        }
    };
    swimmer.validate().map_err(|invalid| {
        source.error(
            &raw.links.span(),
            format!("this swimmer cannot be: {invalid}"),
        )
    })?;
    let has_fluid = raw.fluid.is_some();
    Ok(SwimmerFile {
        name: raw.name.unwrap_or_else(|| stem(path)),
        swimmer,
        fluid: raw
            .fluid
            .map(|raw| fluid(&source, raw.get_ref()))
            .transpose()?,
        servo: raw.servo.map(|raw| servo(&source, &raw)).transpose()?,
        passive: raw
            .passive
            .map(|raw| passive(&source, &raw, has_fluid))
            .transpose()?,
    })
}

fn medium(source: &Source<'_>, raw: Option<&Spanned<RawMedium>>) -> Result<Medium<f64>, FileError> {
    let Some(table) = raw else {
        return Ok(Medium::Viscous);
    };
    let RawMedium {
        kind,
        aspect,
        density,
    } = table.get_ref();
    match kind.get_ref() {
        Kind::Perfect => {
            let (Some(aspect), Some(density)) = (aspect, density) else {
                let problem = "a perfect fluid needs `aspect`, half width over half length of the links, and `density` in kg/m^3";
                return Err(source.error(&table.span(), problem));
            };
            let value = source.positive("aspect", aspect)?;
            if value > 1.0 {
                let problem = format!(
                    "aspect = {value} makes links wider than long: it is half width over half length, at most 1"
                );
                return Err(source.error(&aspect.span(), problem));
            }
            Ok(Medium::Perfect {
                aspect: value,
                density: source.positive("density", density)?,
            })
        }
        other => {
            let unused = [("aspect", aspect), ("density", density)];
            for (key, number) in unused {
                if let Some(number) = number {
                    let problem = format!(
                        "{key} has an effect in a perfect fluid only: leave it out, or write kind = \"perfect\""
                    );
                    return Err(source.error(&number.span(), problem));
                }
            }
            Ok(if *other == Kind::Wheels {
                Medium::Wheels
            } else {
                Medium::Viscous
            })
        }
    }
}

fn viscous(
    source: &Source<'_>,
    links: Links<f64>,
    drag: &RawDrag,
    sphere: Option<&Spanned<RawSphere>>,
) -> Result<Swimmer<f64>, FileError> {
    let (chi, side_chi) = match drag.chi.get_ref() {
        OneOrPerLink::One(value) => {
            let number = Spanned::new(drag.chi.span(), *value);
            (source.positive("chi", &number)?, None)
        }
        OneOrPerLink::PerLink(numbers) => {
            let values = source.per_link(numbers)?;
            (values.middle, Some([values.front, values.back]))
        }
    };
    let (sphere_radius, sphere_on) = match sphere.map(Spanned::get_ref) {
        Some(sphere) => (
            source.not_negative("radius", &sphere.radius)?,
            match sphere.on {
                None | Some(RawLink::Middle) => Link::Middle,
                Some(RawLink::Front) => Link::Front,
                Some(RawLink::Back) => Link::Back,
            },
        ),
        None => (0.0, Link::Middle),
    };
    Ok(Swimmer {
        links,
        chi,
        side_chi,
        tangential_drag: tangential(source, &drag.c_t, &links)?,
        sphere_radius,
        sphere_on: if sphere_radius > 0.0 {
            sphere_on
        } else {
            Link::Middle
        },
        medium: Medium::Viscous,
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
        RawTangential::OverViscosity(value) => match value.get_ref() {
            OneOrPerLink::One(number) => {
                let number = Spanned::new(value.span(), *number);
                TangentialDrag::OverViscosity(source.positive("over_viscosity", &number)?)
            }
            OneOrPerLink::PerLink(numbers) => TangentialDrag::PerLink(source.per_link(numbers)?),
        },
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

fn passive(
    source: &Source<'_>,
    raw: &Spanned<RawPassive>,
    has_fluid: bool,
) -> Result<PassiveFile, FileError> {
    let table = raw.get_ref();
    let joint = table.joint.get_ref().parse().map_err(|problem| {
        source.error(
            &table.joint.span(),
            format!("joint = \"{}\": {problem}", table.joint.get_ref()),
        )
    })?;
    let spring = match (&table.relaxation_s, &table.stiffness_n_m) {
        (Some(time), None) => Spring::Relaxation(source.positive("relaxation_s", time)?),
        (None, Some(stiffness)) if !has_fluid => {
            let problem = "stiffness_n_m needs the viscosity: add [fluid], or give relaxation_s";
            return Err(source.error(&stiffness.span(), problem));
        }
        (None, Some(stiffness)) => Spring::Stiffness(source.positive("stiffness_n_m", stiffness)?),
        _ => {
            let problem =
                "[passive] needs `relaxation_s` or `stiffness_n_m` (N m/rad), one of them";
            return Err(source.error(&raw.span(), problem));
        }
    };
    Ok(PassiveFile { joint, spring })
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
