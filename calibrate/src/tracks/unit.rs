//! Units of length in tracking files.

use std::fmt;

/// The unit of length in the file; positions in [`TrackPoint`](super::TrackPoint) are metres if its
/// length is known.
#[derive(Debug, Clone, Copy, PartialEq)]
pub enum Unit {
    /// Metres.
    Metre,
    /// Centimetres.
    Centimetre,
    /// Millimetres.
    Millimetre,
    /// Anything else, with the metres per unit that the user gave.
    Scaled(f64),
    /// Pixels of an image.
    Pixel,
    /// The file does not say.
    Unknown,
}

impl Unit {
    /// Metres per unit; `None` where only the user can know.
    pub fn metres(self) -> Option<f64> {
        Some(match self {
            Self::Metre => 1.0,
            Self::Centimetre => 0.01,
            Self::Millimetre => 0.001,
            Self::Scaled(metres) => metres,
            Self::Pixel | Self::Unknown => return None,
        })
    }

    /// The unit of a name such as `Meters`, `mm` or `cm`.
    pub(super) fn from_name(name: &str) -> Option<Self> {
        Some(match name.trim().to_ascii_lowercase().as_str() {
            "m" | "meter" | "meters" | "metre" | "metres" => Self::Metre,
            "cm" | "centimeter" | "centimeters" | "centimetre" | "centimetres" => Self::Centimetre,
            "mm" | "millimeter" | "millimeters" | "millimetre" | "millimetres" => Self::Millimetre,
            "px" | "pixel" | "pixels" => Self::Pixel,
            _ => return None,
        })
    }
}

impl fmt::Display for Unit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Metre => f.write_str("m"),
            Self::Centimetre => f.write_str("cm"),
            Self::Millimetre => f.write_str("mm"),
            Self::Scaled(metres) => write!(f, "{metres} m"),
            Self::Pixel => f.write_str("px"),
            Self::Unknown => f.write_str("unknown"),
        }
    }
}
