//! Torque, power and Reynolds number of a gait in the fluid of the swimmer file.

use forecast::{Demand, demand};
use link_protocol::Joint;
use serde::Serialize;
use swimmer_files::{AnyGait, JointName, SwimmerFile};
use swimmer_model::Model;

use crate::text::small;

/// Largest Reynolds number at which the model, which has no inertia, holds.
const LARGEST_REYNOLDS: f64 = 0.1;

/// Load of one cycle in the fluid, as the gait is parametrised.
#[derive(Debug, Clone, Serialize)]
#[cfg_attr(feature = "schema", derive(schemars::JsonSchema))]
pub struct FluidLoad {
    /// Duration of the cycle \[s\].
    pub period_s: f64,
    /// Mean power \[W\].
    pub power_w: f64,
    /// Largest power \[W\].
    pub peak_power_w: f64,
    /// Largest torque of each joint against the fluid alone \[N m\].
    pub torque_n_m: [f64; 2],
    /// Torque of the servos \[N m\], if the file names it.
    #[serde(skip_serializing_if = "Option::is_none")]
    pub servo_torque_n_m: Option<f64>,
    /// Reynolds number of the fastest side link, from its tip's speed relative to its joint, its length and the kinematic viscosity.
    pub reynolds: f64,
}

impl FluidLoad {
    /// Load of a cycle of `period` seconds. Returns `None` if the file names no fluid.
    pub fn new(
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

    /// Warnings: a Reynolds number at which the model does not hold, and joints that need more torque than their servo has. A passive
    /// joint has no servo.
    pub fn warnings(&self, passive: Option<Joint>) -> Vec<String> {
        let mut warnings = Vec::new();
        if self.reynolds > LARGEST_REYNOLDS {
            warnings.push(format!(
                "warning: the Reynolds number is {:.2} at {} s a cycle, and the model has no inertia: it holds below {LARGEST_REYNOLDS}; a period of {:.0} s would do",
                self.reynolds,
                self.period_s,
                (self.period_s * self.reynolds / LARGEST_REYNOLDS).ceil()
            ));
        }
        for (joint, torque) in [Joint::Front, Joint::Back].into_iter().zip(self.torque_n_m) {
            if passive == Some(joint) {
                continue;
            }
            let joint = JointName(joint);
            if let Some(has) = self.servo_torque_n_m.filter(|has| torque > *has) {
                warnings.push(format!(
                    "warning: the {joint} joint needs {} and its servo has {} ([servo] torque_n_m): the robot lags behind this gait at {} s a cycle",
                    newton_metres(torque),
                    newton_metres(has),
                    self.period_s
                ));
            }
        }
        warnings
    }
}

/// A torque \[N m\], printed in millinewton metres.
pub fn newton_metres(torque: f64) -> String {
    format!("{} mN m", small(torque * 1e3))
}
