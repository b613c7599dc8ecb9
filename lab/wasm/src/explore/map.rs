//! `height-map` and `height-grid`: the height function as in `swimmer height-map`, and its values for a picture.

use gait_optimizer::HeightMap;
use operations::height_map::{self, Component};
use serde::Deserialize;
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
struct Request {
    swimmer: SwimmerText,
    row: Component,
    /// \[rad\]
    max_angle: f64,
    /// Number of grid nodes along each axis.
    #[serde(default)]
    count: usize,
}

/// Zero-level curves and numbers of a row.
pub(super) fn height_map(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: Request = parsed(bytes)?;
    let file = request.swimmer.read()?;
    let map = lab.explore.map(&file.swimmer, request.max_angle)?;
    json(&height_map::run(map, request.row, &[])?)
}

/// Heights on a uniform grid; φ₁ varies fastest.
pub(super) fn height_grid(lab: &mut Lab, bytes: &[u8]) -> Outcome {
    let request: Request = parsed(bytes)?;
    let file = request.swimmer.read()?;
    let map = lab.explore.map(&file.swimmer, request.max_angle)?;
    let grid = map.grid(request.row.row(), request.count.clamp(2, 401));
    numbers(grid.heights.iter().copied())
}
