//! Torsion spring of a passive joint, and its dimensionless form over one cycle.

use link_protocol::Joint;
use nalgebra::{Matrix2, Vector2};
use swimmer_files::{Fluid, Spring};
use swimmer_model::Model;

use crate::PassiveError;
use crate::gauss::{NODES, Step};

/// k/μ of a spring at a joint \[m³/s\].
///
/// # Errors
/// A medium without viscosity, a stiffness without a fluid, or a value that is not positive and finite.
pub fn over_viscosity(
    spring: Spring,
    model: &Model<f64>,
    joint: Joint,
    fluid: Option<&Fluid>,
) -> Result<f64, PassiveError> {
    if !model.swimmer().is_viscous() {
        return Err(PassiveError::NotViscous);
    }
    let (name, value) = match spring {
        Spring::Stiffness(stiffness) => ("stiffness of the spring [N m/rad]", stiffness),
        Spring::Relaxation(time) => ("relaxation time of the joint [s]", time),
    };
    if !(value > 0.0 && value.is_finite()) {
        return Err(PassiveError::Bound { name, value });
    }
    match spring {
        Spring::Stiffness(stiffness) => {
            let fluid = fluid.ok_or(PassiveError::NeedsFluid)?;
            Ok(stiffness / fluid.viscosity())
        }
        Spring::Relaxation(time) => Ok(straight_resistance(model, joint) / time),
    }
}

/// W_pp(0): resistance of a joint of the straight swimmer while the other joint is held \[m³\].
pub(crate) fn straight_resistance(model: &Model<f64>, joint: Joint) -> f64 {
    let index = joint.index();
    model.power_matrix(&Vector2::zeros())[(index, index)]
}

/// A passive joint with its spring over one cycle.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct PassiveJoint {
    /// The passive joint; the other one is driven.
    pub joint: Joint,
    /// κ = k T/μ \[m³\].
    pub kappa: f64,
}

impl PassiveJoint {
    /// A passive joint with κ = k T/μ \[m³\].
    ///
    /// # Errors
    /// κ is not positive and finite.
    pub fn new(joint: Joint, kappa: f64) -> Result<Self, PassiveError> {
        if kappa > 0.0 && kappa.is_finite() {
            Ok(Self { joint, kappa })
        } else {
            Err(PassiveError::Spring { kappa })
        }
    }

    /// A passive joint with a relaxation time that is this share of the period: κ = W_pp(0)/share.
    ///
    /// # Errors
    /// The share is not positive and finite.
    pub fn relaxing_in(model: &Model<f64>, joint: Joint, share: f64) -> Result<Self, PassiveError> {
        Self::new(joint, straight_resistance(model, joint) / share)
    }

    /// Relaxation time as a share of the period, W_pp(0)/κ.
    pub fn relaxation_share(&self, model: &Model<f64>) -> f64 {
        straight_resistance(model, self.joint) / self.kappa
    }

    /// Passive angle \[rad\] after the driven joint turned from one angle to another at a constant rate; κ is that of this piece.
    /// Returns `None` if the step does not converge.
    pub fn follow(&self, model: &Model<f64>, [from, to]: [f64; 2], angle: f64) -> Option<f64> {
        let way = to - from;
        let drive = NODES.map(|node| [from + way * node, way]);
        Step::new(model, self, &drive, angle, 1.0).map(|step| step.end)
    }

    /// φ_p′ from W, φ_d′ and φ_p: the spring balances the drag of the joint.
    pub(crate) fn rate(&self, power: &Matrix2<f64>, driven_rate: f64, angle: f64) -> f64 {
        let (p, d) = (self.joint.index(), self.driven().index());
        -(self.kappa * angle + power[(p, d)] * driven_rate) / power[(p, p)]
    }

    /// The driven joint.
    pub fn driven(&self) -> Joint {
        match self.joint {
            Joint::Front => Joint::Back,
            Joint::Back => Joint::Front,
        }
    }

    /// Shape with these angles of the driven and the passive joint \[rad\].
    pub fn shape(&self, driven: f64, passive: f64) -> Vector2<f64> {
        match self.joint {
            Joint::Front => Vector2::new(passive, driven),
            Joint::Back => Vector2::new(driven, passive),
        }
    }
}
