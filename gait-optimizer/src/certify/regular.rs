//! Necessary conditions of a gait of greatest efficiency (paper, section V).
//!
//! At constant power a gait extremises ln |d| − ln S, S = ∮√P. With |p| = S/|d| the costates are
//! λ = −Aᵀμ + W t (up to one common factor, t = Φ̇/√P): that is `H_u = 0`. Their equations then read
//! `(W t)˙ = ½ ∂(t·W t) − h (t₂, −t₁)` on free arcs, and the residual on a bound is its multiplier. The equations are evaluated in
//! their integrated form, which needs first derivatives only.

use nalgebra::Vector2;

use super::grid::Along;
use super::path::{CurveNode, Path};
use super::variation::Gain;
use super::{Degree, Openness, Subject};
use crate::certificate::{Check, Condition};
use crate::momentum::Momentum;
use crate::numerics::{lesser, worse};

impl Subject<'_> {
    /// All conditions of an efficiency optimum.
    pub(super) fn of_efficiency(&self, open: Openness) -> Vec<Check> {
        let path = &self.path;
        let d = path.displacement();
        if d.norm().is_nan() || d.norm() <= self.least_gain() {
            return vec![Condition::Gains.within(d.norm(), self.least_gain())];
        }
        let length = path.total_power_length();
        let powers = || path.places.iter().map(|place| place.root_power.powi(2));
        let (least, most) = powers().fold((f64::INFINITY, 0.0), |(least, most): (f64, f64), p| {
            (least.min(p), most.max(p))
        });
        let mut checks = vec![
            Condition::ConstantPower.open((most - least) / (length * length), 4.0 * open.slope),
            Condition::NoCorner.open(self.sharpest_corner(), 2.0 * open.slope),
        ];
        if self.symmetric {
            checks.push(Condition::EndsSquare.open(self.ends_off_square(), 2.0 * open.slope));
            checks.push(Condition::NoLateral.open(d.y.abs(), open.pose));
        }
        let momentum = self.effort_momentum();
        let fine = Balance::new(self, path, &momentum);
        // The coarser derivatives give the accuracy of the residual.
        let coarse = Balance::new(self, &self.coarse, &momentum);
        let unsure = fine.distance(&coarse);
        checks.extend(fine.checks(self, unsure));
        let definite = path.places.iter().map(|place| {
            let w = &place.first.power;
            w.determinant() / (w.trace() * w.trace())
        });
        checks.push(Condition::Legendre.check(definite.fold(f64::INFINITY, f64::min)));
        checks.extend(self.effort_multipliers(&momentum));
        checks.extend(self.ascents(Gain::Efficiency, momentum));
        checks
    }

    /// Multipliers: p = S d/|d|², and c from the free arcs.
    pub(super) fn effort_momentum(&self) -> Momentum {
        let d = self.path.displacement();
        let p = d * (self.path.total_power_length() / d.norm_squared());
        if self.symmetric {
            return Momentum {
                p,
                c: -p.x * self.y_at_the_quarter(),
            };
        }
        let without = Balance::new(self, &self.path, &Momentum { p, c: 0.0 });
        let with = Balance::new(self, &self.path, &Momentum { p, c: 1.0 });
        let (mut across, mut square) = (0.0, 0.0);
        for ((a, b), node) in without.left_over.iter().zip(&with.left_over).zip(0..) {
            if self.along(node) == Along::Free {
                let slope = b - a;
                across += a.dot(&slope);
                square += slope.dot(&slope);
            }
        }
        Momentum {
            p,
            c: if square > 0.0 { -across / square } else { 0.0 },
        }
    }

    /// Largest jump of the direction between pieces, except at corners of the forbidden shapes.
    fn sharpest_corner(&self) -> f64 {
        let rate = |node: usize| self.path.places.get(node).map(|place| place.rate);
        let pieces = &self.grid.pieces;
        pieces
            .iter()
            .zip(pieces.iter().cycle().skip(1))
            .filter(|(piece, next)| {
                !self.bent_round_a_corner(*piece.nodes.end(), *next.nodes.start())
            })
            .filter_map(|(piece, next)| {
                let (before, after) = (rate(*piece.nodes.end())?, rate(*next.nodes.start())?);
                Some(before.perp(&after).atan2(before.dot(&after)).abs())
            })
            .fold(0.0, worse)
    }

    /// Deviation from a right angle at the symmetry lines.
    fn ends_off_square(&self) -> f64 {
        let component = |pick: fn(&Vector2<f64>) -> f64| -> Vec<f64> {
            self.path
                .places
                .iter()
                .map(|place| pick(&place.rate))
                .collect()
        };
        let rates = [component(|rate| rate.x), component(|rate| rate.y)];
        let direction = |u: f64| {
            let [x, y] = &rates;
            let rate = Vector2::new(self.grid.interpolated(x, u), self.grid.interpolated(y, u));
            rate / rate.norm()
        };
        let (start, end) = (direction(0.0), direction(0.25));
        let last = self.grid.nodes.len().saturating_sub(1);
        let off_start = if self.bent_round_a_corner(last, 0) {
            0.0
        } else {
            (start.x + start.y).abs()
        };
        off_start.max((end.x - end.y).abs())
    }

    /// Multipliers of the active bounds (KKT), over |W t|; positive if the curve pushes outwards.
    fn effort_multipliers(&self, momentum: &Momentum) -> Option<Check> {
        let multipliers = |path: &Path| -> Vec<f64> {
            let scale = largest_costate(path);
            path.places
                .iter()
                .enumerate()
                .filter(|(node, _)| self.along(*node) == Along::Bound)
                .map(|(node, place)| {
                    let Some(side) = self.bound_side(node) else {
                        return f64::NAN;
                    };
                    let CurveNode { rate, bend, .. } = place;
                    let ([d1, d2], w) = (&place.first.d_power, &place.first.power);
                    let along = d1 * rate.x + d2 * rate.y;
                    let power = place.root_power.powi(2);
                    let power_rate = 2.0 * bend.dot(&(w * rate)) + rate.dot(&(along * rate));
                    let faster = along * rate + w * bend - w * rate * (0.5 * power_rate / power);
                    let height = place.height(momentum) * place.root_power;
                    let dearer = Vector2::new(rate.dot(&(d1 * rate)), rate.dot(&(d2 * rate))) * 0.5;
                    let push = (faster - dearer + Vector2::new(rate.y, -rate.x) * height) / power;
                    push.dot(&Vector2::new(rate.y, -rate.x)) * side / (rate.norm() * scale)
                })
                .collect()
        };
        let (fine, coarse) = (multipliers(&self.path), multipliers(&self.coarse));
        let unsure = fine
            .iter()
            .zip(&coarse)
            .map(|(a, b)| (a - b).abs())
            .fold(0.0, worse);
        let least = fine.into_iter().reduce(lesser)?;
        Some(Condition::EffortOnBound.open(least, unsure.min(1e-4)))
    }
}

/// Residual of the costate equations at every node, each piece about its own mean.
struct Balance {
    left_over: Vec<Vector2<f64>>,
    /// Largest |W t|.
    scale: f64,
}

impl Balance {
    fn new(subject: &Subject<'_>, path: &Path, momentum: &Momentum) -> Self {
        let degree = Degree::Fine;
        let forces: Vec<Vector2<f64>> = path
            .places
            .iter()
            .map(|place| {
                let ([d1, d2], rate) = (&place.first.d_power, &place.rate);
                let dearer = Vector2::new(rate.dot(&(d1 * rate)), rate.dot(&(d2 * rate)));
                dearer * (0.5 / place.root_power)
                    - Vector2::new(rate.y, -rate.x) * place.height(momentum)
            })
            .collect();
        let integrals = subject.grid.integrals(&forces, Vector2::zeros(), degree);
        let mut left_over: Vec<Vector2<f64>> = path
            .places
            .iter()
            .zip(&integrals)
            .map(|(place, integral)| place.first.power * place.rate / place.root_power - integral)
            .collect();
        for piece in &subject.grid.pieces {
            if let Some(nodes) = left_over.get_mut(piece.nodes.clone()) {
                let mean = nodes.iter().sum::<Vector2<f64>>() / nodes.len() as f64;
                for node in nodes.iter_mut() {
                    *node -= mean;
                }
            }
        }
        Self {
            left_over,
            scale: largest_costate(path),
        }
    }

    /// Largest relative difference on free arcs.
    fn distance(&self, other: &Self) -> f64 {
        self.left_over
            .iter()
            .zip(&other.left_over)
            .map(|(a, b)| (a - b).norm() / self.scale)
            .fold(0.0, worse)
    }

    /// Conditions on `H_u` and H, with costates integrated from their own equations.
    fn checks(&self, subject: &Subject<'_>, unsure: f64) -> Vec<Check> {
        let free = || {
            self.left_over
                .iter()
                .zip(&subject.path.places)
                .enumerate()
                .filter(|(node, _)| subject.along(*node) == Along::Free)
                .map(|(_, pair)| pair)
        };
        if free().next().is_none() {
            return Vec::new();
        }
        let h_u = free()
            .map(|(left, _)| left.norm() / self.scale)
            .fold(0.0, worse);
        // t·W t = 1, so that this is relative to the constant H = ξ/(c_t L).
        let hamiltonian = free()
            .map(|(left, place)| (left.dot(&place.rate) / place.root_power).abs())
            .fold(0.0, worse);
        let open = unsure.min(Condition::SlopesKnown.tolerance());
        vec![
            Condition::CostateBalance.open(h_u, open),
            Condition::HamiltonianConstant.open(hamiltonian, 10.0 * open),
        ]
    }
}

fn largest_costate(path: &Path) -> f64 {
    path.places
        .iter()
        .map(|place| (place.first.power * place.rate).norm() / place.root_power)
        .fold(0.0, worse)
}
