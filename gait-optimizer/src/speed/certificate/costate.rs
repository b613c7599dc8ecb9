//! The conditions of a fastest gait whose servos keep within any limits, from its curve alone.
//!
//! With V = |d|/T, the costate of Φ is σ = V Σ αⱼ ∂Gⱼ/∂Φ̇ over the limits Gⱼ that bind, and
//! σ̇ = h (−Φ̇₂, Φ̇₁) + V Σ αⱼ ∂Gⱼ/∂Φ, less η∇(margin) along a bound and, at once, ν∇(margin) where a corner rests on one. The shares α and
//! the pushes η, ν must not be negative, and Σα = 1: H = σ·Φ̇ − V vanishes. All of them follow from the curve by least squares,
//! with the multiplier of rotation; nothing of the search is asked.

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_files::AnyGait;
use swimmer_model::{Gait as _, Model, Panel, SecondDerivatives};

use super::RESTS;
use super::legs::pose_at;
use crate::certificate::{Check, Condition};
use crate::momentum::Momentum;
use crate::region::{Bound, Region};
use crate::speed::gauge::{Facet, Level};
use crate::speed::quadrature::Rule;

/// Multipliers below 0 by more are held there.
const BELOW: f64 = 1e-6;
/// Times that multipliers below 0 are held there.
const SIGNS: usize = 6;

/// One node.
pub(super) struct Node {
    pub(super) rate: Vector2<f64>,
    pub(super) pose: [f64; 3],
    pub(super) second: SecondDerivatives<f64>,
    /// Height over V for p along d, and for a unit of the multiplier of rotation.
    height: [f64; 2],
    /// The largest share of any limit, and the limits that bind.
    taken: f64,
    pub(super) levels: Vec<Level>,
    /// Gradient of the margin of the bound that it lies on.
    bound: Option<Vector2<f64>>,
}

/// The equations, row by row, in unknowns that are added as they come.
#[derive(Default)]
struct Equations {
    rows: Vec<(Vec<(usize, f64)>, f64)>,
    unknowns: usize,
}

impl Equations {
    fn unknown(&mut self) -> usize {
        self.unknowns += 1;
        self.unknowns - 1
    }

    /// The unknowns of the least squares, and the largest residual. Those of which the sign is known stay near 1 where the
    /// equations leave them free; where they come out below 0 all the same, they are held at 0.
    fn solve(mut self, positive: &[usize]) -> Option<(DVector<f64>, f64)> {
        let mut solution = self.least_squares(positive)?;
        for _ in 0..SIGNS {
            let below = positive.iter().filter(|at| solution.0[**at] < -BELOW);
            let below: Vec<usize> = below.copied().collect();
            if below.is_empty() {
                break;
            }
            self.rows
                .extend(below.into_iter().map(|at| (vec![(at, 1.0)], 0.0)));
            solution = self.least_squares(positive)?;
        }
        Some(solution)
    }

    fn least_squares(&self, positive: &[usize]) -> Option<(DVector<f64>, f64)> {
        let mut normal = DMatrix::zeros(self.unknowns, self.unknowns);
        let residual = |x: &DVector<f64>| -> Vec<f64> {
            let left = |row: &[(usize, f64)]| row.iter().map(|(at, a)| a * x[*at]).sum::<f64>();
            let rows = self.rows.iter();
            rows.map(|(row, right)| right - left(row)).collect()
        };
        for (row, _) in &self.rows {
            for &(i, a) in row {
                for &(j, b) in row {
                    normal[(i, j)] += a * b;
                }
            }
        }
        let mut x = DVector::zeros(self.unknowns);
        for i in 0..self.unknowns {
            normal[(i, i)] += 1e-11;
        }
        for &at in positive {
            x[at] = 1.0;
        }
        let factors = normal.cholesky()?;
        for _ in 0..3 {
            let mut right = DVector::zeros(self.unknowns);
            for ((row, _), rest) in self.rows.iter().zip(residual(&x)) {
                for &(i, a) in row {
                    right[i] += a * rest;
                }
            }
            x += factors.solve(&right);
        }
        let worst = residual(&x)
            .iter()
            .fold(0.0, |most: f64, r| most.max(r.abs()));
        Some((x, worst))
    }
}

/// What the equations tell: a multiplier for each limit that binds at a node, node by node of each part, and that of the rotation.
pub(super) struct Multipliers {
    pub(super) nodes: Vec<Vec<Node>>,
    pub(super) shares: Vec<Vec<Vec<f64>>>,
    pub(super) rotation: f64,
}

/// A cycle whose costate is asked for.
pub(super) struct Costate<'a> {
    pub(super) model: &'a Model<f64>,
    pub(super) region: &'a Region,
    pub(super) limits: &'a [Facet],
    pub(super) gait: &'a AnyGait,
    pub(super) panels: Vec<Panel<f64>>,
    pub(super) period: f64,
    /// Dual to the displacement, over V; and 1/V.
    pub(super) p: Vector2<f64>,
    pub(super) slowness: f64,
    pub(super) rule: Rule,
}

/// What the equations' unknowns are.
#[derive(Default)]
struct Unknowns {
    rotation: usize,
    /// σ where each part begins.
    starts: Vec<[usize; 2]>,
    /// Of each part's nodes the shares of their limits.
    shares: Vec<Vec<Vec<usize>>>,
    /// Of bounds.
    pushes: Vec<usize>,
}

impl Costate<'_> {
    fn node(&self, u: f64) -> Node {
        let point = self.gait.at(u);
        let rate = point.rate / self.period;
        let pose = pose_at(&self.panels, u);
        let second = self.model.second_derivatives(&point.phi);
        let height = |p, c| Momentum { p, c }.height(&second, &pose).value;
        let levels = self.limits.iter().map(|limit| limit.level(&second, &rate));
        let levels: Vec<Level> = levels.collect();
        Node {
            rate,
            pose,
            second,
            height: [height(self.p, 0.0), height(Vector2::zeros(), self.slowness)],
            taken: levels.iter().map(|level| level.value).fold(0.0, f64::max),
            levels: levels
                .into_iter()
                .filter(|level| level.value >= Condition::TakesLimit.tolerance())
                .collect(),
            bound: self.rests(&point.phi).next().map(|(_, gradient)| gradient),
        }
    }

    /// The bounds that a shape lies on, with the gradients of their margins.
    pub(super) fn rests(&self, phi: &Vector2<f64>) -> impl Iterator<Item = (Bound, Vector2<f64>)> {
        let on = self.region.bounds();
        let on = on.filter(move |bound| bound.margin(phi).abs() < RESTS);
        on.map(move |bound| (bound, bound.gradient(phi)))
    }

    /// The equations of one part of the cycle, with those that join it to the next.
    fn part(
        &self,
        (number, (from, to)): (usize, (f64, f64)),
        nodes: &[Node],
        (equations, unknowns): (&mut Equations, &mut Unknowns),
    ) {
        let time = (to - from) * self.period;
        let mut own = Vec::with_capacity(nodes.len());
        for node in nodes {
            let shares: Vec<usize> = node.levels.iter().map(|_| equations.unknown()).collect();
            let push = node.bound.map(|_| equations.unknown());
            let sum = shares.iter().map(|at| (*at, 1.0)).collect();
            equations.rows.push((sum, 1.0));
            unknowns.pushes.extend(push);
            own.push((shares, push));
        }
        let shares = own.iter().map(|(shares, _)| shares.clone());
        unknowns.shares.push(shares.collect());
        let rotation = unknowns.rotation;
        // ∫ of one joint's σ̇ with these weights: its entries, and what is known of it.
        let integral = |weights: &[f64], joint: usize| {
            let mut row = Vec::new();
            let mut known = 0.0;
            for ((node, (shares, push)), weight) in nodes.iter().zip(&own).zip(weights) {
                let weight = weight * time;
                let turned = [-node.rate.y, node.rate.x][joint];
                known += weight * node.height[0] * turned;
                row.push((rotation, weight * node.height[1] * turned));
                for (level, at) in node.levels.iter().zip(shares) {
                    row.push((*at, weight * level.slope[joint]));
                }
                if let (Some(gradient), Some(at)) = (node.bound, push) {
                    row.push((*at, -weight * gradient[joint]));
                }
            }
            (row, known)
        };
        let start = unknowns.starts[number];
        for (node, (weights, (shares, _))) in
            nodes.iter().zip(self.rule.cumulative.iter().zip(&own))
        {
            for (joint, &begun) in start.iter().enumerate() {
                let (mut row, known) = integral(weights, joint);
                row.push((begun, 1.0));
                for (level, at) in node.levels.iter().zip(shares) {
                    row.push((*at, -level.slope[2 + joint]));
                }
                equations.rows.push((row, -known));
            }
        }
        // On to the next part, past what its first corner rests on.
        let next = unknowns.starts[(number + 1) % unknowns.starts.len()];
        let corner = self.gait.at(to).phi;
        let rests = self.rests(&corner).map(|(_, gradient)| gradient);
        let rests: Vec<Vector2<f64>> = rests.collect();
        let jumps: Vec<usize> = rests.iter().map(|_| equations.unknown()).collect();
        for joint in 0..2 {
            let (mut row, known) = integral(&self.rule.weights, joint);
            row.push((start[joint], 1.0));
            row.push((next[joint], -1.0));
            let jumps = rests.iter().zip(&jumps);
            row.extend(jumps.map(|(gradient, at)| (*at, -gradient[joint])));
            equations.rows.push((row, -known));
        }
        unknowns.pushes.extend(jumps);
    }

    /// The conditions of limits, costate and multipliers, part by part of the cycle; and the multipliers where the equations
    /// tell them.
    pub(super) fn checks(&self, parts: &[(f64, f64)]) -> (Vec<Check>, Option<Multipliers>) {
        let mut equations = Equations::default();
        let mut unknowns = Unknowns {
            rotation: equations.unknown(),
            ..Unknowns::default()
        };
        let starts = parts.iter();
        let starts = starts.map(|_| [equations.unknown(), equations.unknown()]);
        unknowns.starts = starts.collect();
        let (mut most, mut least) = (0.0_f64, f64::INFINITY);
        let mut nodes = Vec::with_capacity(parts.len());
        for (number, &(from, to)) in parts.iter().enumerate() {
            let places = self.rule.nodes.iter().map(|s| from + (to - from) * s);
            let own: Vec<Node> = places.map(|u| self.node(u)).collect();
            for node in &own {
                (most, least) = (most.max(node.taken), least.min(node.taken));
            }
            let into = (&mut equations, &mut unknowns);
            self.part((number, (from, to)), &own, into);
            nodes.push(own);
        }
        let mut checks = vec![
            Condition::KeepsLimits.check(most - 1.0),
            Condition::TakesLimit.check(least),
        ];
        if least < Condition::TakesLimit.tolerance() {
            // Nothing tells the costate where no limit binds.
            return (checks, None);
        }
        let Unknowns {
            shares,
            pushes,
            rotation,
            ..
        } = unknowns;
        let of_nodes = || shares.iter().flatten();
        let positive = of_nodes().flatten().chain(&pushes).copied();
        let positive: Vec<usize> = positive.collect();
        let Some((x, residual)) = equations.solve(&positive) else {
            checks.push(Condition::CostateWithinLimits.check(f64::NAN));
            return (checks, None);
        };
        let off = |own: &Vec<usize>| (own.iter().map(|at| x[*at]).sum::<f64>() - 1.0).abs();
        let hamiltonian = of_nodes().map(off).fold(0.0, f64::max);
        let least = |least: f64, at: &usize| least.min(x[*at]);
        let share = of_nodes().flatten().fold(f64::INFINITY, least);
        checks.extend([
            Condition::CostateWithinLimits.check(residual),
            Condition::HamiltonianWithinLimits.check(hamiltonian),
            Condition::LimitMultiplier.check(share),
        ]);
        if !pushes.is_empty() {
            let push = pushes.iter().fold(f64::INFINITY, least);
            checks.push(Condition::BoundWithinLimits.check(push));
        }
        let value = |at: &usize| x[*at];
        let of_node = |own: &Vec<usize>| own.iter().map(value).collect();
        let multipliers = Multipliers {
            nodes,
            rotation: x[rotation],
            shares: (shares.iter().map(|part| part.iter().map(of_node).collect())).collect(),
        };
        (checks, Some(multipliers))
    }
}
