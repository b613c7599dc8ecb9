//! Numbers as people read them: a sensible unit and no more digits than mean something.

use std::fmt;

pub(crate) use operations::text::{degrees as angle, length, small};
use swimmer_model::CrossingShare;

/// Radians without the digits that a conversion from degrees leaves behind: 1.1397, not 1.1397000015522971.
pub(crate) fn radians(value: f64) -> String {
    format!("{} rad", (value * 1e6).round() / 1e6)
}

/// Decimals that show an interval's width to two digits.
pub(crate) fn decimals([low, high]: [f64; 2]) -> usize {
    let width = high - low;
    if !(width.is_finite() && width > 0.0) {
        return 4;
    }
    #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // between 0 and 9
    let decimals = (1.0 - width.log10().floor()).clamp(0.0, 9.0) as usize;
    decimals
}

/// Share of the cycle in which links cross.
pub(crate) fn crossing(of_cycle: f64) -> String {
    if of_cycle > 0.0 {
        format!("on {:.1} % of the cycle", of_cycle * 100.0)
    } else {
        "never".to_owned()
    }
}

/// Share of the cycle in which links cross, and whether a side link passes through the middle one at an instant.
pub(crate) fn crossing_or_folding(share: &CrossingShare<f64>) -> String {
    match (share.of_cycle > 0.0, share.folds) {
        (false, true) => "at instants (|φ| = 180°: a side link on the middle one)".to_owned(),
        (true, true) => format!(
            "{}, a side link passing |φ| = 180°",
            crossing(share.of_cycle)
        ),
        (_, false) => crossing(share.of_cycle),
    }
}

/// Formats a number with a given count of significant digits, without trailing zeros.
pub(crate) fn significant(value: f64, digits: i32) -> String {
    if value == 0.0 || !value.is_finite() {
        return format!("{value}");
    }
    #[allow(clippy::cast_possible_truncation)] // At most 308.
    let decimals = digits - 1 - value.abs().log10().floor() as i32;
    let unit = 10_f64.powi(decimals.abs());
    let rounded = if decimals < 0 {
        (value / unit).round() * unit
    } else {
        (value * unit).round() / unit
    };
    format!("{rounded}")
}

/// Relative deviation of `value` from `reference`, signed. Returns `None` if the reference is zero.
pub(crate) fn relative(value: f64, reference: f64) -> Option<f64> {
    (reference != 0.0).then(|| value / reference - 1.0)
}

/// A signed relative deviation in per cent.
pub(crate) fn deviation(of_one: f64) -> String {
    // Adding zero turns a rounded -0.00 into 0.00.
    format!("{:+.2} %", (of_one * 1e4).round() / 1e2 + 0.0)
}

/// Lines of `label  value`, the values in one column.
#[derive(Debug, Default)]
pub(crate) struct Rows(Vec<(String, String)>);

impl Rows {
    /// Adds a line.
    pub(crate) fn row(&mut self, label: impl Into<String>, value: impl Into<String>) -> &mut Self {
        self.0.push((label.into(), value.into()));
        self
    }
}

impl fmt::Display for Rows {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let width = self
            .0
            .iter()
            .map(|(label, _)| label.chars().count())
            .max()
            .unwrap_or(0);
        for (index, (label, value)) in self.0.iter().enumerate() {
            let end = if index + 1 == self.0.len() { "" } else { "\n" };
            write!(f, "  {label:width$}  {value}{end}")?;
        }
        Ok(())
    }
}

/// A table with a heading line; every column as wide as its widest cell, all but the first to the right.
#[derive(Debug)]
pub(crate) struct Table(Vec<Vec<String>>);

impl Table {
    /// A table with this heading.
    pub(crate) fn new<const N: usize>(heading: [&str; N]) -> Self {
        Self(vec![heading.iter().map(ToString::to_string).collect()])
    }

    /// Adds a line.
    pub(crate) fn line<const N: usize>(&mut self, cells: [String; N]) {
        self.0.push(cells.into());
    }

    /// Its lines, the heading first.
    pub(crate) fn lines(&self) -> &[Vec<String>] {
        &self.0
    }
}

impl fmt::Display for Table {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let columns = self.0.iter().map(Vec::len).max().unwrap_or(0);
        let width = |column: usize| {
            self.0
                .iter()
                .filter_map(|line| line.get(column))
                .map(|cell| cell.chars().count())
                .max()
                .unwrap_or(0)
        };
        let widths: Vec<usize> = (0..columns).map(width).collect();
        for (index, line) in self.0.iter().enumerate() {
            let mut text = String::from(" ");
            for (column, cell) in line.iter().enumerate() {
                let width = widths.get(column).copied().unwrap_or(0);
                let padded = if column == 0 {
                    format!(" {cell:<width$}")
                } else {
                    format!("  {cell:>width$}")
                };
                text.push_str(&padded);
            }
            let end = if index + 1 == self.0.len() { "" } else { "\n" };
            write!(f, "{}{end}", text.trim_end())?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn significant_digits_have_no_tail() {
        for (value, digits, text) in [
            (1.140_000_000_000_000_1, 3, "1.14"),
            (-0.031_251, 3, "-0.0313"),
            (123_456.0, 3, "123000"),
            (2.0, 5, "2"),
            (0.0, 3, "0"),
        ] {
            assert_eq!(significant(value, digits), text);
        }
    }

    #[test]
    fn intervals_are_told_apart() {
        assert_eq!(decimals([69.177, 69.209]), 3);
        assert_eq!(decimals([3.5960, 3.5989]), 4);
        assert_eq!(decimals([60.0, 75.0]), 0);
        assert_eq!(decimals([1.0, 1.0]), 4);
    }

    #[test]
    fn radians_have_no_digits_of_the_conversion() {
        assert_eq!(radians(65.3_f64.to_radians()), "1.1397 rad");
        assert_eq!(radians(1.14_f64.next_up()), "1.14 rad");
        assert_eq!(radians(2.8), "2.8 rad");
    }

    #[test]
    fn units_follow_the_size() {
        assert_eq!(length(0.012_345_6), "12.346 mm");
        assert_eq!(length(-3.0), "-3.000000 m");
        assert_eq!(angle(-1e-9), "0.000°");
        assert_eq!(deviation(-0.0123), "-1.23 %");
        assert_eq!(
            (small(0.0), small(3e-5)),
            ("0".to_owned(), "3.0e-5".to_owned())
        );
    }

    #[test]
    fn columns_line_up() {
        let mut rows = Rows::default();
        rows.row("χ", "3.6").row("radius", "69 mm");
        assert_eq!(rows.to_string(), "  χ       3.6\n  radius  69 mm");
        let mut table = Table::new(["point", "gaps"]);
        table.line(["Front".to_owned(), "12".to_owned()]);
        assert_eq!(table.to_string(), "  point  gaps\n  Front    12");
    }
}
