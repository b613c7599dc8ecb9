//! Numbers as tracking files write them: blank and NaN are missing, and a decimal comma is one where the delimiter allows it.

use std::path::Path;

use super::cells::Cell;
use super::lines::{Delimiter, TextLine};
use super::{TrackError, TrackProblem};

/// Content of a cell that should hold a number.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Number {
    /// A finite number.
    Finite(f64),
    /// Blank or some spelling of NaN (`1.#QNAN0` and `-1.#IND00` among them).
    Missing,
    /// Anything else.
    Wrong,
}

/// Decimal sign of a file. The first number with a sign decides: `1,234` is 1.234 in a file with decimal commas, and 1234 in one
/// with decimal points.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Decimals {
    /// Points only: the comma stands between cells.
    Point,
    /// A comma may be one; not yet seen.
    Open,
    /// Commas.
    Comma,
}

impl Decimals {
    /// Of a file whose cells this stands between.
    pub(super) fn of(delimiter: Delimiter) -> Self {
        if delimiter.allows_decimal_comma() {
            Self::Open
        } else {
            Self::Point
        }
    }

    /// Parses a cell; may determine the decimal sign.
    pub(super) fn number(&mut self, text: &str) -> Number {
        if *self == Self::Point {
            return number(text, false);
        }
        if *self == Self::Open {
            match text.bytes().find(|b| matches!(b, b'.' | b',')) {
                Some(b'.') => *self = Self::Point,
                Some(_) => *self = Self::Comma,
                None => {}
            }
            return number(text, true);
        }
        if text.contains('.') && matches!(number(text, false), Number::Finite(_)) {
            return Number::Wrong;
        }
        number(text, true)
    }

    /// A cell that should hold a number or nothing; `what` names it in the error.
    ///
    /// # Errors
    /// [`TrackProblem::NotANumber`] for anything else.
    pub(super) fn cell(
        &mut self,
        cell: &Cell<'_>,
        (line, file): (&TextLine<'_>, &Path),
        what: &str,
    ) -> Result<Option<f64>, TrackError> {
        match self.number(cell.raw) {
            Number::Finite(value) => Ok(Some(value)),
            Number::Missing => Ok(None),
            Number::Wrong => {
                let problem = TrackProblem::NotANumber {
                    text: cell.text().into_owned(),
                    cell: what.to_owned(),
                };
                Err(line.error(file, cell.at, problem))
            }
        }
    }
}

/// Powers of ten that are exact in double precision, as far as needed.
const POWERS: [f64; 16] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
];

/// Numbers of at most 15 digits without an exponent, which is nearly all: the digits and the power of ten are exact, so one
/// division rounds correctly.
fn plain(bytes: &[u8]) -> Option<f64> {
    let (negative, digits) = match bytes.split_first()? {
        (b'-', rest) => (true, rest),
        _ => (false, bytes),
    };
    if digits.len() > 16 {
        return None;
    }
    let (mut value, mut count, mut point) = (0_u64, 0, None);
    for byte in digits {
        match byte {
            b'0'..=b'9' => {
                value = value * 10 + u64::from(byte - b'0');
                count += 1;
            }
            b'.' if point.is_none() => point = Some(count),
            _ => return None,
        }
    }
    if count == 0 || count > 15 {
        return None;
    }
    let scale = POWERS.get(point.map_or(0, |point| count - point))?;
    let value = value as f64 / scale;
    Some(if negative { -value } else { value })
}

/// Parses a cell, in which a comma is a decimal sign if `decimal_comma`.
pub(super) fn number(text: &str, decimal_comma: bool) -> Number {
    if let Some(value) = plain(text.as_bytes()) {
        return Number::Finite(value);
    }
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

/// A header's rate \[Hz\].
///
/// # Errors
/// [`TrackProblem::Rate`] for anything but a positive number.
pub(super) fn rate(
    cell: &Cell<'_>,
    line: &TextLine<'_>,
    file: &Path,
    decimal_comma: bool,
) -> Result<f64, TrackError> {
    match number(cell.raw, decimal_comma) {
        Number::Finite(rate) if rate > 0.0 => Ok(rate),
        _ => {
            let text = cell.text().into_owned();
            Err(line.error(file, cell.at, TrackProblem::Rate { text }))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::{Decimals, Number, number};
    use proptest::prelude::*;

    #[test]
    fn what_is_missing_and_what_is_wrong() {
        for text in ["", "  ", "NaN", "NAN", "1.#QNAN0", "-1.#IND00"] {
            assert_eq!(number(text, false), Number::Missing, "{text}");
        }
        for text in [
            "inf", "1e999", "12:30", "x", "1,5", "0x10", "-", ".", "-.", "1.2.3", "--1",
        ] {
            assert_eq!(number(text, false), Number::Wrong, "{text}");
        }
        assert_eq!(number(" 1.5e-3", false), Number::Finite(1.5e-3));
        assert_eq!(number("1,5", true), Number::Finite(1.5));
        assert_eq!(number("1.5", true), Number::Finite(1.5));
        assert_eq!(number("1,234,5", true), Number::Wrong);
    }

    #[test]
    fn the_first_decimal_sign_holds_for_the_file() {
        let mut decimals = Decimals::Open;
        assert_eq!(decimals.number("12"), Number::Finite(12.0));
        assert_eq!(decimals.number("0,5"), Number::Finite(0.5));
        assert_eq!(decimals.number("0.5"), Number::Wrong);
        let mut decimals = Decimals::Open;
        assert_eq!(decimals.number("0.5"), Number::Finite(0.5));
        assert_eq!(decimals.number("1,234"), Number::Wrong);
        assert_eq!(decimals.number("NaN"), Number::Missing);
    }

    proptest! {
        #[test]
        fn the_short_way_reads_what_the_long_way_reads(text in "-?[0-9]{0,9}(\\.[0-9]{0,9})?") {
            let long = text.parse::<f64>().map_or(
                if text.is_empty() { Number::Missing } else { Number::Wrong },
                Number::Finite,
            );
            prop_assert_eq!(number(&text, false), long);
        }
    }
}
