//! Numbers as tracking files write them: blank and NaN are missing, and a decimal comma is one where the delimiter allows it.

/// What a cell that should hold a number says.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    /// A finite number.
    Finite(f64),
    /// Blank or some spelling of NaN (`1.#QNAN0` and `-1.#IND00` among them).
    Missing,
    /// Anything else.
    Wrong,
}

pub(super) fn number(text: &str, decimal_comma: bool) -> Number {
    let text = text.trim();
    if text.is_empty() {
        return Number::Missing;
    }
    let parsed = if decimal_comma && text.contains(',') {
        text.replacen(',', ".", 1).parse::<f64>()
    } else {
        text.parse::<f64>()
    };
    match parsed {
        Ok(value) if value.is_finite() => Number::Finite(value),
        Ok(value) if value.is_nan() => Number::Missing,
        Err(_) if text.contains(".#QNAN") || text.contains(".#IND") => Number::Missing,
        _ => Number::Wrong,
    }
}

#[cfg(test)]
mod tests {
    use super::{Number, number};

    #[test]
    fn what_is_missing_and_what_is_wrong() {
        for text in ["", "  ", "NaN", "NAN", "1.#QNAN0", "-1.#IND00"] {
            assert_eq!(number(text, false), Number::Missing, "{text}");
        }
        for text in ["inf", "1e999", "12:30", "x", "1,5", "0x10"] {
            assert_eq!(number(text, false), Number::Wrong, "{text}");
        }
        assert_eq!(number(" 1.5e-3", false), Number::Finite(1.5e-3));
        assert_eq!(number("1,5", true), Number::Finite(1.5));
        assert_eq!(number("1.5", true), Number::Finite(1.5));
        assert_eq!(number("1,234,5", true), Number::Wrong);
    }
}
