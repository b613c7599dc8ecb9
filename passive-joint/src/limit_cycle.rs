//! Limit cycle: the periodic response of the passive joint, a fixed point of one cycle by Newton's method.
//!
//! The derivative of the map over one cycle is the product of the derivatives of its steps (variational equation, in closed form), and
//! at the solution it is the Floquet multiplier of the limit cycle.

use nalgebra::Vector2;
use swimmer_files::{GaitFile, GaitSpring, JointName};
use swimmer_model::{Gait, GaitPoint, Model};

use crate::fixed_point::{CycleEnd, fixed_point};
use crate::gauss::{Drive, NODES, Step};
use crate::{PassiveError, PassiveJoint};

/// Steps of a cycle, at least.
const STEPS: usize = 512;
/// Fewest steps of a smooth piece.
const FEWEST_STEPS: usize = 2;

/// Limit cycle of a passive joint while the other joint follows a gait. It is a gait itself.
#[derive(Debug, Clone)]
pub struct LimitCycle<'a, G> {
    model: &'a Model<f64>,
    drive: &'a G,
    passive: PassiveJoint,
    /// Borders of the steps in u, and the passive angle there.
    nodes: Vec<Node>,
    multiplier: f64,
}

#[derive(Debug, Clone, Copy)]
struct Node {
    u: f64,
    angle: f64,
}

impl<'a, G: Gait<f64>> LimitCycle<'a, G> {
    /// Response to the driven joint of `drive`; its other joint is ignored.
    ///
    /// # Errors
    /// [`PassiveError::NotConverged`] without a periodic motion, [`PassiveError::Unstable`] if disturbances grow.
    pub fn new(
        model: &'a Model<f64>,
        drive: &'a G,
        passive: PassiveJoint,
    ) -> Result<Self, PassiveError> {
        let mut cycle = Self {
            model,
            drive,
            passive,
            nodes: borders(drive).map(|u| Node { u, angle: 0.0 }).collect(),
            multiplier: 0.0,
        };
        let (_, multiplier) = fixed_point(|start| cycle.run(start))?;
        cycle.multiplier = multiplier;
        Ok(cycle)
    }

    /// Follows one cycle from a passive angle. Returns `None` if a step does not converge.
    fn run(&mut self, start: f64) -> Option<CycleEnd> {
        let (mut angle, mut growth) = (start, 1.0);
        for index in 0..self.nodes.len() {
            let from = self.nodes[index].u;
            self.nodes[index].angle = angle;
            if let Some(to) = self.nodes.get(index + 1).map(|node| node.u) {
                let step = self.step(from, to - from, angle)?;
                angle = step.end;
                growth *= step.growth;
            }
        }
        Some(CycleEnd { angle, growth })
    }

    fn step(&self, from: f64, length: f64, angle: f64) -> Option<Step> {
        let driven = self.passive.driven().index();
        let drive: Drive = NODES.map(|node| {
            let point = self.drive.at(from + length * node);
            [point.phi[driven], point.rate[driven]]
        });
        Step::new(self.model, &self.passive, &drive, angle, length)
    }

    /// Passive angle at u = 0 \[rad\].
    pub fn start(&self) -> f64 {
        self.nodes.first().map_or(0.0, |node| node.angle)
    }

    /// Shapes at the borders of the integration steps, in order; the last equals the first.
    pub fn shapes(&self) -> impl Iterator<Item = Vector2<f64>> {
        let driven = self.passive.driven().index();
        self.nodes.iter().map(move |node| {
            let angle = self.drive.at(node.u).phi[driven];
            self.passive.shape(angle, node.angle)
        })
    }

    /// Floquet multiplier: factor of a small disturbance after one cycle.
    pub fn multiplier(&self) -> f64 {
        self.multiplier
    }

    /// The passive joint.
    pub fn passive(&self) -> PassiveJoint {
        self.passive
    }

    /// The cycle as samples that name the passive joint, at least `samples` of them.
    pub fn gait_file(&self, samples: usize) -> GaitFile {
        GaitFile {
            passive: Some(GaitSpring {
                joint: JointName(self.passive.joint),
                relaxation: self.passive.relaxation_share(self.model),
            }),
            ..GaitFile::sampled(self, samples)
        }
    }
}

/// Borders of the steps: each smooth piece is cut evenly.
fn borders<G: Gait<f64>>(drive: &G) -> impl Iterator<Item = f64> {
    let pieces = drive.pieces().max(1);
    let ends: Vec<f64> = (0..pieces)
        .map(|piece| {
            if piece + 1 == pieces {
                1.0
            } else {
                drive.piece_end(piece)
            }
        })
        .collect();
    let starts = std::iter::once(0.0).chain(ends.clone());
    starts
        .zip(ends)
        .filter(|(from, to)| to > from)
        .flat_map(|(from, to)| {
            #[allow(
                clippy::cast_possible_truncation,
                clippy::cast_sign_loss,
                reason = "a share of the steps"
            )]
            let steps = (((to - from) * STEPS as f64).ceil() as usize).max(FEWEST_STEPS);
            (0..steps).map(move |k| from + (to - from) * k as f64 / steps as f64)
        })
        .chain(std::iter::once(1.0))
}

impl<G: Gait<f64>> Gait<f64> for LimitCycle<'_, G> {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let u = u - u.floor();
        let after = self.nodes.partition_point(|node| node.u <= u);
        let node = self.nodes[after.clamp(1, self.nodes.len()) - 1];
        let driven = self.passive.driven().index();
        let drive = self.drive.at(u);
        let length = u - node.u;
        // The step to the next node converged, and this one is shorter.
        let angle = if length > 0.0 {
            self.step(node.u, length, node.angle)
                .map_or(node.angle, |step| step.end)
        } else {
            node.angle
        };
        let (phi, rate) = (drive.phi[driven], drive.rate[driven]);
        let shape = self.passive.shape(phi, angle);
        let power = self.model.power_matrix(&shape);
        let passive_rate = self.passive.rate(&power, rate, angle);
        let rates: Vector2<f64> = self.passive.shape(rate, passive_rate);
        GaitPoint {
            phi: shape,
            rate: rates,
        }
    }

    fn pieces(&self) -> usize {
        self.drive.pieces()
    }

    fn piece_end(&self, i: usize) -> f64 {
        self.drive.piece_end(i)
    }

    fn corner_at_end(&self, i: usize) -> bool {
        self.drive.corner_at_end(i)
    }
}
