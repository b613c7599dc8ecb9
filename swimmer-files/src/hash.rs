//! The fingerprint of a swimmer: which body and drag a gait was made for.

use std::fmt;
use std::str::FromStr;

use sha2::{Digest, Sha256};
use swimmer_model::{Link, Medium, Swimmer, TangentialDrag};

/// SHA-256 over the canonical text of a swimmer's physics (links, χ, form and value of `c_t`, sphere); its name, fluid and
/// servos do not change which gait is best, so they stay out.
///
/// Written and read as 64 hexadecimal digits.
///
/// ```
/// use swimmer_files::{SwimmerFile, SwimmerHash};
///
/// let robot = SwimmerFile::preset("robot").unwrap();
/// let mut renamed = robot.clone();
/// renamed.name = "mine".to_owned();
/// assert_eq!(SwimmerHash::of(&renamed.swimmer), robot.hash());
/// assert_ne!(renamed.fitted(0.07, 3.5).hash(), robot.hash());
/// ```
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct SwimmerHash([u8; 32]);

impl SwimmerHash {
    /// The fingerprint of a swimmer. Equal parameters give equal hashes on every platform.
    pub fn of(swimmer: &Swimmer<f64>) -> Self {
        Self(Sha256::digest(canonical_text(swimmer).as_bytes()).into())
    }

    /// The 32 bytes.
    pub fn as_bytes(&self) -> &[u8; 32] {
        &self.0
    }
}

/// 17 digits. Adding zero makes -0.0 and 0.0 the same swimmer.
fn digits(value: f64) -> String {
    format!("{:.16e}", value + 0.0)
}

/// One line for each parameter, 17 digits, order fixed for ever: a change here is a new version word.
fn canonical_text(swimmer: &Swimmer<f64>) -> String {
    let (form, value) = match swimmer.tangential_drag {
        _ if swimmer.common_drag().is_err() => return canonical_text_2(swimmer),
        TangentialDrag::LogAspect(value) => ("log_aspect", value),
        TangentialDrag::HalfThickness(value) => ("half_thickness", value),
        TangentialDrag::OverViscosity(value) => ("over_viscosity", value),
        TangentialDrag::PerLink(_) => return canonical_text_2(swimmer),
    };
    format!(
        "swimmer 1\nmiddle {}\nfront {}\nback {}\nchi {}\nc_t {form} {}\nsphere {}\n",
        digits(swimmer.links.middle),
        digits(swimmer.links.front),
        digits(swimmer.links.back),
        digits(swimmer.chi),
        digits(value),
        digits(swimmer.sphere_radius),
    )
}

/// The same for a swimmer beyond the paper's parameters: the medium, and what matters in it.
fn canonical_text_2(swimmer: &Swimmer<f64>) -> String {
    let links = &swimmer.links;
    let [middle, front, back] = [links.middle, links.front, links.back].map(digits);
    let body = format!("swimmer 2\nmiddle {middle}\nfront {front}\nback {back}\n");
    match swimmer.medium {
        Medium::Perfect { aspect, density } => {
            format!("{body}perfect {} {}\n", digits(aspect), digits(density))
        }
        Medium::Wheels => format!("{body}wheels\n"),
        Medium::Viscous => {
            let links = [Link::Middle, Link::Front, Link::Back];
            let chi = links.map(|link| digits(swimmer.chi_of(link))).join(" ");
            let c_t = match swimmer.tangential_drag {
                TangentialDrag::LogAspect(value) => format!("log_aspect {}", digits(value)),
                TangentialDrag::HalfThickness(value) => {
                    format!("half_thickness {}", digits(value))
                }
                TangentialDrag::OverViscosity(value) => {
                    format!("over_viscosity {}", digits(value))
                }
                TangentialDrag::PerLink(values) => {
                    let values = links.map(|link| digits(values.of(link)));
                    format!("over_viscosity {}", values.join(" "))
                }
            };
            let sphere = links.map(|link| digits(swimmer.sphere_radius_on(link)));
            format!("{body}chi {chi}\nc_t {c_t}\nsphere {}\n", sphere.join(" "))
        }
    }
}

impl fmt::Display for SwimmerHash {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

impl FromStr for SwimmerHash {
    type Err = &'static str;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        const PROBLEM: &str = "a swimmer hash is 64 hexadecimal digits";
        if text.len() != 64 || !text.bytes().all(|byte| byte.is_ascii_hexdigit()) {
            return Err(PROBLEM);
        }
        let mut bytes = [0; 32];
        for (byte, pair) in bytes.iter_mut().zip(text.as_bytes().chunks(2)) {
            let pair = std::str::from_utf8(pair).map_err(|_| PROBLEM)?;
            *byte = u8::from_str_radix(pair, 16).map_err(|_| PROBLEM)?;
        }
        Ok(Self(bytes))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Links;

    /// Gait files in the world carry these digits: if this fails, do not change the test.
    #[test]
    fn the_presets_keep_their_hash() {
        let hash = SwimmerHash::of(&Swimmer::purcell());
        assert_eq!(
            hash.to_string(),
            "cead6ed6eeb4e7fc1b778534ff7c8118bb9e3c280fce72feec471b3a7def5b0a"
        );
        assert_eq!(hash.to_string().parse(), Ok(hash));
    }

    #[test]
    fn every_parameter_counts() {
        let robot = Swimmer::<f64>::robot();
        let mut all = vec![robot];
        for change in 0..6 {
            let mut other = robot;
            match change {
                0 => other.links.middle *= 1.0 + f64::EPSILON,
                1 => other.links.front *= 1.0 + f64::EPSILON,
                2 => other.links.back *= 1.0 + f64::EPSILON,
                3 => other.chi *= 1.0 + f64::EPSILON,
                4 => other.tangential_drag = TangentialDrag::OverViscosity(4.543),
                _ => other.sphere_radius = 0.0,
            }
            all.push(other);
        }
        let links = robot.links;
        let own = TangentialDrag::PerLink;
        all.extend([
            Swimmer {
                side_chi: Some([robot.chi, 2.0]),
                ..robot
            },
            Swimmer {
                side_chi: Some([2.0, robot.chi]),
                ..robot
            },
            Swimmer {
                sphere_on: Link::Front,
                ..robot
            },
            Swimmer {
                sphere_on: Link::Back,
                ..robot
            },
            Swimmer {
                tangential_drag: own(links),
                ..robot
            },
            Swimmer {
                tangential_drag: own(Links { back: 1.0, ..links }),
                ..robot
            },
            Swimmer::kinematic_snake(),
            Swimmer::perfect_fluid(),
            Swimmer {
                medium: Medium::Perfect {
                    aspect: 0.2,
                    density: 1000.0,
                },
                ..Swimmer::perfect_fluid()
            },
            Swimmer {
                medium: Medium::Perfect {
                    aspect: 0.1,
                    density: 998.0,
                },
                ..Swimmer::perfect_fluid()
            },
            Swimmer {
                links,
                ..Swimmer::perfect_fluid()
            },
        ]);
        let hashes: std::collections::HashSet<_> = all.iter().map(SwimmerHash::of).collect();
        assert_eq!(hashes.len(), all.len());
        // Drag has no effect outside a viscous fluid, and no sphere sits nowhere.
        let snake = Swimmer {
            chi: 3.0,
            ..Swimmer::kinematic_snake()
        };
        assert_eq!(
            SwimmerHash::of(&snake),
            SwimmerHash::of(&Swimmer::kinematic_snake())
        );
        let bare = Swimmer {
            sphere_radius: 0.0,
            ..robot
        };
        let nowhere = Swimmer {
            sphere_on: Link::Back,
            ..bare
        };
        assert_eq!(SwimmerHash::of(&bare), SwimmerHash::of(&nowhere));
    }

    #[test]
    fn a_bad_hash_is_refused() {
        assert!("12".parse::<SwimmerHash>().is_err());
        assert!("g".repeat(64).parse::<SwimmerHash>().is_err());
        assert!("é".repeat(32).parse::<SwimmerHash>().is_err());
    }
}
