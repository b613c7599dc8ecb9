//! `height-map` and `height-grid`: the height function as in `swimmer height-map`, and its values for a picture.

use gait_optimizer::{HeightMap, LevelCurve, Row};
use serde::{Deserialize, Serialize};
use swimmer_model::Swimmer;

use crate::calls::{Lab, Outcome, json, numbers, parsed};
use crate::input::SwimmerText;

/// Last height map: three rows, each on a coarse and a fine grid, use the same one.
#[derive(Default)]
pub struct Memory(Option<(Swimmer<f64>, HeightMap)>);

impl Memory {
    fn map(&mut self, swimmer: &Swimmer<f64>, half_width: f64) -> Result<&HeightMap, String> {
        let known = self.0.take().filter(|(of, map)| {
            of == swimmer && map.half_width().to_bits() == half_width.to_bits()
        });
        let found = if let Some(known) = known {
            known
        } else {
            let map = HeightMap::new(swimmer, half_width).map_err(|why| why.to_string())?;
            (*swimmer, map)
        };
        Ok(&self.0.insert(found).1)
    }
}

#[derive(Deserialize)]
struct Asked {
    swimmer: SwimmerText,
    row: RowAsked,
    /// \[rad\]
    max_angle: f64,
    /// Number of grid nodes along each axis.
    #[serde(default)]
    count: usize,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(rename_all = "lowercase")]
enum RowAsked {
    X,
    Y,
    Theta,
}

impl From<RowAsked> for Row {
    fn from(row: RowAsked) -> Self {
        match row {
            RowAsked::X => Self::X,
            RowAsked::Y => Self::Y,
            RowAsked::Theta => Self::Theta,
        }
    }
}

#[derive(Serialize)]
struct Mapped {
    max_angle_rad: f64,
    at_origin_over_length: f64,
    zero_on_diagonal: Option<f64>,
    zero_on_antidiagonal: Option<f64>,
    zero_curves: Vec<Curve>,
}

#[derive(Serialize)]
struct Curve {
    closed: bool,
    points: Vec<[f64; 2]>,
}

impl From<&LevelCurve> for Curve {
    fn from(curve: &LevelCurve) -> Self {
        Self {
            closed: curve.closed,
            points: curve
                .points
                .iter()
                .map(|point| [point.x, point.y])
                .collect(),
        }
    }
}

/// Zero-level curves and numbers of a row.
pub(super) fn height_map(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: Asked = parsed(bytes)?;
    let file = asked.swimmer.read()?;
    let map = lab.explore.map(&file.swimmer, asked.max_angle)?;
    let row = asked.row.into();
    json(&Mapped {
        max_angle_rad: asked.max_angle,
        at_origin_over_length: map.height(row, &[0.0, 0.0].into()),
        zero_on_diagonal: map.zeros_on_diagonal(row).first().copied(),
        zero_on_antidiagonal: map.zeros_on_antidiagonal(row).first().copied(),
        zero_curves: map.zero_curves(row).iter().map(Curve::from).collect(),
    })
}

/// Heights on a uniform grid; φ₁ varies fastest.
pub(super) fn height_grid(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let asked: Asked = parsed(bytes)?;
    let file = asked.swimmer.read()?;
    let map = lab.explore.map(&file.swimmer, asked.max_angle)?;
    let grid = map.grid(asked.row.into(), asked.count.clamp(2, 401));
    numbers(grid.heights.iter().copied())
}
