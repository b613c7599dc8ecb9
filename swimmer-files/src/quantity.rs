//! Angles, rates, lengths and pulses as people write them, in flags, files and Python: one parser, and one rule for numbers without a
//! unit that can only be a slip of it.
//!
//! A bare angle is radians, a bare rate radians a second, a length metres, a pulse microseconds. Beyond the range that a robot of this
//! kind can have, degrees, millimetres or milliseconds were meant, and the number is refused with that suggestion.

use std::f64::consts::TAU;
use std::fmt;

/// A kind of quantity, with the unit of its bare numbers.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// Radians.
    Angle,
    /// Radians a second.
    Rate,
    /// Metres.
    Length,
    /// Microseconds of a servo's pulse.
    Pulse,
}

/// Largest bare rate \[rad/s\].
const LARGEST_RATE: f64 = 20.0;
/// Longest bare length \[m\].
const LONGEST: f64 = 10.0;
/// Shortest and longest pulse at which a servo's joint may be straight \[µs\].
const PULSES: [f64; 2] = [600.0, 2400.0];

/// A number without a unit that is hardly meant in the unit in which it is read.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub struct Slip {
    quantity: Quantity,
    value: f64,
}

/// A unit that was meant, and the number in the unit that is read.
struct Meant {
    unit: &'static str,
    value: f64,
}

impl Quantity {
    /// Returns a bare number if it is plausible, or negative or no number, which is for the caller to judge.
    ///
    /// # Errors
    /// [`Slip`] for angles beyond a turn, rates beyond 20 rad/s, lengths beyond 10 m, pulses outside 600 to 2400 µs.
    ///
    /// ```
    /// use swimmer_files::Quantity;
    ///
    /// assert_eq!(Quantity::Rate.checked(3.5), Ok(3.5));
    /// let slip = Quantity::Length.checked(50.0).unwrap_err();
    /// assert_eq!(slip.to_string(), "50 is in metres: did you mean 50 mm? Write 0.05");
    /// ```
    pub fn checked(self, value: f64) -> Result<f64, Slip> {
        let size = value.abs();
        let is_slip = match self {
            Self::Angle => size > TAU,
            Self::Rate => size > LARGEST_RATE,
            Self::Length => size > LONGEST,
            Self::Pulse => !(PULSES[0]..=PULSES[1]).contains(&value),
        };
        if is_slip && value.is_finite() {
            Err(Slip {
                quantity: self,
                value,
            })
        } else {
            Ok(value)
        }
    }

    fn unit(self) -> &'static str {
        match self {
            Self::Angle => "radians",
            Self::Rate => "radians a second",
            Self::Length => "metres",
            Self::Pulse => "µs",
        }
    }
}

impl Slip {
    /// The unit that was meant; `None` if the number is plausible in none.
    fn meant(&self) -> Option<Meant> {
        let value = self.value;
        let candidates: &[(&'static str, f64)] = match self.quantity {
            Quantity::Angle => &[("°", 1.0_f64.to_radians())],
            Quantity::Rate => &[("° a second", 1.0_f64.to_radians())],
            Quantity::Length => &[(" mm", 1e-3)],
            Quantity::Pulse => &[(" ms", 1e3), (" ns", 1e-3)],
        };
        let meant = candidates.iter().map(|(unit, scale)| Meant {
            unit,
            // Six decimals, as the file is written.
            value: (value * scale * 1e6).round() / 1e6,
        });
        let mut meant = meant.filter(|meant| self.quantity.checked(meant.value).is_ok());
        meant.next()
    }

    /// The refusal of a key of a file with this value.
    ///
    /// ```
    /// use swimmer_files::Quantity;
    ///
    /// let slip = Quantity::Angle.checked(160.0).unwrap_err();
    /// let refusal = "max_angle = 160 is in radians: did you mean 160°? Write max_angle = 2.792527";
    /// assert_eq!(slip.of_key("max_angle"), refusal);
    /// ```
    pub fn of_key(&self, key: &str) -> String {
        format!("{key} = {}", self.advice(&format!("{key} = ")))
    }

    fn advice(&self, key: &str) -> String {
        let Self { quantity, value } = self;
        let unit = quantity.unit();
        match (self.meant(), quantity) {
            (Some(meant), _) => format!(
                "{value} is in {unit}: did you mean {value}{}? Write {key}{}",
                meant.unit, meant.value
            ),
            (None, Quantity::Pulse) => format!(
                "{value} is in {unit}: a servo's joint is straight between {} and {} µs",
                PULSES[0], PULSES[1]
            ),
            (None, _) => format!("{value} is in {unit}, which is more than a robot has"),
        }
    }
}

impl fmt::Display for Slip {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(&self.advice(""))
    }
}

/// Error of parsing an angle or a rate.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AngleError {
    /// It cannot be read.
    #[error(
        "`{text}` is not an angle: write degrees as 70deg, radians as 1.2rad or as a bare number 1.2"
    )]
    Unreadable {
        /// The text.
        text: String,
    },
    /// An angle without a unit, beyond a full turn: hardly radians.
    #[error(
        "`{text}` without a unit is radians, {:.1} turns: did you mean {text}deg? Write {text}rad if not",
        radians.abs() / TAU
    )]
    Degrees {
        /// The text.
        text: String,
        /// Its value \[rad\].
        radians: f64,
    },
    /// A rate without a unit that no servo has: hardly radians a second.
    #[error(
        "`{text}` without a unit is radians a second, {:.1} turns a second: did you mean {text}deg? Write {text}rad if not",
        radians.abs() / TAU
    )]
    DegreesPerSecond {
        /// The text.
        text: String,
        /// Its value \[rad/s\].
        radians: f64,
    },
}

/// Reads `70deg`, `70°`, `1.2rad` or `1.2` (radians) and returns radians.
///
/// # Errors
/// [`AngleError`] for anything else, `nan` and infinities included, and for a bare number beyond 2π.
///
/// ```
/// use swimmer_files::parse_angle;
///
/// assert_eq!(parse_angle("180deg"), Ok(std::f64::consts::PI));
/// assert_eq!(parse_angle("1.2rad"), parse_angle("1.2"));
/// assert!(parse_angle("70").unwrap_err().to_string().contains("did you mean 70deg?"));
/// assert!(parse_angle("1.2 apples").is_err());
/// ```
pub fn parse_angle(text: &str) -> Result<f64, AngleError> {
    parsed(text, Quantity::Angle).map_err(|slip| match slip {
        Parse::Unreadable(error) => error,
        Parse::Slip(text, radians) => AngleError::Degrees { text, radians },
    })
}

/// Reads the same as an angle a second, and returns radians a second.
///
/// # Errors
/// [`AngleError`] for anything else, and for a bare number beyond 20 rad/s.
///
/// ```
/// use swimmer_files::parse_rate;
///
/// assert_eq!(parse_rate("12"), Ok(12.0));
/// assert!(parse_rate("200").unwrap_err().to_string().contains("did you mean 200deg?"));
/// ```
pub fn parse_rate(text: &str) -> Result<f64, AngleError> {
    parsed(text, Quantity::Rate).map_err(|slip| match slip {
        Parse::Unreadable(error) => error,
        Parse::Slip(text, radians) => AngleError::DegreesPerSecond { text, radians },
    })
}

/// Reason of a parse error.
enum Parse {
    Unreadable(AngleError),
    /// The text and its value.
    Slip(String, f64),
}

fn parsed(text: &str, quantity: Quantity) -> Result<f64, Parse> {
    let (radians, is_bare) = read(text).map_err(Parse::Unreadable)?;
    if is_bare && quantity.checked(radians).is_err() {
        return Err(Parse::Slip(text.trim().to_owned(), radians));
    }
    Ok(radians)
}

/// The angle \[rad\] and whether it was a bare number.
fn read(text: &str) -> Result<(f64, bool), AngleError> {
    let error = || AngleError::Unreadable {
        text: text.to_owned(),
    };
    let trimmed = text.trim();
    let degree = |unit| {
        trimmed
            .strip_suffix(unit)
            .map(|number| (number, f64::to_radians as fn(f64) -> f64))
    };
    let radian = |number| (number, (|radians| radians) as fn(f64) -> f64);
    let (number, in_radians) = degree("deg")
        .or_else(|| degree("°"))
        .or_else(|| trimmed.strip_suffix("rad").map(radian))
        .unwrap_or_else(|| radian(trimmed));
    let value: f64 = number.trim_end().parse().map_err(|_| error())?;
    if !value.is_finite() {
        return Err(error());
    }
    Ok((in_radians(value), number.len() == trimmed.len()))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_four_forms() {
        let seventy = 70.0 * std::f64::consts::PI / 180.0;
        for text in ["70deg", "70°", "70 °"] {
            assert!(
                (parse_angle(text).unwrap() - seventy).abs() < 1e-15,
                "{text}"
            );
        }
        assert!((parse_angle("1.2rad").unwrap() - 1.2).abs() < f64::EPSILON);
        assert!((parse_angle(" -1.2 ").unwrap() + 1.2).abs() < f64::EPSILON);
        assert_eq!(parse_rate("1080deg"), Ok(6.0 * std::f64::consts::PI));
    }

    #[test]
    fn a_bare_number_beyond_the_range_is_a_slip_of_the_unit() {
        for (refused, meant) in [
            (parse_angle("10"), "10deg"),
            (parse_angle("-90"), "-90deg"),
            (parse_rate("200"), "200deg"),
        ] {
            let refused = refused.unwrap_err().to_string();
            let meant = format!("did you mean {meant}?");
            assert!(refused.contains(&meant), "{refused}");
        }
        for text in ["10deg", "10rad", "6.2", "-6.2", "10°"] {
            assert!(parse_angle(text).is_ok(), "{text}");
        }
        for text in ["20", "200deg", "21rad"] {
            assert!(parse_rate(text).is_ok(), "{text}");
        }
    }

    #[test]
    fn files_are_held_to_the_same_rule() {
        for (quantity, value, meant) in [
            (
                Quantity::Angle,
                90.0,
                "did you mean 90°? Write k = 1.570796",
            ),
            (
                Quantity::Rate,
                200.0,
                "did you mean 200° a second? Write k = 3.490659",
            ),
            (Quantity::Length, 50.0, "did you mean 50 mm? Write k = 0.05"),
            (Quantity::Length, 1e6, "more than a robot has"),
            (Quantity::Pulse, 1.5, "did you mean 1.5 ms? Write k = 1500"),
            (
                Quantity::Pulse,
                1.5e6,
                "did you mean 1500000 ns? Write k = 1500",
            ),
            (Quantity::Pulse, 500.0, "between 600 and 2400 µs"),
        ] {
            let refused = quantity.checked(value).unwrap_err().of_key("k");
            assert!(refused.contains(meant), "{refused}");
        }
        for (quantity, value) in [
            (Quantity::Angle, -TAU),
            (Quantity::Rate, 20.0),
            (Quantity::Length, 10.0),
            (Quantity::Pulse, 600.0),
            (Quantity::Pulse, 2400.0),
        ] {
            assert_eq!(quantity.checked(value), Ok(value));
        }
    }

    #[test]
    fn everything_else_is_refused() {
        for text in [
            "",
            "deg",
            "rad",
            "°",
            "1.2 turns",
            "nan",
            "inf",
            "infdeg",
            "1,2",
            "1.2radd",
        ] {
            assert_eq!(
                parse_angle(text),
                Err(AngleError::Unreadable {
                    text: text.to_owned()
                }),
                "{text}"
            );
        }
    }
}
