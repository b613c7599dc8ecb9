//! Text rows of a gait's load in the fluid of the swimmer file.

use operations::fluid::{FluidLoad, newton_metres};

use crate::quantity::{self, Rows};

/// Adds torque, power and Reynolds number.
pub(crate) fn fluid_rows(load: &FluidLoad, rows: &mut Rows) {
    let [front, back] = load.torque_n_m.map(newton_metres);
    let has = load
        .servo_torque_n_m
        .map_or_else(String::new, |has| format!(" of {}", newton_metres(has)));
    rows.row(
        "torque",
        format!(
            "{front} front, {back} back{has} at {} s a cycle",
            load.period_s
        ),
    )
    .row(
        "power",
        format!(
            "{} mW, {} mW at most",
            quantity::small(load.power_w * 1e3),
            quantity::small(load.peak_power_w * 1e3)
        ),
    )
    .row("Reynolds number", quantity::small(load.reynolds));
}
