//! GAIT on the command line and in campaigns: `circle:70deg`, `square:1.2`, a gait file, each with `:cw` to reverse it.

use std::fmt;
use std::path::{Path, PathBuf};
use std::str::FromStr;

use crate::{AnyGait, FileError, GaitFile, parse_angle};

/// A gait as named by a person.
#[derive(Debug, Clone, PartialEq)]
pub enum GaitSpec {
    /// `circle:AMPLITUDE`: radius \[rad\], uniform angle from φ₁ = φ₂ > 0, counter-clockwise unless reversed.
    Circle {
        /// Radius in the (φ₁, φ₂) plane \[rad\].
        amplitude: f64,
        /// `:cw` was added.
        clockwise: bool,
    },
    /// `square:AMPLITUDE`: corners (±A, ±A), constant speed along the edges, counter-clockwise unless reversed.
    Square {
        /// Half of the edge \[rad\].
        amplitude: f64,
        /// `:cw` was added.
        clockwise: bool,
    },
    /// A gait file, run backwards when reversed.
    File {
        /// Path of the file.
        path: PathBuf,
        /// `:cw` was added.
        reversed: bool,
    },
}

/// Error of parsing the name of a gait.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum GaitSpecError {
    /// The amplitude is no angle.
    #[error("`{text}`: {source}")]
    Amplitude {
        /// The text as typed.
        text: String,
        /// Error in it.
        source: crate::AngleError,
    },
    /// The amplitude is an angle, but no size.
    #[error("`{text}`: the amplitude is {amplitude} rad; it must be above 0 and at most {largest}")]
    Size {
        /// The text as typed.
        text: String,
        /// The amplitude \[rad\].
        amplitude: f64,
        /// The largest that is accepted \[rad\].
        largest: f64,
    },
    /// Nearly the name of a shape.
    #[error("there is no gait `{text}`: did you mean {meant}? (a file of that name is ./{text})")]
    Misspelt {
        /// The text as typed.
        text: String,
        /// The likely intention.
        meant: String,
    },
    /// Nothing was typed.
    #[error(
        "a gait is circle:AMPLITUDE, square:AMPLITUDE or the path of a gait file (add :cw to reverse it)"
    )]
    Empty,
}

/// Two turns: far beyond what any joint does, and it keeps a slip of the keyboard from running for minutes.
const LARGEST_AMPLITUDE: f64 = 4.0 * std::f64::consts::PI;

impl FromStr for GaitSpec {
    type Err = GaitSpecError;

    fn from_str(text: &str) -> Result<Self, Self::Err> {
        let (shape, reversed) = text
            .strip_suffix(":cw")
            .map_or((text, false), |shape| (shape, true));
        if let Some(amplitude) = shape.strip_prefix("circle:") {
            Ok(Self::Circle {
                amplitude: size(text, amplitude)?,
                clockwise: reversed,
            })
        } else if let Some(amplitude) = shape.strip_prefix("square:") {
            Ok(Self::Square {
                amplitude: size(text, amplitude)?,
                clockwise: reversed,
            })
        } else if shape.trim().is_empty() {
            Err(GaitSpecError::Empty)
        } else if let Some(meant) = meant(shape) {
            Err(GaitSpecError::Misspelt {
                text: text.to_owned(),
                meant,
            })
        } else {
            Ok(Self::File {
                path: PathBuf::from(shape),
                reversed,
            })
        }
    }
}

/// The shape that was probably meant, if a word is similar to its name; paths have more in them than a word and an angle.
fn meant(shape: &str) -> Option<String> {
    let (word, amplitude) = shape.split_once(':').unwrap_or((shape, "70deg"));
    if !word.chars().all(char::is_alphabetic) || parse_angle(amplitude).is_err() {
        return None;
    }
    let word = word.to_lowercase();
    let near = ["circle", "square"].map(|name| (strsim::jaro_winkler(name, &word), name));
    let (likeness, name) = near.into_iter().max_by(|(a, _), (b, _)| a.total_cmp(b))?;
    (likeness > 0.8).then(|| format!("{name}:{amplitude}"))
}

fn size(text: &str, amplitude: &str) -> Result<f64, GaitSpecError> {
    let amplitude = parse_angle(amplitude).map_err(|source| GaitSpecError::Amplitude {
        text: text.to_owned(),
        source,
    })?;
    if amplitude > 0.0 && amplitude <= LARGEST_AMPLITUDE {
        Ok(amplitude)
    } else {
        Err(GaitSpecError::Size {
            text: text.to_owned(),
            amplitude,
            largest: LARGEST_AMPLITUDE,
        })
    }
}

impl GaitSpec {
    /// `true` if `:cw` was added.
    pub fn is_reversed(&self) -> bool {
        match self {
            Self::Circle { clockwise, .. } | Self::Square { clockwise, .. } => *clockwise,
            Self::File { reversed, .. } => *reversed,
        }
    }
}

impl fmt::Display for GaitSpec {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let reversed = match self {
            Self::Circle {
                amplitude,
                clockwise,
            } => {
                write!(f, "circle:{amplitude:?}")?;
                clockwise
            }
            Self::Square {
                amplitude,
                clockwise,
            } => {
                write!(f, "square:{amplitude:?}")?;
                clockwise
            }
            Self::File { path, reversed } => {
                write!(f, "{}", path.display())?;
                reversed
            }
        };
        f.write_str(if *reversed { ":cw" } else { "" })
    }
}

impl GaitSpec {
    /// The same gait with a relative path taken from `folder`.
    #[must_use]
    pub fn from_folder(self, folder: &Path) -> Self {
        match self {
            Self::File { path, reversed } => Self::File {
                path: folder.join(path),
                reversed,
            },
            closed_form => closed_form,
        }
    }

    /// Name for people: a round number of degrees is written as such.
    ///
    /// ```
    /// use swimmer_files::GaitSpec;
    ///
    /// let gait = GaitSpec::Circle { amplitude: 70_f64.to_radians(), clockwise: true };
    /// assert_eq!(gait.readable(), "circle:70deg:cw");
    /// ```
    pub fn readable(&self) -> String {
        let (word, amplitude, clockwise) = match self {
            Self::Circle {
                amplitude,
                clockwise,
            } => ("circle", *amplitude, *clockwise),
            Self::Square {
                amplitude,
                clockwise,
            } => ("square", *amplitude, *clockwise),
            Self::File { .. } => return self.to_string(),
        };
        let tenths = (amplitude.to_degrees() * 10.0).round();
        if ((tenths / 10.0).to_radians() - amplitude).abs() > 1e-12 {
            return self.to_string();
        }
        format!(
            "{word}:{}deg{}",
            tenths / 10.0,
            if clockwise { ":cw" } else { "" }
        )
    }

    /// The gait, ready to swim; reads the file where it is one.
    ///
    /// # Errors
    /// [`FileError`] when the gait file cannot be read or is wrong.
    pub fn load(&self) -> Result<AnyGait, FileError> {
        self.load_by(GaitFile::load)
    }

    /// The same; where it is a file, `read` reads it.
    ///
    /// # Errors
    /// As [`load`](Self::load).
    ///
    /// ```
    /// use swimmer_files::{AnyGait, FileError, GaitFile, GaitSpec};
    /// use swimmer_model::Gait;
    ///
    /// let spec: GaitSpec = "best.gait".parse().unwrap();
    /// let gait = spec.load_by(|_| Ok::<_, FileError>(GaitFile::sampled(&AnyGait::circle(1.0), 90)))?;
    /// assert!((gait.at(0.5).phi + gait.at(0.0).phi).norm() < 1e-6);
    /// # Ok::<(), FileError>(())
    /// ```
    pub fn load_by<E: From<FileError>>(
        &self,
        read: impl FnOnce(&Path) -> Result<GaitFile, E>,
    ) -> Result<AnyGait, E> {
        Ok(match self {
            Self::Circle {
                amplitude,
                clockwise,
            } => AnyGait::circle(*amplitude).reversed_if(*clockwise),
            Self::Square {
                amplitude,
                clockwise,
            } => AnyGait::square(*amplitude).reversed_if(*clockwise),
            Self::File { path, reversed } => {
                let file = read(path)?;
                if *reversed && file.passive.is_some() {
                    let problem = "the joint that this gait names as passive follows a spring: run backwards, the gait is not its \
                         response; leave out :cw";
                    return Err(FileError::at(path, 1, 1, problem).into());
                }
                AnyGait::from_file(&file)
                    .map_err(|invalid| FileError::at(path, 1, 1, invalid.to_string()))?
                    .reversed_if(*reversed)
            }
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_people_type() {
        let circle: GaitSpec = "circle:70deg:cw".parse().unwrap();
        assert_eq!(
            circle,
            GaitSpec::Circle {
                amplitude: 70f64.to_radians(),
                clockwise: true
            }
        );
        assert_eq!(
            "square:1.2".parse(),
            Ok(GaitSpec::Square {
                amplitude: 1.2,
                clockwise: false
            })
        );
        let file = GaitSpec::File {
            path: PathBuf::from("C:/gaits/b.gait"),
            reversed: true,
        };
        assert_eq!("C:/gaits/b.gait:cw".parse(), Ok(file));
    }

    #[test]
    fn it_prints_what_it_reads() {
        for text in [
            "circle:70deg",
            "square:0.1:cw",
            "some/file.gait",
            "file.gait:cw",
        ] {
            let spec: GaitSpec = text.parse().unwrap();
            assert_eq!(spec.to_string().parse(), Ok(spec));
        }
    }

    #[test]
    fn a_slip_of_the_keyboard_is_told() {
        for (text, meant) in [
            ("circel:70deg", "circle:70deg"),
            ("sqare:1.2:cw", "square:1.2"),
            ("Circle:1", "circle:1"),
            ("circle", "circle:70deg"),
        ] {
            let refused = text.parse::<GaitSpec>().unwrap_err().to_string();
            assert!(
                refused.contains(&format!("did you mean {meant}?")),
                "{refused}"
            );
        }
        for file in ["./circle", "circles.gait", "C:/circle", "best", "c:1"] {
            assert!(matches!(file.parse(), Ok(GaitSpec::File { .. })), "{file}");
        }
    }

    #[test]
    fn what_it_refuses() {
        for text in [
            "",
            ":cw",
            "circle:",
            "circle:0",
            "circle:-1",
            "square:nan",
            "square:900",
            "circle:1.2:ccw",
        ] {
            assert!(text.parse::<GaitSpec>().is_err(), "{text}");
        }
    }
}
