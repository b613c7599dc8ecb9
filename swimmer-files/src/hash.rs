//! The fingerprint of a swimmer: which body and drag a gait was made for.

use std::fmt;
use std::str::FromStr;

use sha2::{Digest, Sha256};
use swimmer_model::{Swimmer, TangentialDrag};

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

/// One line for each parameter, 17 digits, order fixed for ever: a change here is a new version word.
fn canonical_text(swimmer: &Swimmer<f64>) -> String {
    let (form, value) = match swimmer.tangential_drag {
        TangentialDrag::LogAspect(value) => ("log_aspect", value),
        TangentialDrag::HalfThickness(value) => ("half_thickness", value),
        TangentialDrag::OverViscosity(value) => ("over_viscosity", value),
    };
    // Adding zero makes -0.0 and 0.0 the same swimmer.
    let digits = |value: f64| format!("{:.16e}", value + 0.0);
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
        let hashes: std::collections::HashSet<_> = all.iter().map(SwimmerHash::of).collect();
        assert_eq!(hashes.len(), all.len());
    }

    #[test]
    fn a_bad_hash_is_refused() {
        assert!("12".parse::<SwimmerHash>().is_err());
        assert!("g".repeat(64).parse::<SwimmerHash>().is_err());
        assert!("é".repeat(32).parse::<SwimmerHash>().is_err());
    }
}
