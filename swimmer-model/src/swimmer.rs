//! Parameters of a swimmer: three links, their drag, and a sphere on the middle link.

use crate::{Scalar, TangentialDrag};
use core::fmt;

/// Lengths of the three links \[m\] (or any unit: the model is linear in it).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Links<T> {
    /// l₀, the middle link, centred at (x, y) with heading θ.
    pub middle: T,
    /// l₁, attached to the front end of the middle link at angle φ₁.
    pub front: T,
    /// l₂, attached to the back end of the middle link at angle φ₂.
    pub back: T,
}

/// A planar three-link swimmer at low Reynolds number (paper, Section II).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swimmer<T> {
    /// Link lengths \[m\].
    pub links: Links<T>,
    /// χ = c_n/c_t, normal over tangential resistance coefficient; 2 for an infinitely slender rod.
    pub chi: T,
    /// Relation of c_t to the viscosity.
    pub tangential_drag: TangentialDrag<T>,
    /// Radius r_s \[m\] of the sphere at the middle link's centre; 0 without a sphere.
    pub sphere_radius: T,
}

/// Invalid parameter of a swimmer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum InvalidSwimmer {
    /// A quantity that must be finite and positive is not.
    NotPositive {
        /// Name of the quantity.
        name: &'static str,
        /// Its value.
        value: f64,
    },
    /// The sphere's radius must be finite and not negative.
    SphereRadius {
        /// The radius \[m\].
        value: f64,
    },
    /// A half thickness must be smaller than the shortest link.
    TooThick {
        /// The half thickness \[m\].
        half_thickness: f64,
        /// The shortest link \[m\].
        shortest: f64,
    },
}

impl fmt::Display for InvalidSwimmer {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Self::NotPositive { name, value } => write!(
                f,
                "the swimmer's {name} is {value}; give a finite number above 0"
            ),
            Self::SphereRadius { value } => {
                write!(
                    f,
                    "the swimmer's sphere radius is {value} m; give 0 (no sphere) or a finite number above 0"
                )
            }
            Self::TooThick {
                half_thickness,
                shortest,
            } => write!(
                f,
                "the swimmer's half thickness {half_thickness} m is not below its shortest link, {shortest} m, so ln(l/a) is \
                 not positive; give a smaller half thickness or another form of c_t"
            ),
        }
    }
}

impl core::error::Error for InvalidSwimmer {}

/// Common ln(l/a) that reproduces the paper's results for the robot.
const ROBOT_LOG_ASPECT: f64 = 4.543;

impl<T: Scalar> Swimmer<T> {
    /// Purcell's swimmer: three links of length 1, χ = 2, c_t/μ = 1, no sphere.
    pub fn purcell() -> Self {
        let one = T::one();
        Self {
            links: Links {
                middle: one,
                front: one,
                back: one,
            },
            chi: T::from_f64(2.0),
            tangential_drag: TangentialDrag::OverViscosity(one),
            sphere_radius: T::zero(),
        }
    }

    /// The paper's robot with its fitted r_s = 6.92 cm and χ = 3.598 (Section II.C), one c_t for all links.
    pub fn robot() -> Self {
        Self {
            chi: T::from_f64(3.598),
            sphere_radius: T::from_f64(0.0692),
            ..Self::robot_slender()
        }
    }

    /// The robot's links (7.1 cm, 13.7 cm) as slender rods: χ = 2 and no sphere. Initial guess of a fit.
    pub fn robot_slender() -> Self {
        let side = T::from_f64(0.137);
        Self {
            links: Links {
                middle: T::from_f64(0.071),
                front: side,
                back: side,
            },
            chi: T::from_f64(2.0),
            tangential_drag: TangentialDrag::LogAspect(T::from_f64(ROBOT_LOG_ASPECT)),
            sphere_radius: T::zero(),
        }
    }

    /// L = l₀ + l₁ + l₂ \[m\], the reference length of every non-dimensional result.
    pub fn total_length(&self) -> T {
        self.links.middle + self.links.front + self.links.back
    }

    /// Scales the swimmer to L = 1 with every dimensionless ratio unchanged.
    #[must_use]
    pub fn of_unit_length(&self) -> Self {
        let length = self.total_length();
        Self {
            links: Links {
                middle: self.links.middle / length,
                front: self.links.front / length,
                back: self.links.back / length,
            },
            tangential_drag: match self.tangential_drag {
                TangentialDrag::HalfThickness(thickness) => {
                    TangentialDrag::HalfThickness(thickness / length)
                }
                same => same,
            },
            sphere_radius: self.sphere_radius / length,
            ..*self
        }
    }

    /// c_t/μ of the side links, the reference drag of Lighthill's efficiency; the mean of both if they differ.
    pub fn side_drag(&self) -> T {
        let drag = |length| self.tangential_drag.over_viscosity(length);
        (drag(self.links.front) + drag(self.links.back)) / T::from_f64(2.0)
    }

    /// Checks that these parameters describe a swimmer.
    ///
    /// # Errors
    /// [`InvalidSwimmer`] names the first quantity that is out of range, with its value.
    pub fn validate(&self) -> Result<(), InvalidSwimmer> {
        let positive = |name, value: T| {
            if value.is_finite() && value > T::zero() {
                Ok(())
            } else {
                Err(InvalidSwimmer::NotPositive {
                    name,
                    value: value.to_f64(),
                })
            }
        };
        let Links {
            middle,
            front,
            back,
        } = self.links;
        positive("middle link length [m]", middle)?;
        positive("front link length [m]", front)?;
        positive("back link length [m]", back)?;
        positive("drag ratio chi", self.chi)?;
        match self.tangential_drag {
            TangentialDrag::LogAspect(v) => positive("log aspect ln(l/a)", v)?,
            TangentialDrag::OverViscosity(v) => positive("c_t/mu", v)?,
            TangentialDrag::HalfThickness(v) => {
                positive("half thickness [m]", v)?;
                let shortest = middle.min(front).min(back);
                if v >= shortest {
                    return Err(InvalidSwimmer::TooThick {
                        half_thickness: v.to_f64(),
                        shortest: shortest.to_f64(),
                    });
                }
            }
        }
        if !self.sphere_radius.is_finite() || self.sphere_radius < T::zero() {
            return Err(InvalidSwimmer::SphereRadius {
                value: self.sphere_radius.to_f64(),
            });
        }
        Ok(())
    }

    /// The same swimmer in another number type.
    pub fn cast<U: Scalar>(&self) -> Swimmer<U> {
        let to = |v: T| U::from_f64(v.to_f64());
        Swimmer {
            links: Links {
                middle: to(self.links.middle),
                front: to(self.links.front),
                back: to(self.links.back),
            },
            chi: to(self.chi),
            tangential_drag: self.tangential_drag.cast(),
            sphere_radius: to(self.sphere_radius),
        }
    }
}
