//! The switching functions of a cycle: multipliers by least squares, then every sign.
//!
//! Costates are over |d| and the time over the period, so that H ≡ 0 reads Ω₁|σ₁| + Ω₂|σ₂| = VT/|d| (+ κ(θ − θ̄) where the
//! heading is prescribed), Ωᵢ being the rates in radians a cycle; V = |d|/T, unless the period is prescribed. At a switch of σᵢ that is free to happen σᵢ = 0, which leaves no choice
//! of σ; a corner that rests on a bound lets σ jump along its normal and leaves one.

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_files::ArcKind;

use super::super::setting::{Goal, HeadingRule};
use super::affine::Affine;
use super::legs::{Leg, Legs, Node};
use super::{GaitRequirements, RESTS, on_bound};
use crate::certificate::{Check, Condition};
use crate::numerics::{lesser, worse};
use crate::region::{Bound, Region};

/// Columns of the least squares.
const ROTATION: usize = 0;
const HEADING: usize = 1;
const SPEED: usize = 2;

/// The bound that a place of an arc along one lies on, with its place in the region.
pub(super) fn along(region: &Region, node: &Node) -> Option<(usize, Bound)> {
    let across = |bound: &Bound| bound.gradient(&node.phi).normalize().dot(&node.rate).abs();
    region
        .bounds()
        .enumerate()
        .filter(|(_, bound)| bound.margin(&node.phi).abs() < 1e-6)
        .min_by(|(_, a), (_, b)| across(a).total_cmp(&across(b)))
}

/// Switching functions with the multipliers of the least-squares fit.
pub(crate) struct Switching<'a> {
    region: &'a Region,
    legs: &'a Legs,
    asked: GaitRequirements,
    /// σ₁ at both ends of each extreme leg.
    ends: Vec<Option<[Affine; 2]>>,
    solution: DVector<f64>,
    residual: f64,
    double_switches: usize,
}

impl<'a> Switching<'a> {
    pub(crate) fn new(region: &'a Region, legs: &'a Legs, asked: GaitRequirements) -> Self {
        let mut this = Self {
            region,
            legs,
            asked,
            ends: vec![None; legs.all.len()],
            solution: DVector::zeros(0),
            residual: 0.0,
            double_switches: 0,
        };
        let mut unknowns = 3;
        let mut rows: Vec<Affine> = Vec::new();
        let count = legs.all.len();
        for (k, leg) in legs.all.iter().enumerate() {
            if leg.kind != ArcKind::Extreme {
                continue;
            }
            let ends = [0, 1].map(|end| {
                let other = if end == 0 {
                    (k + count - 1) % count
                } else {
                    (k + 1) % count
                };
                this.sigma_at(leg, end, &legs.all[other], &mut unknowns)
            });
            // σ₁ at the end − σ₁ at the start − ∫σ₁′ = 0, as a share of its largest value.
            let mut row = ends[1].minus(&ends[0]);
            for node in leg.panels.iter().flatten() {
                row = row.minus(&this.slope(node, 0).times(node.weight));
            }
            rows.push(row.times(legs.rates[0]));
            this.ends[k] = Some(ends);
        }
        for k in 0..count {
            rows.extend(this.tangential_jump(k));
        }
        let rotates = asked.goal == Goal::Rotation;
        if rotates || asked.heading == HeadingRule::Any {
            rows.push(Affine {
                weights: vec![(HEADING, 1.0)],
                rest: 0.0,
            });
        }
        if rotates {
            rows.push(Affine {
                weights: vec![(ROTATION, 1.0)],
                rest: 0.0,
            });
        }
        if asked.period.is_none() {
            rows.push(Affine {
                weights: vec![(SPEED, 1.0)],
                rest: -1.0,
            });
        }
        if this.ends.iter().all(Option::is_none) {
            // Without a switch, the least height on the arcs determines the multipliers.
            for node in legs.all.iter().flat_map(|leg| leg.panels.iter().flatten()) {
                rows.push(this.height(node).times(node.weight.sqrt()));
            }
        }
        let mut matrix = DMatrix::zeros(rows.len(), unknowns);
        for (number, row) in rows.iter().enumerate() {
            for (column, weight) in &row.weights {
                matrix[(number, *column)] += weight;
            }
        }
        let right = DVector::from_fn(rows.len(), |number, _| -rows[number].rest);
        let solution = matrix.clone().svd(true, true).solve(&right, 1e-12);
        this.solution = solution.unwrap_or_else(|_| DVector::from_element(unknowns, f64::NAN));
        let rest = matrix * &this.solution - right;
        this.residual = rest.iter().map(|one| one.abs()).fold(0.0, worse);
        this
    }

    /// h over |d| at a node.
    fn height(&self, node: &Node) -> Affine {
        let v = self.legs.distance;
        Affine {
            weights: vec![
                (ROTATION, node.height[1] / v),
                (HEADING, node.height[2] / v),
            ],
            rest: node.height[0] / v,
        }
    }

    /// σᵢ′ away from bounds: h (−φ₂′, φ₁′), and where the heading is prescribed κ `A_θ`.
    fn slope(&self, node: &Node, joint: usize) -> Affine {
        let along = if joint == 0 {
            -node.rate.y
        } else {
            node.rate.x
        };
        let mut slope = self.height(node).times(along);
        slope.weights.push((HEADING, node.turn[joint]));
        slope
    }

    /// Ω₁|σ₁| + Ω₂|σ₂| at a heading, which follows from the constancy of H.
    fn speed(&self, theta: f64) -> Affine {
        Affine {
            weights: vec![(SPEED, 1.0), (HEADING, theta - self.legs.mean_theta)],
            rest: 0.0,
        }
    }

    /// σ₁ at one end of an extreme leg.
    fn sigma_at(&mut self, leg: &Leg, end: usize, other: &Leg, unknowns: &mut usize) -> Affine {
        let phi = if end == 0 { leg.from } else { leg.to };
        let full = self
            .speed(leg.theta_at(end))
            .times(leg.ways[0] / self.legs.rates[0]);
        let none = full.times(0.0);
        let mut free = self.normals(&phi);
        let joins = self.asked.joins(&phi);
        let known = if joins {
            None
        } else if other.kind == ArcKind::Extreme {
            match [0, 1].map(|i| (leg.ways[i] - other.ways[i]).abs() > 0.5) {
                [true, false] => Some(none),
                [false, true] => Some(full),
                [true, true] => {
                    if free.is_empty() {
                        self.double_switches += 1;
                    }
                    Some(none)
                }
                [false, false] => None,
            }
        } else {
            if on_bound(other) {
                let followed = self.normal_of(other);
                free.retain(|normal| followed.is_none_or(|own| (own - normal).norm() > 1e-3));
            }
            Some(if self.legs.pace(other) == 0 {
                full
            } else {
                none
            })
        };
        match known {
            Some(known) if free.is_empty() => known,
            _ => {
                *unknowns += 1;
                Affine {
                    weights: vec![(*unknowns - 1, 1.0)],
                    rest: 0.0,
                }
            }
        }
    }

    /// σ at one end of any leg.
    fn sigma(&self, k: usize, end: usize) -> [Affine; 2] {
        let leg = &self.legs.all[k];
        let speed = self.speed(leg.theta_at(end));
        let [rate1, rate2] = self.legs.rates;
        if let Some(ends) = &self.ends[k] {
            let one = ends[end].clone();
            let left = speed.minus(&one.times(leg.ways[0] * rate1));
            return [one, left.times(leg.ways[1] / rate2)];
        }
        let pace = self.legs.pace(leg);
        let full = speed.times(leg.ways[pace] / self.legs.rates[pace]);
        let none = full.times(0.0);
        if pace == 0 {
            [full, none]
        } else {
            [none, full]
        }
    }

    /// Jump of σ at the corner before a leg: after minus before.
    fn jump(&self, k: usize) -> [Affine; 2] {
        let count = self.legs.all.len();
        let (before, after) = (self.sigma((k + count - 1) % count, 1), self.sigma(k, 0));
        [after[0].minus(&before[0]), after[1].minus(&before[1])]
    }

    /// σ may jump along the normal of the one bound that a corner rests on, not across it.
    fn tangential_jump(&self, k: usize) -> Option<Affine> {
        let count = self.legs.all.len();
        self.ends[k]
            .as_ref()
            .or(self.ends[(k + count - 1) % count].as_ref())?;
        let normals = self.normals(&self.legs.all[k].from);
        let jump = self.jump(k);
        let scale = self.legs.rates[0].max(self.legs.rates[1]);
        match normals.as_slice() {
            [normal] => Some(
                jump[0]
                    .times(-normal.y)
                    .plus(&jump[1].times(normal.x))
                    .times(scale),
            ),
            _ => None,
        }
    }

    /// Outward unit normals of the bounds that a corner rests on.
    fn normals(&self, phi: &Vector2<f64>) -> Vec<Vector2<f64>> {
        self.region
            .bounds()
            .filter(|bound| bound.margin(phi).abs() < RESTS)
            .map(|bound| -bound.gradient(phi).normalize())
            .collect()
    }

    /// Outward normal halfway along a leg on a bound.
    fn normal_of(&self, leg: &Leg) -> Option<Vector2<f64>> {
        let node = leg.panels.get(leg.panels.len() / 2)?.first()?;
        self.normal_at(node)
    }

    fn normal_at(&self, node: &Node) -> Option<Vector2<f64>> {
        let (_, bound) = along(self.region, node)?;
        Some(-bound.gradient(&node.phi).normalize())
    }

    fn value(&self, affine: &Affine) -> f64 {
        affine
            .weights
            .iter()
            .fold(affine.rest, |sum, (at, weight)| {
                sum + weight * self.solution.get(*at).copied().unwrap_or(f64::NAN)
            })
    }

    pub(crate) fn checks(&self) -> Vec<Check> {
        let mut checks = vec![
            Condition::SwitchIntegrals.check(self.residual),
            Condition::SingleSwitches.check(self.double_switches as f64),
        ];
        let signs: Vec<f64> = (0..self.legs.all.len())
            .flat_map(|k| self.least_sign(k))
            .collect();
        let least = |values: &[f64]| values.iter().copied().fold(f64::INFINITY, lesser);
        if !signs.is_empty() {
            checks.push(Condition::SwitchingSigns.check(least(&signs)));
        }
        let scale = self.legs.rates[0].max(self.legs.rates[1]);
        let (mut off, mut clebsch, mut pushes) = (Vec::new(), Vec::new(), Vec::new());
        for leg in self
            .legs
            .all
            .iter()
            .filter(|leg| leg.kind != ArcKind::Extreme)
        {
            let pace = self.legs.pace(leg);
            for node in leg.panels.iter().flatten() {
                // The other servo is free within its rate, so its σ stays 0: by itself, or as the bound makes it.
                let slope = self.value(&self.slope(node, 1 - pace)) * scale;
                if on_bound(leg) {
                    let normal = self.normal_at(node).map_or(f64::NAN, |n| n[1 - pace]);
                    pushes.push(-slope / (normal * node.rate.norm()));
                } else {
                    off.push(-(slope / node.rate[pace]).abs());
                    clebsch.push(self.legendre_clebsch(leg, node));
                }
            }
        }
        if !off.is_empty() {
            checks.push(Condition::HeightOnSingular.check(-least(&off)));
            checks.push(Condition::GrowsInwards.check(least(&clebsch)));
        }
        if !pushes.is_empty() {
            checks.push(Condition::SpeedOnBound.check(least(&pushes)));
        }
        let jumps: Vec<f64> = (0..self.legs.all.len())
            .flat_map(|k| self.jump_signs(k))
            .collect();
        if !jumps.is_empty() {
            checks.push(Condition::SpeedAtContact.check(least(&jumps)));
        }
        if self.asked.period.is_some() {
            // A longer period never leads less far.
            let further = self.solution.get(SPEED).copied().unwrap_or(f64::NAN);
            checks.push(Condition::FurtherTime.check(further));
        }
        checks
    }

    /// Least margin by which σ₁ and σ₂ of an extreme leg keep their signs, over their largest value, at both ends and at every
    /// panel between.
    fn least_sign(&self, k: usize) -> Vec<f64> {
        let (Some(ends), leg) = (&self.ends[k], &self.legs.all[k]) else {
            return Vec::new();
        };
        let mut sigma = self.value(&ends[0]);
        let mut signs = Vec::with_capacity(2 * leg.panels.len() + 2);
        let mut say = |sigma: f64, theta: f64| {
            let share = leg.ways[0] * sigma * self.legs.rates[0];
            signs.push(share);
            signs.push(self.value(&self.speed(theta)) - share);
        };
        say(sigma, leg.theta_at(0));
        for (panel, theta) in leg.panels.iter().zip(&leg.theta[1..]) {
            for node in panel {
                sigma += node.weight * self.value(&self.slope(node, 0));
            }
            say(sigma, *theta);
        }
        signs
    }

    /// The generalised Legendre–Clebsch condition on a singular arc: positive where no wiggle of the free servo gains.
    fn legendre_clebsch(&self, leg: &Leg, node: &Node) -> f64 {
        let weight = |i: usize| self.solution.get(i).copied().unwrap_or(f64::NAN);
        let slope =
            node.slope[0] + node.slope[1] * weight(ROTATION) + node.slope[2] * weight(HEADING);
        let pace = self.legs.pace(leg);
        let free = 1 - pace;
        let sign = if free == 0 { -1.0 } else { 1.0 };
        let of_height = sign * slope[free] * node.rate[pace];
        (of_height + weight(HEADING) * self.legs.distance * node.turn_slope[free])
            / (slope.norm() * node.rate[pace].abs())
    }

    /// Multipliers of the bounds at the corner before a leg: they are positive if leaving the bound is worth more beyond the
    /// corner.
    fn jump_signs(&self, k: usize) -> Vec<f64> {
        let normals = self.normals(&self.legs.all[k].from);
        let jump = self.jump(k).map(|part| self.value(&part));
        let jump = Vector2::new(jump[0] * self.legs.rates[0], jump[1] * self.legs.rates[1]);
        normals.iter().map(|normal| normal.dot(&jump)).collect()
    }
}
