//! Each number that the paper prints beside the same number computed. What it prints is data, `printed.tsv`: a row without words is
//! a number, one with words lies from `least` to `most`; `within` is how far off it may be (`none` where the paper's number
//! cannot be reproduced, and the note says why).

mod computed;
mod displacement;
mod efficiency;

use serde::Serialize;

use super::study::Study;
use computed::Computed;

const PRINTED: &str = include_str!("rows/printed.tsv");

/// What the paper says.
#[derive(Debug, Clone, Copy, Serialize)]
#[serde(untagged)]
pub enum Printed {
    /// A number.
    Number(f64),
    /// A range or a bound, in words.
    Words(&'static str),
}

/// One number.
#[derive(Debug, Clone, Serialize)]
pub struct Row {
    /// How the row is called.
    pub id: &'static str,
    /// What is compared, with its unit.
    pub quantity: &'static str,
    /// The paper's number.
    pub paper: Printed,
    /// The number computed.
    pub ours: f64,
    /// Relative to the paper's number; to the nearest end of its range; absolute where it is zero.
    pub deviation: f64,
    /// None where the paper's number cannot be reproduced.
    pub pass: Option<bool>,
    /// What the paper leaves open, where it does.
    #[serde(skip_serializing_if = "str::is_empty")]
    pub note: &'static str,
}

impl Row {
    /// A line of the table beside what was computed; none where it is no such line.
    fn new(line: &'static str, ours: f64) -> Option<Self> {
        let [id, quantity, paper, least, most, within, note] = cells(line)?;
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
        })
    }
}

/// The cells of a line of the table.
fn cells(line: &'static str) -> Option<[&'static str; 7]> {
    let cells: Vec<_> = line.split('\t').collect();
    cells.try_into().ok()
}

/// All rows, in the order of the paper.
pub fn rows(study: &Study) -> Vec<Row> {
    let ours: Vec<Computed> = [
        displacement::robot_data(study),
        displacement::experiments(study),
        displacement::simple_displacement(study),
        displacement::displacement_gaits(study),
        displacement::height_maps(study),
        efficiency::simple_efficiency(study),
        efficiency::lighthill_gaits(study),
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
        let line = format!("id\tquantity\t{paper}\t{least}\t{most}\t{within}\t");
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
