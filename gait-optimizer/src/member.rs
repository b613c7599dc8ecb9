//! One swimmer of many that play the same gait: the ensemble of a robust design.

use swimmer_model::{InvalidSwimmer, Model, Swimmer};

/// A swimmer, and how far its servos turn.
///
/// Its shapes are `gain` times those that the servos are told, about the straight swimmer. So whatever it does along a gait Φ is
/// what the same swimmer with exact servos does along gain · Φ: a slope in Φ is `gain` times one there, a height, which is over
/// an area, the square of it.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Member {
    /// It itself.
    pub(crate) swimmer: Swimmer<f64>,
    /// Of the swimmer with L = 1.
    pub(crate) model: Model<f64>,
    /// What both servos turn over what they are told.
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
