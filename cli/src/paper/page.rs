//! Table and figures as one self-contained HTML page.

use std::fmt::Write;

use validation::{Printed, Row};

use super::Figure;
use crate::failure::Outcome;
use crate::report::{escaped, minus};

/// Builds the whole page; the same numbers give the same bytes.
///
/// # Errors
/// As the drawing of a chart.
pub(crate) fn page(rows: &[Row], figures: &[Figure]) -> Outcome<String> {
    let mut html = String::with_capacity(1_000_000);
    html.push_str(HEAD);
    let count = |pass| rows.iter().filter(|row| row.pass == pass).count();
    let _ = write!(
        html,
        "<header><h1>The paper, computed</h1><p>Berkovich Lahav, Wiezel, Or: <i>Optimal control of a swimming robot based on \
         Purcell’s microswimmer model</i>. {} numbers: <b>{} reproduced</b>, {} not, {} that cannot be. Squares at constant \
         power; every gait found without a guess.</p></header>",
        rows.len(),
        count(Some(true)),
        count(Some(false)),
        count(None),
    );
    table(&mut html, rows);
    html.push_str("<section class=grid>");
    for figure in figures {
        let _ = write!(
            html,
            "<figure><h2>{}</h2>{}<figcaption>{}</figcaption></figure>",
            figure.title,
            figure.svg()?,
            figure.caption
        );
    }
    html.push_str("</section></main></body></html>\n");
    Ok(html)
}

fn table(html: &mut String, rows: &[Row]) {
    html.push_str(
        "<section><div class=scroll tabindex=0><table class=rows><thead><tr><th>quantity<th>paper<th>ours<th>deviation<th></tr></thead><tbody>",
    );
    for row in rows {
        let verdict = match row.pass {
            Some(true) => "<td class=yes>✓",
            Some(false) => "<td class=no>✗",
            None => "<td class=open>not reproducible",
        };
        let _ = write!(html, "<tr><th>{}", escaped(row.quantity));
        if !row.note.is_empty() {
            let _ = write!(html, "<small>{}</small>", escaped(row.note));
        }
        let _ = write!(
            html,
            "<td>{}<td>{}<td>{}{verdict}</tr>",
            printed(row.paper),
            minus(&number(row.ours)),
            minus(&deviation(row)),
        );
    }
    html.push_str("</tbody></table></div></section>");
}

/// The paper's number as a person reads it.
pub(crate) fn printed(paper: Printed) -> String {
    match paper {
        Printed::Number(value) => format!("{value}"),
        Printed::Words(words) => words.to_owned(),
    }
}

/// Our number, with as many digits as mean something beside the paper's.
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

/// How far they are apart.
pub(crate) fn deviation(row: &Row) -> String {
    match row.paper {
        Printed::Number(value) if value != 0.0 => crate::quantity::deviation(row.deviation),
        Printed::Words(_) if row.deviation == 0.0 => "within".to_owned(),
        Printed::Words(_) => crate::quantity::deviation(row.deviation),
        Printed::Number(_) => number(row.deviation),
    }
}

const HEAD: &str = concat!(
    "<!doctype html>\n<html lang=en><head><meta charset=utf-8>",
    "<meta name=viewport content='width=device-width,initial-scale=1'><title>Swimmer: the paper, computed</title><style>\n",
    include_str!("../report/page.css"),
    include_str!("page.css"),
    "</style></head><body><main>"
);
