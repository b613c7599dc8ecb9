//! Each number that the paper prints beside the same number computed.

mod displacement;
mod efficiency;

use gait_optimizer::{BestAmplitude, Bounds, Objective, OptimalGait, certify};
use serde::Serialize;

use super::study::Study;

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

/// Ratios are printed to two or three digits.
const RATIO: f64 = 0.01;
/// The paper rounds its rough figures freely.
const ROUGH: f64 = 0.05;

impl Row {
    /// A printed number, met to a relative tolerance.
    fn near(id: &'static str, quantity: &'static str, paper: f64, ours: f64, within: f64) -> Self {
        let deviation = ours / paper - 1.0;
        Self::new(
            id,
            quantity,
            Printed::Number(paper),
            ours,
            deviation,
            deviation.abs() <= within,
        )
    }

    /// Zero, or as good as.
    fn zero(id: &'static str, quantity: &'static str, ours: f64, within: f64) -> Self {
        Self::new(
            id,
            quantity,
            Printed::Number(0.0),
            ours,
            ours,
            ours.abs() <= within,
        )
    }

    /// A printed range.
    fn range(
        id: &'static str,
        quantity: &'static str,
        words: &'static str,
        (low, high): (f64, f64),
        ours: f64,
    ) -> Self {
        let deviation = if ours < low {
            ours / low - 1.0
        } else if ours > high {
            ours / high - 1.0
        } else {
            0.0
        };
        Self::new(
            id,
            quantity,
            Printed::Words(words),
            ours,
            deviation,
            (low..=high).contains(&ours),
        )
    }

    /// A range that the paper reads off a figure, "around": met within [`ROUGH`] of its ends.
    fn around(
        id: &'static str,
        quantity: &'static str,
        words: &'static str,
        ends: (f64, f64),
        ours: f64,
    ) -> Self {
        let row = Self::range(id, quantity, words, ends, ours);
        Self {
            pass: Some(row.deviation.abs() <= ROUGH),
            ..row
        }
    }

    fn new(
        id: &'static str,
        quantity: &'static str,
        paper: Printed,
        ours: f64,
        deviation: f64,
        pass: bool,
    ) -> Self {
        Self {
            id,
            quantity,
            paper,
            ours,
            deviation,
            pass: Some(pass),
            note: "",
        }
    }

    fn note(mut self, note: &'static str) -> Self {
        self.note = note;
        self
    }

    /// It does not come out, and the note says why.
    fn not_reproducible(self, note: &'static str) -> Self {
        Self {
            pass: None,
            note,
            ..self
        }
    }
}

/// All rows, in the order of the paper.
pub fn rows(study: &Study) -> Vec<Row> {
    let mut rows = displacement::robot_data(study);
    rows.extend(displacement::experiments(study));
    rows.extend(displacement::simple_displacement(study));
    rows.extend(displacement::displacement_gaits(study));
    rows.extend(displacement::height_maps(study));
    rows.extend(efficiency::simple_efficiency(study));
    rows.extend(efficiency::lighthill_gaits(study));
    rows.extend(efficiency::appendices(study));
    rows
}

/// How many conditions a gait fails when only its samples are known; NaN where it cannot be asked.
fn failed_checks(gait: &OptimalGait) -> f64 {
    let file = gait.gait_file("");
    certify(&gait.swimmer, &file, gait.objective, &gait.bounds).map_or(f64::NAN, |certificate| {
        certificate
            .checks()
            .iter()
            .filter(|check| !check.pass)
            .count() as f64
    })
}

/// One number of that certificate.
fn value_of(gait: &OptimalGait, name: &str) -> f64 {
    let file = gait.gait_file("");
    certify(
        &gait.swimmer,
        &file,
        Objective::Efficiency,
        &Bounds::default(),
    )
    .ok()
    .and_then(|certificate| certificate.value(name))
    .unwrap_or(f64::NAN)
}

/// The first best amplitude.
fn first(best: &[BestAmplitude]) -> &BestAmplitude {
    best.first().unwrap_or(&NONE)
}

/// The second one.
fn second(best: &[BestAmplitude]) -> &BestAmplitude {
    best.get(1).unwrap_or(&NONE)
}

/// No such amplitude: every comparison with it fails.
const NONE: BestAmplitude = BestAmplitude {
    amplitude: f64::NAN,
    displacement_over_length: f64::NAN,
    efficiency: f64::NAN,
};
