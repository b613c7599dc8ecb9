//! Media: the three numbers that a link contributes to the balance of forces or momenta.
//!
//! The balance M(Φ) ξ + N(Φ) Φ̇ = 0 sums one diagonal tensor per link. Only these tensors depend on the medium:
//!
//! | medium | tangential, normal, rotational about the link's centre |
//! |---|---|
//! | [`Medium::Viscous`] | c_t l, c_n l, c_n l³/12, and the sphere on its link: 6π r_s, 6π r_s, 8π r_s³ |
//! | [`Medium::Perfect`] | mass and added mass of an ellipse with half axes a = l/2, b = aspect·a: m + ρπb², m + ρπa², m(a² + b²)/4 + ρπ(a² − b²)²/8, m = ρπab |
//! | [`Medium::Wheels`] | 0, 1, 0 |
//!
//! A is then the balance of forces, the conservation of momentum from rest, or the constraint of no side slip. W is the drag
//! power over μ, twice the kinetic energy per metre of depth, or zero.

use crate::{InvalidSwimmer, Links, Scalar, Swimmer, TangentialDrag};
use core::fmt;

/// One of the three links.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash)]
pub enum Link {
    /// Link 0, between the joints.
    #[default]
    Middle,
    /// Link 1, on the front joint.
    Front,
    /// Link 2, on the back joint.
    Back,
}

/// Surroundings of the links.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Medium<T> {
    /// Viscous fluid without inertia: resistive force theory with the swimmer's χ and c_t (the paper).
    #[default]
    Viscous,
    /// Perfect fluid, swum from rest. Links are neutrally buoyant ellipses, and the added mass of each is that of the link
    /// alone (Kanso, Marsden, Rowley, Melli-Huber, *Locomotion of articulated bodies in a perfect fluid*, 2005; the
    /// decoupled form of Hatton and Choset, 2013).
    Perfect {
        /// Half width over half length.
        aspect: T,
        /// ρ of fluid and body \[kg/m³\], per metre of depth.
        density: T,
    },
    /// Passive wheels at the links' centres, which roll freely and do not slip sideways: the kinematic snake (Shammas, Choset,
    /// Rizzi, *Geometric motion planning analysis for two classes of underactuated mechanical systems*, 2007).
    Wheels,
}

impl<T: Scalar> Medium<T> {
    /// The same medium in another number type.
    pub fn cast<U: Scalar>(&self) -> Medium<U> {
        match *self {
            Self::Viscous => Medium::Viscous,
            Self::Perfect { aspect, density } => Medium::Perfect {
                aspect: U::from_f64(aspect.to_f64()),
                density: U::from_f64(density.to_f64()),
            },
            Self::Wheels => Medium::Wheels,
        }
    }
}

/// Diagonal tensor of one link in its own frame, about its centre.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LinkTensor<T> {
    /// Along the link.
    pub tangential: T,
    /// Across the link.
    pub normal: T,
    /// Against rotation about the link's centre.
    pub rotational: T,
}

/// Parameter beyond those of the paper ([`Swimmer::common_drag`]).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum UncommonDrag {
    /// The medium is not a viscous fluid.
    Medium,
    /// The links have their own χ.
    Chi,
    /// The links have their own c_t.
    TangentialDrag,
    /// The sphere sits on a side link.
    Sphere,
}

impl fmt::Display for UncommonDrag {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Medium => "the swimmer's medium is not a viscous fluid ([medium] kind)",
            Self::Chi => "the swimmer's links have drag ratios of their own ([drag] chi)",
            Self::TangentialDrag => {
                "the swimmer's links have drag coefficients of their own ([drag] c_t)"
            }
            Self::Sphere => "the swimmer's sphere is not on the middle link ([sphere] on)",
        })
    }
}

impl core::error::Error for UncommonDrag {}

/// A sphere's rotational drag over the viscosity, 8π r³.
pub(crate) fn sphere_turning<T: Scalar>(radius: T) -> T {
    T::from_f64(8.0 * core::f64::consts::PI) * radius * radius * radius
}

impl<T: Scalar> Swimmer<T> {
    /// χ of a link.
    pub fn chi_of(&self, link: Link) -> T {
        match (link, self.side_chi) {
            (Link::Front, Some([front, _])) => front,
            (Link::Back, Some([_, back])) => back,
            _ => self.chi,
        }
    }

    /// c_t/μ of a link.
    pub fn tangential_drag_of(&self, link: Link) -> T {
        self.tangential_drag
            .over_viscosity(link, self.links.of(link))
    }

    /// Radius \[m\] of the sphere on a link; 0 without one.
    pub fn sphere_radius_on(&self, link: Link) -> T {
        if self.sphere_on == link {
            self.sphere_radius
        } else {
            T::zero()
        }
    }

    /// Tensor of a link in the swimmer's medium.
    ///
    /// ```
    /// use swimmer_model::{Link, Medium, Swimmer};
    ///
    /// let purcell = Swimmer::<f64>::purcell().tensor(Link::Front);
    /// assert_eq!((purcell.tangential, purcell.normal), (1.0, 2.0));
    /// let snake = Swimmer { medium: Medium::Wheels, ..Swimmer::<f64>::purcell() }.tensor(Link::Front);
    /// assert_eq!((snake.tangential, snake.normal, snake.rotational), (0.0, 1.0, 0.0));
    /// ```
    pub fn tensor(&self, link: Link) -> LinkTensor<T> {
        let length = self.links.of(link);
        match self.medium {
            Medium::Viscous => {
                let radius = self.sphere_radius_on(link);
                let tangential = self.tangential_drag_of(link) * length;
                let normal = self.chi_of(link) * tangential;
                let sphere = T::from_f64(6.0 * core::f64::consts::PI) * radius;
                LinkTensor {
                    tangential: tangential + sphere,
                    normal: normal + sphere,
                    rotational: normal * length * length / T::from_f64(12.0)
                        + sphere_turning(radius),
                }
            }
            Medium::Perfect { aspect, density } => {
                let area_density = density * T::from_f64(core::f64::consts::PI);
                let a = length * T::from_f64(0.5);
                let b = aspect * a;
                let (a2, b2) = (a * a, b * b);
                let mass = area_density * a * b;
                let square = (a2 - b2) * (a2 - b2);
                LinkTensor {
                    tangential: mass + area_density * b2,
                    normal: mass + area_density * a2,
                    rotational: mass * (a2 + b2) * T::from_f64(0.25)
                        + area_density * square * T::from_f64(0.125),
                }
            }
            Medium::Wheels => LinkTensor {
                tangential: T::zero(),
                normal: T::one(),
                rotational: T::zero(),
            },
        }
    }

    /// Returns `true` in a viscous fluid, where drag power and Lighthill's efficiency are defined.
    pub fn is_viscous(&self) -> bool {
        self.medium == Medium::Viscous
    }

    /// Checks that the parameters of the paper describe the swimmer, whatever its lengths: a viscous fluid, one χ, one form of c_t,
    /// the sphere on the middle link. The robot's settings, fits and sweeps over the drag have no other parameters.
    ///
    /// # Errors
    /// [`UncommonDrag`] names the first parameter beyond the paper's.
    pub fn common_drag(&self) -> Result<(), UncommonDrag> {
        if !self.is_viscous() {
            Err(UncommonDrag::Medium)
        } else if self.side_chi.is_some() {
            Err(UncommonDrag::Chi)
        } else if matches!(self.tangential_drag, TangentialDrag::PerLink(_)) {
            Err(UncommonDrag::TangentialDrag)
        } else if self.sphere_on != Link::Middle && self.sphere_radius > T::zero() {
            Err(UncommonDrag::Sphere)
        } else {
            Ok(())
        }
    }

    /// Checks that Lighthill's efficiency is defined.
    ///
    /// # Errors
    /// [`InvalidSwimmer::NoEfficiency`] outside a viscous fluid.
    pub fn check_efficiency(&self) -> Result<(), InvalidSwimmer> {
        if self.is_viscous() {
            Ok(())
        } else {
            Err(InvalidSwimmer::NoEfficiency)
        }
    }

    /// The swimmer with its front and back links exchanged: the same body, named from its other end.
    #[must_use]
    pub fn exchanged(&self) -> Self {
        let turned = |links: Links<T>| Links {
            middle: links.middle,
            front: links.back,
            back: links.front,
        };
        Self {
            links: turned(self.links),
            side_chi: self.side_chi.map(|[front, back]| [back, front]),
            tangential_drag: match self.tangential_drag {
                TangentialDrag::PerLink(values) => TangentialDrag::PerLink(turned(values)),
                common => common,
            },
            sphere_on: match self.sphere_on {
                Link::Middle => Link::Middle,
                Link::Front => Link::Back,
                Link::Back => Link::Front,
            },
            ..*self
        }
    }

    /// Returns `true` if the front and back links are alike to rounding, so that the swimmer has the paper's two symmetries.
    pub fn is_symmetric(&self) -> bool {
        let alike = |front: T, back: T| (front - back).abs() <= T::from_f64(1e-12) * front.abs();
        let [front, back] = [Link::Front, Link::Back].map(|link| self.tensor(link));
        alike(self.links.front, self.links.back)
            && alike(front.tangential, back.tangential)
            && alike(front.normal, back.normal)
            && alike(front.rotational, back.rotational)
    }
}
