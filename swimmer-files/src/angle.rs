//! Angles as people type them: `70deg`, `1.2rad`, or a bare number of radians.

/// Why a text is not an angle.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error(
    "`{text}` is not an angle: write degrees as 70deg, radians as 1.2rad or as a bare number 1.2"
)]
pub struct AngleError {
    /// What was typed.
    pub text: String,
}

/// Reads `70deg`, `1.2rad` or `1.2` (radians) and returns radians.
///
/// # Errors
/// [`AngleError`] for anything else, `nan` and infinities included.
pub fn parse_angle(text: &str) -> Result<f64, AngleError> {
    let error = || AngleError {
        text: text.to_owned(),
    };
    let trimmed = text.trim();
    let (number, in_degrees) = if let Some(number) = trimmed.strip_suffix("deg") {
        (number, true)
    } else {
        (trimmed.strip_suffix("rad").unwrap_or(trimmed), false)
    };
    let value: f64 = number.trim_end().parse().map_err(|_| error())?;
    if !value.is_finite() {
        return Err(error());
    }
    Ok(if in_degrees {
        value.to_radians()
    } else {
        value
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_three_forms() {
        assert!(
            (parse_angle("70deg").unwrap() - 70.0 * std::f64::consts::PI / 180.0).abs() < 1e-15
        );
        assert!((parse_angle("1.2rad").unwrap() - 1.2).abs() < f64::EPSILON);
        assert!((parse_angle(" -1.2 ").unwrap() + 1.2).abs() < f64::EPSILON);
    }

    #[test]
    fn everything_else_is_refused() {
        for text in [
            "",
            "deg",
            "rad",
            "1.2 turns",
            "70°",
            "nan",
            "inf",
            "infdeg",
            "1,2",
            "1.2radd",
        ] {
            assert_eq!(
                parse_angle(text),
                Err(AngleError {
                    text: text.to_owned()
                }),
                "{text}"
            );
        }
    }
}
