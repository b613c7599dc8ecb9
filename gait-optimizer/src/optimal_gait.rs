//! What an optimisation returns: the gait, its numbers and its proof.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, ArcKind, Bounds, GaitArc, GaitFile, Objective, SwimmerHash};
use swimmer_model::{InvalidSamples, Swimmer};

use crate::Certificate;
use crate::cycle::Cycle;

/// One arc of the quarter gait from φ₁ = φ₂ > 0 to φ₁ = −φ₂.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Arc {
    /// What it runs along.
    pub kind: ArcKind,
    /// Joint angles where it starts \[rad\].
    pub from: [f64; 2],
    /// Joint angles where it ends \[rad\].
    pub to: [f64; 2],
}

/// An optimal gait with its certificate.
#[derive(Debug, Clone, PartialEq)]
pub struct OptimalGait {
    /// What it is optimal for.
    pub objective: Objective,
    /// Whose gait it is.
    pub swimmer: Swimmer<f64>,
    /// The bounds it obeys.
    pub bounds: Bounds,
    /// Net displacement X of a full counter-clockwise cycle over L, signed.
    pub displacement_over_length: f64,
    /// The same in metres.
    pub displacement: f64,
    /// φ₁ = φ₂ at t₀ \[rad\].
    pub start_angle: f64,
    /// φ₂ = −φ₁ at `t_f` \[rad\].
    pub end_angle: f64,
    /// The arcs of the quarter, in order.
    pub arcs: Vec<Arc>,
    /// Share of the cycle, as timed at constant power, with crossing links.
    pub links_cross: f64,
    /// The necessary conditions, each with its number.
    pub certificate: Certificate,
    pub(crate) cycle: Cycle,
}

impl OptimalGait {
    /// Fractions of the period of the samples, 0 to 1, at constant power.
    pub fn u(&self) -> &[f64] {
        &self.cycle.u
    }

    /// Joint angles \[rad\] at each `u`; the last is the first again.
    pub fn phi(&self) -> &[Vector2<f64>] {
        &self.cycle.phi
    }

    /// Fractions of the period where the direction in the (φ₁, φ₂) plane jumps.
    pub fn corners(&self) -> &[f64] {
        &self.cycle.corners
    }

    /// The arcs of the whole cycle.
    pub fn cycle_arcs(&self) -> &[GaitArc] {
        &self.cycle.arcs
    }

    /// The samples as a gait that can be swum.
    ///
    /// # Errors
    /// Never for a gait that this crate made; see [`AnyGait::from_file`].
    pub fn gait(&self) -> Result<AnyGait, InvalidSamples> {
        self.cycle.gait()
    }

    /// What a gait file holds of it; `swimmer_name` is for people.
    pub fn gait_file(&self, swimmer_name: &str) -> GaitFile {
        GaitFile {
            objective: self.objective,
            swimmer_name: Some(swimmer_name.to_owned()),
            swimmer_hash: Some(SwimmerHash::of(&self.swimmer)),
            bounds: self.bounds,
            arcs: self.cycle.arcs.clone(),
            corners: self.cycle.corners.clone(),
            u: self.cycle.u.clone(),
            phi: self.cycle.phi.clone(),
        }
    }
}
