//! Comparison of each number and each statement of the paper with the computed number. They are in `printed.tsv`. The column
//! `claim` distinguishes numbers that the paper prints from statements, such as "positive". A value without words is a number; one
//! with words is a range from `least` to `most`. The column `within` has the tolerance, or `none` if the paper's number cannot be
//! reproduced, for a reason that the note states.

mod areas;
mod computed;
mod displacement;
mod efficiency;
mod fit;
mod methods;
mod switching;

use std::path::PathBuf;

use serde::Serialize;

use super::study::Study;
use computed::Computed;

const PRINTED: &str = include_str!("rows/printed.tsv");

/// Kind of a row.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PaperClaim")
)]
#[serde(rename_all = "lowercase")]
pub enum Claim {
    /// The paper prints a number or a range of numbers.
    Number,
    /// The paper states a property without a number.
    Statement,
}

/// Value printed in the paper.
#[derive(Debug, Clone, Copy, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PrintedValue")
)]
#[serde(untagged)]
pub enum Printed {
    /// A number.
    Number(f64),
    /// A range or a bound, in words.
    Words(&'static str),
}

/// Comparison of one number.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PaperRow")
)]
pub struct Row {
    /// Identifier of the row.
    pub id: &'static str,
    /// Name of the quantity, with its unit.
    pub quantity: &'static str,
    /// The paper's number.
    pub paper: Printed,
    /// The number computed.
    pub ours: f64,
    /// Deviation relative to the paper's number or to the nearest end of its range; absolute if that is zero.
    pub deviation: f64,
    /// `None` if the paper's number cannot be reproduced.
    pub pass: Option<bool>,
    /// Explanation of what the paper leaves open; may be empty.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub note: &'static str,
    /// Printed number or statement.
    pub claim: Claim,
}

impl Row {
    /// Compares a line of the table with the computed value. Returns `None` if the line is malformed.
    fn new(line: &'static str, ours: f64) -> Option<Self> {
        let [id, claim, quantity, paper, least, most, within, note] = cells(line)?;
        let claim = match claim {
            "number" => Claim::Number,
            "statement" => Claim::Statement,
            _ => return None,
        };
        let (printed, low, high) = match paper.parse() {
            Ok(number) => (Printed::Number(number), number, number),
            Err(_) => (
                Printed::Words(paper),
                least.parse().ok()?,
                most.parse().ok()?,
            ),
        };
        let nearest = ours.max(low).min(high);
        let deviation = if (low..=high).contains(&ours) {
            0.0
        } else if nearest == 0.0 {
            ours
        } else {
            ours / nearest - 1.0
        };
        let pass = match within {
            "none" => None,
            within => Some(deviation.abs() <= within.parse().ok()?),
        };
        Some(Self {
            id,
            quantity,
            paper: printed,
            ours,
            deviation,
            pass,
            note,
            claim,
        })
    }
}

/// All comparisons. The JSON document of `swimmer paper`.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PaperOutput")
)]
pub struct Output {
    /// Comparisons.
    pub rows: Vec<Row>,
    /// Page, if the front end wrote one.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub page: Option<PathBuf>,
    /// Rows with a printed number.
    pub numbers: Tally,
    /// Rows with a statement.
    pub statements: Tally,
}

impl Output {
    /// Counts the rows.
    pub fn new(rows: Vec<Row>) -> Self {
        Self {
            numbers: Tally::of(&rows, Claim::Number),
            statements: Tally::of(&rows, Claim::Statement),
            rows,
            page: None,
        }
    }
}

/// Counts of rows by outcome.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize)]
#[cfg_attr(
    feature = "schema",
    derive(schemars::JsonSchema),
    schemars(rename = "PaperTally")
)]
pub struct Tally {
    /// Rows that agree with the paper.
    pub reproduced: usize,
    /// Rows that differ from it.
    pub differ: usize,
    /// Rows that cannot be compared, each with its reason.
    pub open: usize,
}

impl Tally {
    /// Counts the rows of one kind.
    pub fn of(rows: &[Row], claim: Claim) -> Self {
        let count = |pass: Option<bool>| {
            let counted = |row: &&Row| row.claim == claim && row.pass == pass;
            rows.iter().filter(counted).count()
        };
        Self {
            reproduced: count(Some(true)),
            differ: count(Some(false)),
            open: count(None),
        }
    }

    /// Number of rows.
    pub fn total(&self) -> usize {
        self.reproduced + self.differ + self.open
    }
}

/// Splits a line of the table into its cells.
fn cells(line: &'static str) -> Option<[&'static str; 8]> {
    let cells: Vec<_> = line.split('\t').collect();
    cells.try_into().ok()
}

/// All rows, in the order of the paper.
pub fn rows(study: &Study) -> Vec<Row> {
    let ours: Vec<Computed> = [
        displacement::robot_data(study),
        displacement::experiments(study),
        fit::fit(study),
        displacement::simple_displacement(study),
        switching::switching_function(study),
        displacement::displacement_gaits(study),
        areas::enclosed_areas(study),
        displacement::height_maps(study),
        efficiency::simple_efficiency(study),
        efficiency::lighthill_gaits(study),
        methods::three_methods(study),
        methods::orders_of_fourier_series(study),
        efficiency::appendices(study),
    ]
    .concat();
    let of = |line: &'static str| {
        let id = line.split('\t').next();
        let ours = ours.iter().find(|(own, _)| Some(*own) == id);
        Row::new(line, ours.map_or(f64::NAN, |(_, ours)| *ours))
    };
    PRINTED.lines().skip(1).filter_map(of).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The row of a line with these four cells.
    fn row(paper: &str, least: &str, most: &str, within: &str, ours: f64) -> Row {
        let line = format!("id\tnumber\tquantity\t{paper}\t{least}\t{most}\t{within}\t");
        Row::new(line.leak(), ours).unwrap()
    }

    #[test]
    fn a_number_is_met_within_its_share_zero_absolutely_and_nothing_by_what_is_no_number() {
        assert_eq!(row("2", "", "", "0.01", 2.01).pass, Some(true));
        assert_eq!(row("2", "", "", "0.01", 2.03).pass, Some(false));
        assert_eq!(
            row("0", "", "", "1e-9", -1e-10).deviation.to_bits(),
            (-1e-10_f64).to_bits()
        );
        assert_eq!(row("0", "", "", "1e-9", 1e-8).pass, Some(false));
        assert_eq!(row("2", "", "", "none", 7.0).pass, None);
        for (paper, least, most) in [("2", "", ""), ("0", "", ""), ("some", "0", "inf")] {
            assert_eq!(row(paper, least, most, "0.05", f64::NAN).pass, Some(false));
        }
    }

    #[test]
    fn a_range_is_met_inside_and_beside_its_ends_as_far_as_it_says() {
        let around = |ours| row("around 1.5 to 2", "1.5", "2", "0.05", ours);
        assert_eq!(
            (around(1.7).pass, around(1.7).deviation.to_bits()),
            (Some(true), 0)
        );
        assert_eq!(
            (around(2.05).pass, around(2.15).pass),
            (Some(true), Some(false))
        );
        assert!((around(1.2).deviation + 0.2).abs() < 1e-12);
        let negative = |ours| row("negative", "-inf", "0", "0", ours).pass;
        assert_eq!((negative(-0.1), negative(0.1)), (Some(true), Some(false)));
    }
}
