//! What is asked, and what every step of the search shares.

use nalgebra::Vector2;
use swimmer_model::Model;

use crate::region::Region;

/// Which way the gait shall lead, against its mean heading.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum HeadingRule {
    /// Any way.
    #[default]
    Any,
    /// Along the mean heading.
    Forward,
    /// Across it.
    Sideways,
}

impl HeadingRule {
    /// By how much a heading misses, modulo half a turn (the gait run backwards leads the other way); none for any way.
    pub(crate) fn off(self, heading: f64) -> Option<f64> {
        use std::f64::consts::{FRAC_PI_2, PI};
        let aim = match self {
            Self::Any => return None,
            Self::Forward => 0.0,
            Self::Sideways => FRAC_PI_2,
        };
        let off = heading - aim;
        Some(off - PI * (off / PI).round())
    }
}

/// What every step of the search shares.
#[derive(Debug)]
pub(crate) struct Setting<'a> {
    /// Of the swimmer with L = 1.
    pub(crate) model: &'a Model<f64>,
    pub(crate) region: &'a Region,
    /// Largest |φ̇ᵢ|.
    pub(crate) rates: [f64; 2],
    pub(crate) heading: HeadingRule,
    /// The period, where it is prescribed.
    pub(crate) period: Option<f64>,
}

impl Setting<'_> {
    /// The least time in which the servos turn by this.
    pub(crate) fn time(&self, way: &Vector2<f64>) -> f64 {
        (way.x.abs() / self.rates[0]).max(way.y.abs() / self.rates[1])
    }
}
