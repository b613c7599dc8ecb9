//! Relation between the tangential drag coefficient c_t and the fluid's viscosity μ.
//!
//! Without a sphere only χ = c_n/c_t matters. With a sphere, c_t/μ determines the sphere's drag relative to that of the links,
//! and a fit of (r_s, χ) depends on the form chosen here.

use crate::{Link, Links, Scalar};

/// Tangential resistance coefficient over viscosity, c_t/μ (dimensionless), in one of four forms.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum TangentialDrag<T> {
    /// One value for all links from a common ln(l/a): c_t/μ = 2π / ln(l/a).
    LogAspect(T),
    /// One value per link from the half thickness a \[m\]: c_t/μ = 2π / ln(l_i/a).
    HalfThickness(T),
    /// c_t/μ, common to all links.
    OverViscosity(T),
    /// c_t/μ of each link.
    PerLink(Links<T>),
}

impl<T: Scalar> TangentialDrag<T> {
    /// c_t/μ of a link with the given length \[m\].
    pub fn over_viscosity(&self, link: Link, length: T) -> T {
        let two_pi = T::from_f64(core::f64::consts::TAU);
        match *self {
            Self::LogAspect(log_aspect) => two_pi / log_aspect,
            Self::HalfThickness(half) => two_pi / (length / half).ln(),
            Self::OverViscosity(value) => value,
            Self::PerLink(values) => values.of(link),
        }
    }

    /// The same form in another number type.
    pub fn cast<U: Scalar>(&self) -> TangentialDrag<U> {
        let to = |v: T| U::from_f64(v.to_f64());
        match *self {
            Self::LogAspect(v) => TangentialDrag::LogAspect(to(v)),
            Self::HalfThickness(v) => TangentialDrag::HalfThickness(to(v)),
            Self::OverViscosity(v) => TangentialDrag::OverViscosity(to(v)),
            Self::PerLink(values) => TangentialDrag::PerLink(values.cast()),
        }
    }
}
