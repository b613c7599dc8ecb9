//! Angles as people type them: `70deg`, `70°`, `1.2rad`, or a bare number of radians.

use std::f64::consts::TAU;

/// Why a text is not an angle.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
pub enum AngleError {
    /// It cannot be read.
    #[error(
        "`{text}` is not an angle: write degrees as 70deg, radians as 1.2rad or as a bare number 1.2"
    )]
    Unreadable {
        /// What was typed.
        text: String,
    },
    /// A joint's angle without a unit, beyond a full turn: hardly radians.
    #[error(
        "`{text}` without a unit is radians, and a joint does not turn {:.1} times: did you mean {text}deg? Write {text}rad if not",
        radians.abs() / TAU
    )]
    Degrees {
        /// What was typed.
        text: String,
        /// What it reads as \[rad\].
        radians: f64,
    },
}

/// Reads `70deg`, `70°`, `1.2rad` or `1.2` (radians) and returns radians; for rates and for rotations of the whole swimmer.
///
/// # Errors
/// [`AngleError::Unreadable`] for anything else, `nan` and infinities included.
///
/// ```
/// use swimmer_files::parse_angle;
///
/// assert_eq!(parse_angle("180deg"), Ok(std::f64::consts::PI));
/// assert_eq!(parse_angle("1.2rad"), parse_angle("1.2"));
/// assert!(parse_angle("1.2 apples").is_err());
/// ```
pub fn parse_angle(text: &str) -> Result<f64, AngleError> {
    read(text).map(|(radians, _)| radians)
}

/// The same for the angle of a joint, where a bare number above 2π is degrees without their unit.
///
/// # Errors
/// [`AngleError`].
///
/// ```
/// use swimmer_files::parse_joint_angle;
///
/// assert_eq!(parse_joint_angle("1.2"), Ok(1.2));
/// assert!(parse_joint_angle("70").unwrap_err().to_string().contains("70deg"), "degrees are meant");
/// ```
pub fn parse_joint_angle(text: &str) -> Result<f64, AngleError> {
    let (radians, bare) = read(text)?;
    if bare && looks_like_degrees(radians) {
        return Err(AngleError::Degrees {
            text: text.trim().to_owned(),
            radians,
        });
    }
    Ok(radians)
}

/// Whether a joint angle that should be in radians can only be degrees.
pub(crate) fn looks_like_degrees(radians: f64) -> bool {
    radians.abs() > TAU
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
    }

    #[test]
    fn a_bare_joint_angle_beyond_a_turn_is_degrees() {
        let refused = parse_joint_angle("10").unwrap_err();
        assert!(matches!(refused, AngleError::Degrees { .. }));
        assert!(
            refused.to_string().contains("did you mean 10deg?"),
            "{refused}"
        );
        for text in ["10deg", "10rad", "6.2", "-6.2", "10°"] {
            assert_eq!(parse_joint_angle(text), parse_angle(text), "{text}");
        }
        assert_eq!(parse_angle("10"), Ok(10.0));
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
                parse_joint_angle(text),
                Err(AngleError::Unreadable {
                    text: text.to_owned()
                }),
                "{text}"
            );
        }
    }
}
