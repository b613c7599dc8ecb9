//! Parameters of a swimmer: three links, their medium and drag, and a sphere on one link.

use crate::{Link, Medium, Scalar, TangentialDrag, UncommonDrag};
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

impl<T: Scalar> Links<T> {
    /// Value of one link.
    pub fn of(&self, link: Link) -> T {
        match link {
            Link::Middle => self.middle,
            Link::Front => self.front,
            Link::Back => self.back,
        }
    }

    /// The same in another number type.
    pub fn cast<U: Scalar>(&self) -> Links<U> {
        let to = |v: T| U::from_f64(v.to_f64());
        Links {
            middle: to(self.middle),
            front: to(self.front),
            back: to(self.back),
        }
    }
}

/// A planar three-link swimmer (paper, Section II), or the same body in another [`Medium`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Swimmer<T> {
    /// Link lengths \[m\].
    pub links: Links<T>,
    /// χ = c_n/c_t, normal over tangential resistance coefficient; 2 for an infinitely slender rod. It and c_t have no effect
    /// outside a viscous fluid.
    pub chi: T,
    /// χ of the front and back link if they have their own; `chi` is then that of the middle link.
    pub side_chi: Option<[T; 2]>,
    /// Relation of c_t to the viscosity.
    pub tangential_drag: TangentialDrag<T>,
    /// Radius r_s \[m\] of the sphere; 0 without a sphere.
    pub sphere_radius: T,
    /// Link at whose centre the sphere sits; the middle one in the paper.
    pub sphere_on: Link,
    /// Surroundings of the links; a viscous fluid in the paper.
    pub medium: Medium<T>,
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
    /// Only a viscous fluid has a sphere's drag.
    SphereWithoutDrag {
        /// The radius \[m\].
        value: f64,
    },
    /// A parameter beyond the paper's, where none is defined.
    Uncommon(UncommonDrag),
    /// A shape at which A is infinite.
    Singular {
        /// (φ₁, φ₂) \[rad\].
        phi: [f64; 2],
    },
    /// Lighthill's efficiency compares with drag, which only a viscous fluid has.
    NoEfficiency,
    /// A link must be longer than wide.
    TooWide {
        /// Half width over half length.
        aspect: f64,
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
            Self::SphereWithoutDrag { value } => write!(
                f,
                "the swimmer has a sphere of radius {value} m, whose drag is defined in a viscous fluid only; leave the sphere out"
            ),
            Self::Uncommon(reason) => write!(
                f,
                "{reason}; the robot, its twin, fits and changes of the drag know one chi, one form of c_t and a sphere on the \
                 middle link"
            ),
            Self::Singular { phi: [one, two] } => write!(
                f,
                "the axles of the wheels meet in one point or are parallel at the shape ({one}, {two}) rad, which these bounds \
                 contain: A is infinite there, and no gait is optimal; `swimmer simulate` takes gaits that keep off such shapes"
            ),
            Self::NoEfficiency => write!(
                f,
                "Lighthill's efficiency compares the power with that of dragging the swimmer, and is defined in a viscous fluid \
                 only; displacement, speed and turning are defined in a perfect fluid as well"
            ),
            Self::TooWide { aspect } => write!(
                f,
                "the swimmer's aspect, half width over half length of its links, is {aspect}; give a number above 0 and at most 1"
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
            side_chi: None,
            tangential_drag: TangentialDrag::OverViscosity(one),
            sphere_radius: T::zero(),
            sphere_on: Link::Middle,
            medium: Medium::Viscous,
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
            tangential_drag: TangentialDrag::LogAspect(T::from_f64(ROBOT_LOG_ASPECT)),
            ..Self::purcell()
        }
    }

    /// Three equal ellipses in water, one tenth as wide as long, in a perfect fluid: the swimmer of Hatton and Choset (2013).
    pub fn perfect_fluid() -> Self {
        Self {
            medium: Medium::Perfect {
                aspect: T::from_f64(0.1),
                density: T::from_f64(1000.0),
            },
            ..Self::purcell()
        }
    }

    /// Three equal links with passive wheels at their centres: the kinematic snake of Shammas, Choset and Rizzi (2007).
    pub fn kinematic_snake() -> Self {
        Self {
            medium: Medium::Wheels,
            ..Self::purcell()
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

    /// c_t/μ of the side links, the reference drag of Lighthill's efficiency; the mean of both if they differ. NaN outside a
    /// viscous fluid, where this efficiency is not defined.
    pub fn side_drag(&self) -> T {
        if !self.is_viscous() {
            return T::from_f64(f64::NAN);
        }
        let [front, back] = [Link::Front, Link::Back].map(|link| self.tangential_drag_of(link));
        (front + back) / T::from_f64(2.0)
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
        if let Some([front, back]) = self.side_chi {
            positive("drag ratio chi of the front link", front)?;
            positive("drag ratio chi of the back link", back)?;
        }
        match self.tangential_drag {
            TangentialDrag::LogAspect(v) => positive("log aspect ln(l/a)", v)?,
            TangentialDrag::OverViscosity(v) => positive("c_t/mu", v)?,
            TangentialDrag::PerLink(values) => {
                positive("c_t/mu of the middle link", values.middle)?;
                positive("c_t/mu of the front link", values.front)?;
                positive("c_t/mu of the back link", values.back)?;
            }
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
        if !self.is_viscous() && self.sphere_radius > T::zero() {
            return Err(InvalidSwimmer::SphereWithoutDrag {
                value: self.sphere_radius.to_f64(),
            });
        }
        if let Medium::Perfect { aspect, density } = self.medium {
            positive("density [kg/m3]", density)?;
            if !(aspect > T::zero() && aspect <= T::one()) {
                return Err(InvalidSwimmer::TooWide {
                    aspect: aspect.to_f64(),
                });
            }
        }
        Ok(())
    }

    /// The same swimmer in another number type.
    pub fn cast<U: Scalar>(&self) -> Swimmer<U> {
        let to = |v: T| U::from_f64(v.to_f64());
        Swimmer {
            links: self.links.cast(),
            chi: to(self.chi),
            side_chi: self.side_chi.map(|both| both.map(to)),
            tangential_drag: self.tangential_drag.cast(),
            sphere_radius: to(self.sphere_radius),
            sphere_on: self.sphere_on,
            medium: self.medium.cast(),
        }
    }
}
