//! Options of a passive joint: the joint and its spring.

use operations::passive::{Options, Response};
use swimmer_files::{JointName, Spring};

use crate::arguments::{seconds, stiffness};
use crate::quantity::{self, Rows};

/// A passive joint on the command line.
#[derive(Debug, Clone, Copy, clap::Args)]
pub(crate) struct PassiveOptions {
    /// This joint has a spring in place of its servo, and follows the other joint in its limit cycle. The swimmer file may say so
    /// instead, as [passive]
    #[arg(long, value_name = "front|back")]
    passive: Option<JointName>,
    /// Stiffness of the spring, N m/rad; it needs the viscosity of the swimmer file's [fluid]
    #[arg(long, value_name = "K", value_parser = stiffness, conflicts_with = "relaxation")]
    stiffness: Option<f64>,
    /// Relaxation time of the passive joint on the straight swimmer, in place of a stiffness
    #[arg(long, value_name = "SECONDS", value_parser = seconds)]
    relaxation: Option<f64>,
}

impl PassiveOptions {
    /// Options of the operation.
    pub(crate) fn options(self) -> Options {
        let stiffness = self.stiffness.map(Spring::Stiffness);
        Options {
            joint: self.passive,
            spring: stiffness.or(self.relaxation.map(Spring::Relaxation)),
        }
    }
}

/// Adds the limit cycle of a passive joint.
pub(crate) fn passive_row(response: &Response, rows: &mut Rows) {
    rows.row(
        "passive joint",
        format!(
            "{}, starts at {}, relaxes in {:.4} of the period",
            JointName(response.passive.joint),
            quantity::angle(response.start),
            response.relaxation_share
        ),
    );
}
