//! What a gait asks of the servos in the fluid of the swimmer file: torque, power, and whether inertia is small indeed.

use forecast::{Demand, demand};
use serde::Serialize;
use swimmer_files::{AnyGait, SwimmerFile};
use swimmer_model::Model;

use crate::output::aside;
use crate::quantity::{self, Rows};

/// Above this Reynolds number the model's fluid, which has no inertia, is no longer the tank's.
const LARGEST_REYNOLDS: f64 = 0.1;

/// One cycle of this duration, as parametrised.
#[derive(Debug, Serialize)]
pub(crate) struct InFluid {
    period_s: f64,
    /// Mean over the cycle, and the largest.
    power_w: f64,
    peak_power_w: f64,
    /// The largest of each joint, against the fluid alone.
    torque_n_m: [f64; 2],
    /// What the servos have, where the file says so.
    #[serde(skip_serializing_if = "Option::is_none")]
    servo_torque_n_m: Option<f64>,
    /// Of the fastest side link: its tip's speed against its joint, its length and the kinematic viscosity.
    reynolds: f64,
}

impl InFluid {
    /// `None` where the file names no fluid.
    pub(crate) fn new(
        file: &SwimmerFile,
        model: &Model<f64>,
        gait: &AnyGait,
        period: f64,
    ) -> Option<Self> {
        let Demand {
            power,
            peak_power,
            torque,
            reynolds,
        } = demand(model, &file.fluid?, gait, period);
        Some(Self {
            period_s: period,
            power_w: power,
            peak_power_w: peak_power,
            torque_n_m: torque,
            servo_torque_n_m: file.servo.and_then(|servo| servo.torque),
            reynolds,
        })
    }

    /// Says what makes the answer doubtful.
    pub(crate) fn warn(&self) {
        if self.reynolds > LARGEST_REYNOLDS {
            aside(&format!(
                "warning: the Reynolds number is {:.2} at {} s a cycle, and the model has no inertia: it holds below {LARGEST_REYNOLDS}; a period of {:.0} s would do",
                self.reynolds,
                self.period_s,
                (self.period_s * self.reynolds / LARGEST_REYNOLDS).ceil()
            ));
        }
        for (joint, torque) in ["front", "back"].iter().zip(self.torque_n_m) {
            if let Some(has) = self.servo_torque_n_m.filter(|has| torque > *has) {
                aside(&format!(
                    "warning: the {joint} joint needs {} and its servo has {} ([servo] torque_n_m): the robot lags behind this gait at {} s a cycle",
                    newton_metres(torque),
                    newton_metres(has),
                    self.period_s
                ));
            }
        }
    }

    pub(crate) fn rows(&self, rows: &mut Rows) {
        let [front, back] = self.torque_n_m.map(newton_metres);
        let has = self
            .servo_torque_n_m
            .map_or_else(String::new, |has| format!(" of {}", newton_metres(has)));
        rows.row(
            "torque",
            format!(
                "{front} front, {back} back{has} at {} s a cycle",
                self.period_s
            ),
        )
        .row(
            "power",
            format!(
                "{} mW, {} mW at most",
                quantity::small(self.power_w * 1e3),
                quantity::small(self.peak_power_w * 1e3)
            ),
        )
        .row("Reynolds number", quantity::small(self.reynolds));
    }
}

fn newton_metres(torque: f64) -> String {
    format!("{} mN m", quantity::small(torque * 1e3))
}
