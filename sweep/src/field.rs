//! What an axis can change: the fields of the swimmer file that a gait depends on, the bounds, and the servos' rate.

use std::fmt;

use gait_optimizer::{Bounds, Parameter};
use serde::{Deserialize, Serialize};
use swimmer_files::Quantity;
use swimmer_model::{Swimmer, TangentialDrag};

use crate::Aim;

/// A number of a design that an axis changes.
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
    /// Whether gaits stay in the sector φ₁ ≥ |φ₂|: 0 or 1.
    #[serde(rename = "bounds.sector")]
    Sector,
    /// Whether the side links may not cross: 0 or 1.
    #[serde(rename = "bounds.no_overlap")]
    NoOverlap,
    /// Largest rate of both servos \[rad/s\].
    #[serde(rename = "max_rate")]
    MaxRate,
    /// What the gaits are best at: an index into [`Aim::ALL`].
    #[serde(rename = "objective")]
    Objective,
}

/// A design: all that its best gait depends on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Design {
    pub(crate) swimmer: Swimmer<f64>,
    pub(crate) bounds: Bounds,
    /// Largest |φ̇ᵢ| \[rad/s\], where it is told.
    pub(crate) rates: Option<[f64; 2]>,
    /// What its gait is best at.
    pub(crate) aim: Aim,
}

impl Field {
    /// All there are.
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

    /// Its name in a spec, a dotted path.
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

    /// The kind of quantity whose bare numbers are checked for a slip of their unit; `None` for all others.
    pub(crate) fn quantity(self) -> Option<Quantity> {
        match self {
            Self::Middle | Self::Side | Self::Front | Self::Back => Some(Quantity::Length),
            Self::MaxAngle | Self::MinAngle => Some(Quantity::Angle),
            Self::MaxRate => Some(Quantity::Rate),
            _ => None,
        }
    }

    /// Its unit; empty where it has none.
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

    /// Whether zero is a value of it.
    pub(crate) fn may_be_zero(self) -> bool {
        matches!(self, Self::Sphere | Self::Clearance | Self::Objective) || self.chooses()
    }

    /// Whether its values are false and true, kept as 0 and 1.
    pub(crate) fn chooses(self) -> bool {
        matches!(self, Self::Sector | Self::NoOverlap)
    }

    /// Whether what is maximised at its values can be compared.
    pub(crate) fn compares(self) -> bool {
        self != Self::Objective
    }

    /// Its value as words: that of an objective.
    pub fn parse(self, text: &str) -> Option<f64> {
        match self {
            Self::Objective => Aim::of_word(text).map(Aim::index),
            _ => text.parse().ok(),
        }
    }

    /// Whether it bounds a quarter, and so displacement gaits alone.
    pub(crate) fn of_quarters(self) -> bool {
        matches!(self, Self::MinAngle | Self::Sector)
    }

    /// +1 where a larger value lets in more gaits, −1 where it lets in fewer, 0 where it does neither.
    pub(crate) fn widens(self) -> i8 {
        match self {
            Self::MaxAngle | Self::MaxRate => 1,
            // The sector asks for a gait that leads the other way.
            Self::MinAngle | Self::Clearance | Self::NoOverlap => -1,
            _ => 0,
        }
    }

    /// What both say something of, where two axes do.
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

    /// Gives a design this value.
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
