//! Parameters that an axis can vary: fields of the swimmer file that affect a gait, bounds, and the servos' rate.

use std::fmt;

use gait_optimizer::{Bounds, Parameter};
use serde::{Deserialize, Serialize};
use swimmer_files::Quantity;
use swimmer_model::{Swimmer, TangentialDrag};

use crate::Aim;

/// Parameter of a design that an axis varies.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Field {
    /// Length of the middle link \[m\].
    #[serde(rename = "links.middle")]
    Middle,
    /// Length of both side links \[m\].
    #[serde(rename = "links.side")]
    Side,
    /// Length of the front link \[m\].
    #[serde(rename = "links.front")]
    Front,
    /// Length of the back link \[m\].
    #[serde(rename = "links.back")]
    Back,
    /// l₁/l₀ at the same total length.
    #[serde(rename = "links.ratio")]
    Ratio,
    /// χ.
    #[serde(rename = "drag.chi")]
    Chi,
    /// ln(l/a), common to all links.
    #[serde(rename = "drag.c_t.log_aspect")]
    LogAspect,
    /// Half thickness of the links \[m\].
    #[serde(rename = "drag.c_t.half_thickness")]
    HalfThickness,
    /// `c_t/μ`.
    #[serde(rename = "drag.c_t.over_viscosity")]
    OverViscosity,
    /// Radius of the sphere \[m\].
    #[serde(rename = "sphere.radius")]
    Sphere,
    /// Largest joint angle \[rad\].
    #[serde(rename = "bounds.max_angle")]
    MaxAngle,
    /// Least angle of the leading joint \[rad\].
    #[serde(rename = "bounds.min_angle")]
    MinAngle,
    /// Clearance of the side links \[m\].
    #[serde(rename = "bounds.clearance")]
    Clearance,
    /// Bound to the sector φ₁ ≥ |φ₂|: 0 or 1.
    #[serde(rename = "bounds.sector")]
    Sector,
    /// Bound that the side links do not cross: 0 or 1.
    #[serde(rename = "bounds.no_overlap")]
    NoOverlap,
    /// Largest rate of both servos \[rad/s\].
    #[serde(rename = "max_rate")]
    MaxRate,
    /// Objective: an index into [`Aim::ALL`].
    #[serde(rename = "objective")]
    Objective,
}

/// Design: everything on which its best gait depends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Design {
    pub(crate) swimmer: Swimmer<f64>,
    pub(crate) bounds: Bounds,
    /// Largest |φ̇ᵢ| \[rad/s\], if given.
    pub(crate) rates: Option<[f64; 2]>,
    /// Objective of the gait.
    pub(crate) aim: Aim,
}

impl Field {
    /// All parameters.
    pub const ALL: [Self; 17] = [
        Self::Middle,
        Self::Side,
        Self::Front,
        Self::Back,
        Self::Ratio,
        Self::Chi,
        Self::LogAspect,
        Self::HalfThickness,
        Self::OverViscosity,
        Self::Sphere,
        Self::MaxAngle,
        Self::MinAngle,
        Self::Clearance,
        Self::Sector,
        Self::NoOverlap,
        Self::MaxRate,
        Self::Objective,
    ];

    /// Name in a spec, a dotted path.
    pub fn name(self) -> &'static str {
        match self {
            Self::Middle => "links.middle",
            Self::Side => "links.side",
            Self::Front => "links.front",
            Self::Back => "links.back",
            Self::Ratio => "links.ratio",
            Self::Chi => "drag.chi",
            Self::LogAspect => "drag.c_t.log_aspect",
            Self::HalfThickness => "drag.c_t.half_thickness",
            Self::OverViscosity => "drag.c_t.over_viscosity",
            Self::Sphere => "sphere.radius",
            Self::MaxAngle => "bounds.max_angle",
            Self::MinAngle => "bounds.min_angle",
            Self::Clearance => "bounds.clearance",
            Self::Sector => "bounds.sector",
            Self::NoOverlap => "bounds.no_overlap",
            Self::MaxRate => "max_rate",
            Self::Objective => "objective",
        }
    }

    /// Name in words, with its symbol at the end, for axes of figures.
    pub fn words(self) -> &'static str {
        match self {
            Self::Middle => "middle link l₀",
            Self::Side => "side links l₁",
            Self::Front => "front link l₁",
            Self::Back => "back link l₂",
            Self::Ratio => "ratio of the links l₁/l₀",
            Self::Chi => "drag ratio χ",
            Self::LogAspect => "logarithm of the links' aspect ratio",
            Self::HalfThickness => "half thickness of the links",
            Self::OverViscosity => "tangential drag over viscosity",
            Self::Sphere => "radius of the sphere r_s",
            Self::MaxAngle => "largest joint angle",
            Self::MinAngle => "least joint angle",
            Self::Clearance => "clearance of the side links",
            Self::Sector => "bound to a sector",
            Self::NoOverlap => "side links do not cross",
            Self::MaxRate => "servo rate",
            Self::Objective => "objective",
        }
    }

    /// Quantity by which bare numbers are checked for a wrong unit. Returns `None` if there is no such check.
    pub(crate) fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Middle | Self::Side | Self::Front | Self::Back => Some(Quantity::Length),
            Self::MaxAngle | Self::MinAngle => Some(Quantity::Angle),
            Self::MaxRate => Some(Quantity::Rate),
            _ => None,
        }
    }

    /// Unit; empty for a dimensionless parameter.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Middle
            | Self::Side
            | Self::Front
            | Self::Back
            | Self::HalfThickness
            | Self::Sphere
            | Self::Clearance => "m",
            Self::MaxAngle | Self::MinAngle => "rad",
            Self::MaxRate => "rad/s",
            Self::Ratio
            | Self::Chi
            | Self::LogAspect
            | Self::OverViscosity
            | Self::Sector
            | Self::NoOverlap
            | Self::Objective => "",
        }
    }

    /// Returns `true` if zero is a valid value.
    pub(crate) fn may_be_zero(self) -> bool {
        matches!(self, Self::Sphere | Self::Clearance | Self::Objective) || self.chooses()
    }

    /// Returns `true` if its values are false and true, stored as 0 and 1.
    pub(crate) fn chooses(self) -> bool {
        matches!(self, Self::Sector | Self::NoOverlap)
    }

    /// Returns `true` if the maximised quantity is comparable between its values.
    pub(crate) fn compares(self) -> bool {
        self != Self::Objective
    }

    /// Value given as a word, which only the objective has. Returns `None` for an invalid word.
    pub fn parse(self, text: &str) -> Option<f64> {
        match self {
            Self::Objective => Aim::of_word(text).map(Aim::index),
            _ => text.parse().ok(),
        }
    }

    /// Returns `true` if it bounds a quarter and therefore applies to displacement gaits only.
    pub(crate) fn of_quarters(self) -> bool {
        matches!(self, Self::MinAngle | Self::Sector)
    }

    /// +1 if a larger value admits more gaits, −1 if it admits fewer, 0 otherwise.
    pub(crate) fn widens(self) -> i8 {
        match self {
            Self::MaxAngle | Self::MaxRate => 1,
            // The sector selects a gait of the other sense.
            Self::MinAngle | Self::Clearance | Self::NoOverlap => -1,
            _ => 0,
        }
    }

    /// Returns `true` if two axes determine the same quantity.
    pub(crate) fn clashes(self, other: Self) -> bool {
        let lengths = |field| matches!(field, Self::Middle | Self::Side | Self::Front | Self::Back);
        let drags = |field| {
            matches!(
                field,
                Self::LogAspect | Self::HalfThickness | Self::OverViscosity
            )
        };
        let sides = |field| matches!(field, Self::Front | Self::Back);
        let crossings = |field| matches!(field, Self::Clearance | Self::NoOverlap);
        self == other
            || (drags(self) && drags(other))
            || (crossings(self) && crossings(other))
            || (self == Self::Ratio && lengths(other))
            || (other == Self::Ratio && lengths(self))
            || (self == Self::Side && sides(other))
            || (other == Self::Side && sides(self))
    }

    /// Returns `true` for a parameter of the drag or of the sphere, which only a swimmer with common drag has.
    pub(crate) fn is_of_the_drag(self) -> bool {
        matches!(
            self,
            Self::Chi | Self::LogAspect | Self::HalfThickness | Self::OverViscosity | Self::Sphere
        )
    }

    /// Sets the parameter of a design to a value.
    pub(crate) fn set(self, design: &mut Design, value: f64) {
        let Design {
            swimmer, bounds, ..
        } = design;
        let links = &mut swimmer.links;
        match self {
            Self::Middle => links.middle = value,
            Self::Side => (links.front, links.back) = (value, value),
            Self::Front => links.front = value,
            Self::Back => links.back = value,
            Self::Ratio => *swimmer = Parameter::LinkRatio.swimmer(swimmer, value),
            Self::Chi => swimmer.chi = value,
            Self::LogAspect => swimmer.tangential_drag = TangentialDrag::LogAspect(value),
            Self::HalfThickness => swimmer.tangential_drag = TangentialDrag::HalfThickness(value),
            Self::OverViscosity => swimmer.tangential_drag = TangentialDrag::OverViscosity(value),
            Self::Sphere => swimmer.sphere_radius = value,
            Self::MaxAngle => bounds.max_angle = Some(value),
            Self::MinAngle => bounds.min_angle = Some(value),
            Self::Clearance => (bounds.clearance, bounds.no_overlap) = (value, true),
            Self::Sector => bounds.sector = value > 0.0,
            Self::NoOverlap => bounds.no_overlap = value > 0.0,
            Self::MaxRate => design.rates = Some([value; 2]),
            Self::Objective => design.aim = Aim::of_index(value).unwrap_or(design.aim),
        }
    }
}

impl fmt::Display for Field {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.name())
    }
}
