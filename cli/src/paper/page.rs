//! Table and figures as one self-contained HTML page.

use askama::Template;
use validation::{Claim, Printed, Row, Tally};

use super::Figure;
use crate::failure::Outcome;
use crate::picture_file::FigureWidth;
use crate::report::written;

#[derive(Template)]
#[template(path = "paper/page.html")]
struct Page<'a> {
    rows: &'a [Row],
    numbers: Tally,
    statements: Tally,
    /// Each with its drawing.
    figures: Vec<(&'a Figure, String)>,
}

/// Builds the whole page; the same numbers give the same bytes.
///
/// # Errors
/// Errors of the drawing.
pub(crate) fn page(rows: &[Row], figures: &[Figure]) -> Outcome<String> {
    let drawn = figures
        .iter()
        .map(|figure| Ok((figure, figure.svg(FigureWidth::Page)?)));
    written(&Page {
        rows,
        numbers: Tally::of(rows, Claim::Number),
        statements: Tally::of(rows, Claim::Statement),
        figures: drawn.collect::<Outcome<_>>()?,
    })
}

/// The paper's number as a person reads it.
pub(crate) fn printed(paper: Printed) -> String {
    match paper {
        Printed::Number(value) => format!("{value}"),
        Printed::Words(words) => words.to_owned(),
    }
}

/// Our number, with the digits that are significant for a comparison with the paper's.
pub(crate) fn number(value: f64) -> String {
    if value == 0.0 || (1e-3..1e4).contains(&value.abs()) {
        format!("{value:.5}")
            .trim_end_matches('0')
            .trim_end_matches('.')
            .to_owned()
    } else {
        format!("{value:.1e}")
    }
}

/// Words for a row that cannot be compared.
pub(crate) fn open(row: &Row) -> &'static str {
    match row.paper {
        Printed::Number(_) => "not reproducible",
        Printed::Words(_) => "no number printed",
    }
}

/// Difference of both numbers.
pub(crate) fn deviation(row: &Row) -> String {
    match row.paper {
        Printed::Number(value) if value != 0.0 => crate::quantity::deviation(row.deviation),
        Printed::Words(_) if row.deviation == 0.0 => "within".to_owned(),
        Printed::Words(_) => crate::quantity::deviation(row.deviation),
        Printed::Number(_) => number(row.deviation),
    }
}
