//! Member of the ensemble of a robust design.

use swimmer_model::{InvalidSwimmer, Model, Swimmer};

/// Swimmer with the gain of its servos.
///
/// Its shapes are `gain` times the commanded shapes. Along a gait Φ it moves as the same swimmer with exact servos along gain · Φ.
/// Derivatives by Φ therefore have a factor `gain`, and heights, which are per area, its square.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Member {
    /// Swimmer.
    pub(crate) swimmer: Swimmer<f64>,
    /// Model of the swimmer with L = 1.
    pub(crate) model: Model<f64>,
    /// Actual over commanded angle of both servos.
    pub(crate) gain: f64,
}

impl Member {
    pub(crate) fn new(swimmer: &Swimmer<f64>, gain: f64) -> Result<Self, InvalidSwimmer> {
        Ok(Self {
            swimmer: *swimmer,
            model: Model::new(&swimmer.of_unit_length())?,
            gain,
        })
    }
}
