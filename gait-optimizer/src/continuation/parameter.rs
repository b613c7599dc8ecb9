//! Parameter of a continuation.

use std::fmt;

use swimmer_files::Bounds;
use swimmer_model::{Links, Swimmer};

/// Parameter of a continuation.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub enum Parameter {
    /// Bound on the joint angles \[rad\].
    MaxAngle,
    /// χ, the ratio of the resistance coefficients.
    Chi,
    /// Radius of the sphere \[m\].
    SphereRadius,
    /// l₁/l₀ at a constant total length; l₂/l₁ stays as it is.
    LinkRatio,
}

impl Parameter {
    /// Name on the command line and in JSON.
    pub fn word(self) -> &'static str {
        match self {
            Self::MaxAngle => "max-angle",
            Self::Chi => "chi",
            Self::SphereRadius => "sphere",
            Self::LinkRatio => "link-ratio",
        }
    }

    /// Returns the swimmer with this value of the parameter.
    #[must_use]
    pub fn swimmer(self, swimmer: &Swimmer<f64>, value: f64) -> Swimmer<f64> {
        match self {
            Self::MaxAngle => *swimmer,
            Self::Chi => Swimmer {
                chi: value,
                ..*swimmer
            },
            Self::SphereRadius => Swimmer {
                sphere_radius: value,
                ..*swimmer
            },
            Self::LinkRatio => {
                let back = swimmer.links.back / swimmer.links.front * value;
                let middle = swimmer.total_length() / (1.0 + value + back);
                Swimmer {
                    links: Links {
                        middle,
                        front: middle * value,
                        back: middle * back,
                    },
                    ..*swimmer
                }
            }
        }
    }

    /// Returns the bounds with this value of the parameter.
    #[must_use]
    pub fn bounds(self, bounds: &Bounds, value: f64) -> Bounds {
        match self {
            Self::MaxAngle => Bounds {
                max_angle: Some(value),
                ..*bounds
            },
            _ => *bounds,
        }
    }
}

impl fmt::Display for Parameter {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.word())
    }
}
