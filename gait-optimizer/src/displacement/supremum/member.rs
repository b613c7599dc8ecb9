//! A gait of the sequence that grows towards a supremum.

use nalgebra::Vector2;
use swimmer_files::{Bounds, GaitFile, SwimmerHash};
use swimmer_model::{Model, Swimmer};

use crate::cycle::{Cycle, Samples};
use crate::displacement::DisplacementProblem;

/// A gait that carries farther than every local optimum found, and is none.
#[derive(Debug, Clone, PartialEq)]
pub struct Member {
    /// Between parts of the quarter that would touch \[rad\].
    pub gap: f64,
    /// X over L of the cycle, signed, as the model swims it.
    pub displacement_over_length: f64,
    /// Share of the cycle in which links cross.
    pub links_cross: f64,
    /// Joint angles at the corners of the quarter, from φ₁ = φ₂ to φ₁ = −φ₂ \[rad\].
    pub quarter: Vec<Vector2<f64>>,
    swimmer: Swimmer<f64>,
    bounds: Bounds,
    cycle: Cycle,
}

impl Member {
    /// |X| over L.
    pub(super) fn carried(&self) -> f64 {
        self.displacement_over_length.abs()
    }

    /// The cycle of a quarter, at constant power, swum by the model; none where it cannot be.
    pub(super) fn new(
        problem: &DisplacementProblem,
        model: &Model<f64>,
        corners: &[Vector2<f64>],
        gap: f64,
    ) -> Option<Self> {
        let mut quarter = corners.to_vec();
        quarter.dedup_by(|a, b| (*a - *b).norm() < 1e-12);
        let mut along = vec![0.0];
        for [from, to] in quarter.array_windows() {
            let way = to - from;
            let (_, power) = model.connection_and_power(&((from + to) * 0.5));
            let length = way.dot(&(power * way)).max(0.0).sqrt();
            along.push(along.last()? + length);
        }
        let samples = Samples {
            corners: (1..quarter.len().checked_sub(1)?).collect(),
            phi: quarter.clone(),
            along,
            arcs: Vec::new(),
        };
        let cycle = samples.unfolded([false; 2]);
        let stroke = cycle.swum(model)?;
        Some(Self {
            gap,
            displacement_over_length: stroke.displacement_over_length().x,
            links_cross: cycle.links_cross(model),
            quarter,
            swimmer: problem.swimmer,
            bounds: problem.bounds,
            cycle,
        })
    }

    /// As a gait of a problem with wider bounds.
    pub(super) fn of(&self, problem: &DisplacementProblem) -> Self {
        Self {
            bounds: problem.bounds,
            ..self.clone()
        }
    }

    /// What a gait file holds of it: a gait within the bounds, for no objective. `swimmer_name` is for people.
    pub fn gait_file(&self, swimmer_name: &str) -> GaitFile {
        GaitFile {
            swimmer_name: Some(swimmer_name.to_owned()),
            swimmer_hash: Some(SwimmerHash::of(&self.swimmer)),
            ..self.cycle.file(self.bounds)
        }
    }
}
