//! The five quantities that are measured of a run's cycles and predicted, always in this order.

use crate::cycles::{Cycles, Statistics};
use crate::prediction::PredictedCycle;

/// Values of one run: X, ΔY, Δθ, and Y and the net turn, which are zero for symmetric gaits.
pub(crate) const QUANTITIES: usize = 5;
/// Number of quantities, from the first, that determine r_s and χ.
pub(crate) const TELLING: usize = 3;
/// Their names.
pub(crate) const NAMES: [&str; QUANTITIES] = ["X", "ΔY", "Δθ", "Y", "net turn"];

/// The values of a predicted cycle, in this order.
pub(crate) fn predicted(cycle: &PredictedCycle) -> [f64; QUANTITIES] {
    let PredictedCycle {
        x_m,
        y_m,
        rotation_rad,
        delta_y_m,
        delta_theta_rad,
    } = *cycle;
    [x_m, delta_y_m, delta_theta_rad, y_m, rotation_rad]
}

/// Measured values of a run's cycles, in the order of the quantities.
pub(crate) fn measured(cycles: &Cycles) -> [Statistics; QUANTITIES] {
    let Cycles {
        x,
        y,
        rotation,
        delta_y,
        delta_theta,
        ..
    } = cycles;
    [*x, *delta_y, *delta_theta, *y, *rotation]
}
