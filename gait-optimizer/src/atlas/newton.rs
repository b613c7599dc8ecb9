//! Newton's method for a closed curve with no net rotation inside a barrier: primal–dual interior point with exact second
//! derivatives, damped until the Hessian on the constraint is positive definite.
//!
//! The free shift of u along the curve leaves one direction flat; the damping takes care of it. A second-order correction
//! along K⁻¹∇Δθ keeps full steps acceptable near the solution.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector4};

use super::barrier::{Barrier, MOST};
use super::objective::{Aim, Expansion};
use crate::closed_curve::{Functional, Values, Weights, Workspace, column};
use crate::region::Level;

/// When to stop, and how close to the bounds.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) iterations: usize,
    /// How much the objective may still be off its optimum, roughly.
    pub(crate) residual: f64,
    /// First and last weight of the barrier.
    pub(crate) barrier: (f64, f64),
}

/// A curve at which the first variation vanishes.
#[derive(Debug, Clone)]
pub(crate) struct Stationary {
    pub(crate) coefficients: DMatrix<f64>,
    pub(crate) values: Values,
}

/// Room for one problem, used again for every start.
#[derive(Debug)]
pub(crate) struct Newton<'a> {
    functional: Functional<'a>,
    aim: Aim,
    barrier: Barrier,
    work: Workspace,
    matrix: DMatrix<f64>,
    gradient: DVector<f64>,
    spin: DVector<f64>,
    margins: Vec<[Level; MOST]>,
    pressure: Vec<[f64; MOST]>,
    local: Vec<Matrix2<f64>>,
    /// Weights of the barrier, of what keeps steps short and of the rotation that is left, which change as an iteration goes on.
    weight: f64,
    damping: f64,
    penalty: f64,
}

/// One accepted point.
#[derive(Debug, Clone, Copy)]
struct Here {
    values: Values,
    expansion: Expansion,
    rotation: f64,
}

impl<'a> Newton<'a> {
    pub(crate) fn new(functional: Functional<'a>, barrier: Barrier) -> Self {
        let (nodes, unknowns) = (functional.basis.nodes(), functional.unknowns());
        let none = barrier.margins(&Vector2::zeros());
        Self {
            functional,
            aim: Aim { energy_weight: 1.0 },
            barrier,
            work: functional.workspace(),
            matrix: DMatrix::zeros(unknowns, unknowns),
            gradient: DVector::zeros(unknowns),
            spin: DVector::zeros(unknowns),
            margins: vec![none; nodes],
            pressure: vec![[0.0; MOST]; nodes],
            local: vec![Matrix2::zeros(); nodes],
            weight: 0.0,
            damping: 0.0,
            penalty: 0.0,
        }
    }

    /// The stationary curve that the iteration runs into from a start inside the barrier; none where it does not settle.
    pub(crate) fn solve(
        &mut self,
        aim: Aim,
        start: &DMatrix<f64>,
        settings: &Settings,
    ) -> Option<Stationary> {
        let mut coefficients = start.clone();
        let (first, last) = settings.barrier;
        (self.aim, self.weight, self.damping, self.penalty) = (aim, first, 1e-2, 1.0);
        let mut values = self.functional.gradients(&coefficients, &mut self.work);
        self.look_at_margins()?;
        for (pressure, margins) in self.pressure.iter_mut().zip(&self.margins) {
            for (z, margin) in pressure.iter_mut().zip(margins) {
                *z = first / margin.value;
            }
        }
        let mut rotation = 0.0;
        for _ in 0..settings.iterations {
            if !(values.energy.is_finite() && values.displacement.norm() > 0.0) {
                return None;
            }
            let here = Here {
                values,
                expansion: self.aim.expansion(&values),
                rotation,
            };
            self.first_order(&here);
            let scale = self.scale();
            let residual = self.residual(scale);
            let level = if self.weight > last {
                settings.residual.max(0.1 * self.weight)
            } else {
                settings.residual
            };
            let settled = residual < level && values.rotation.abs() < 10.0 * level.sqrt();
            if settled && self.weight <= last {
                return Some(Stationary {
                    coefficients,
                    values,
                });
            }
            if settled {
                self.weight = (self.weight * 0.1).max(last);
                self.first_order(&here);
            }
            self.second_order(&here);
            let (step, new) = self.accepted(&coefficients, &here, scale)?;
            self.press(&step, &new);
            coefficients = new.coefficients;
            rotation = step.rotation;
            values = self.functional.gradients(&coefficients, &mut self.work);
            self.look_at_margins()?;
        }
        None
    }

    /// One step, with more damping until it is accepted.
    fn accepted(&mut self, from: &DMatrix<f64>, here: &Here, scale: f64) -> Option<(Step, New)> {
        for _ in 0..24 {
            if let Some(step) = self.step(here, self.damping * scale) {
                self.penalty = self.penalty.max(2.0 * step.rotation.abs());
                if let Some(new) = self.try_step(from, &step, here) {
                    if new.ratio > 0.7 && new.length > 0.9 {
                        self.damping = (self.damping * 0.15).max(1e-9);
                    } else if new.ratio < 0.2 {
                        self.damping *= 3.0;
                    }
                    return Some((step, new));
                }
            }
            self.damping = (self.damping * 6.0).max(1e-6);
        }
        None
    }

    /// How much the objective could still fall, roughly: the squared gradient over what damping takes for curvature, with
    /// the multiplier of Δθ that makes it least.
    fn residual(&self, scale: f64) -> f64 {
        let (mut gg, mut ga, mut aa) = (0.0, 0.0, 0.0);
        for (i, (g, a)) in self.gradient.iter().zip(self.spin.iter()).enumerate() {
            let weight = 1.0 / (scale * self.functional.basis.roughness(i / 2));
            gg += g * g * weight;
            ga += g * a * weight;
            aa += a * a * weight;
        }
        gg - ga * ga / aa
    }

    /// Margins at the nodes of the curve; none where one is not positive.
    fn look_at_margins(&mut self) -> Option<()> {
        for (node, margins) in self.margins.iter_mut().enumerate() {
            *margins = self.barrier.margins(&column(&self.work.phi, node));
            if margins.iter().any(|margin| margin.value <= 0.0) {
                return None;
            }
        }
        Some(())
    }

    /// Gradient of the Lagrangian with the barrier's own multipliers, and of Δθ.
    fn first_order(&mut self, here: &Here) {
        let mut weights = here.expansion.gradient;
        weights.z += here.rotation;
        self.gradient.gemv(1.0, &self.work.gradients, &weights, 0.0);
        self.spin.copy_from(&self.work.gradients.column(2));
        let count = self.barrier.count();
        for (node, margins) in self.margins.iter().enumerate() {
            let mut pull = Vector2::zeros();
            for margin in margins.iter().take(count) {
                pull -= margin.gradient * (self.weight / margin.value);
            }
            let values = self.functional.basis.values.column(node);
            for (j, value) in values.iter().enumerate() {
                self.gradient[2 * j] += value * pull.x;
                self.gradient[2 * j + 1] += value * pull.y;
            }
        }
    }

    /// The Hessian of the Lagrangian with the barrier's part.
    fn second_order(&mut self, here: &Here) {
        let count = self.barrier.count();
        for ((local, margins), pressures) in
            self.local.iter_mut().zip(&self.margins).zip(&self.pressure)
        {
            *local = Matrix2::zeros();
            for (margin, z) in margins.iter().zip(pressures).take(count) {
                *local += margin.gradient * margin.gradient.transpose() * (z / margin.value)
                    - margin.hessian * *z;
            }
        }
        let gradient = here.expansion.gradient;
        let weights = Weights {
            momentum: gradient.xy(),
            rotation: gradient.z + here.rotation,
            energy: gradient.w,
        };
        self.functional
            .hessian(&weights, &self.local, &mut self.work);
        let spread = &self.work.gradients * here.expansion.hessian;
        let Workspace {
            hessian, gradients, ..
        } = &mut self.work;
        for column in 0..hessian.ncols() {
            let partner = Vector4::from_fn(|quantity, _| gradients[(column, quantity)]);
            for row in 0..hessian.nrows() {
                let entry: f64 = (0..4).map(|q| spread[(row, q)] * partner[q]).sum();
                hessian[(row, column)] += entry;
            }
        }
    }

    /// 2 max(κ, 0.1) over ∮|Φ′|² du: times a function's roughness this is what ln E has for a second derivative.
    fn scale(&self) -> f64 {
        let length = self.work.slope.norm_squared() / self.functional.basis.nodes() as f64;
        let panels = self.functional.basis.panels() as f64;
        2.0 * self.aim.energy_weight.max(0.1) / (length * panels * panels).max(1e-12)
    }

    /// The damped Newton step; none where the matrix is not positive definite.
    fn step(&mut self, here: &Here, damping: f64) -> Option<Step> {
        let unknowns = self.gradient.len();
        self.matrix.copy_from(&self.work.hessian);
        let mut trace = 0.0;
        for i in 0..unknowns {
            self.matrix[(i, i)] += damping * self.functional.basis.roughness(i / 2);
            trace += self.matrix[(i, i)].abs();
        }
        // Any weight of the constraint's square gives the same step; it makes the matrix definite where only the constraint
        // does.
        let weight = 10.0 * trace / self.spin.norm_squared().max(1e-300) / unknowns as f64;
        self.matrix.ger(weight, &self.spin, &self.spin, 1.0);
        let matrix = std::mem::replace(&mut self.matrix, DMatrix::zeros(0, 0));
        let Some(factors) = matrix.cholesky() else {
            self.matrix = DMatrix::zeros(unknowns, unknowns);
            return None;
        };
        let mut towards = -&self.gradient;
        factors.solve_mut(&mut towards);
        let mut unspin = self.spin.clone();
        factors.solve_mut(&mut unspin);
        self.matrix = factors.unpack_dirty();
        let pivot = self.spin.dot(&unspin);
        let off = here.values.rotation;
        let force = (self.spin.dot(&towards) + off) / pivot;
        towards.axpy(-force, &unspin, 1.0);
        unspin /= pivot;
        let rotation = here.rotation + force - weight * off;
        // The gradient holds the old multiplier's part, which is not the objective's.
        let expected = -self.gradient.dot(&towards) - here.rotation * off;
        Some(Step {
            by: towards,
            unspin,
            rotation,
            expected,
        })
    }

    /// The point after a step, cut to stay inside the barrier; none where the merit does not fall.
    fn try_step(&mut self, from: &DMatrix<f64>, step: &Step, here: &Here) -> Option<New> {
        let merit_here = self.merit(&here.values, true)?;
        let mut length = 1.0;
        for _ in 0..8 {
            let mut there = from.clone();
            add(&mut there, length, &step.by);
            let mut values = self.functional.values(&there, &mut self.work);
            // A full step should leave no rotation.
            let wanted = (1.0 - length) * here.values.rotation;
            let correction = wanted - values.rotation;
            if correction.abs() > 1e-13 && correction.abs() < 0.5 {
                add(&mut there, correction, &step.unspin);
                values = self.functional.values(&there, &mut self.work);
            }
            let Some(merit) = self.merit(&values, false) else {
                length *= 0.5;
                continue;
            };
            let gain = merit_here - merit;
            let wish = length * (step.expected + self.penalty * here.values.rotation.abs());
            let ratio = if wish > 1e-11 {
                gain / (0.5 * wish)
            } else {
                1.0
            };
            let falls = gain >= 1e-4 * wish.abs() - 1e-13 * (1.0 + merit_here.abs());
            return falls.then_some(New {
                coefficients: there,
                ratio,
                length,
            });
        }
        None
    }

    /// Objective, barrier and penalty of the curve at hand; none outside the barrier. `old` takes the margins at hand.
    fn merit(&self, values: &Values, old: bool) -> Option<f64> {
        let count = self.barrier.count();
        let mut logs = 0.0;
        for (node, before) in self.margins.iter().enumerate() {
            if old {
                logs += before.iter().take(count).map(|m| m.value.ln()).sum::<f64>();
                continue;
            }
            let margins = self.barrier.margins(&column(&self.work.phi, node));
            for (margin, before) in margins.iter().zip(before).take(count) {
                // No margin may shrink to a hundredth at once.
                if margin.value.is_nan() || margin.value <= 0.01 * before.value {
                    return None;
                }
                logs += margin.value.ln();
            }
        }
        let priced = self.aim.value(values) - self.weight * logs;
        let merit = priced + self.penalty * values.rotation.abs();
        merit.is_finite().then_some(merit)
    }

    /// New multipliers of the margins.
    fn press(&mut self, step: &Step, new: &New) {
        let count = self.barrier.count();
        for (node, (pressures, margins)) in self.pressure.iter_mut().zip(&self.margins).enumerate()
        {
            let values = self.functional.basis.values.column(node);
            let mut moved = Vector2::zeros();
            for (j, value) in values.iter().enumerate() {
                moved += Vector2::new(step.by[2 * j], step.by[2 * j + 1]) * *value;
            }
            let after = self.barrier.margins(&column(&self.work.phi, node));
            for ((z, margin), after) in pressures.iter_mut().zip(margins).zip(&after).take(count) {
                let wanted = self.weight / margin.value
                    - *z / margin.value * margin.gradient.dot(&moved) * new.length;
                let central = self.weight / after.value.max(1e-300);
                *z = wanted.clamp(0.05 * central, 20.0 * central);
            }
        }
    }
}

fn add(coefficients: &mut DMatrix<f64>, length: f64, step: &DVector<f64>) {
    for (value, by) in coefficients.iter_mut().zip(step.iter()) {
        *value += length * by;
    }
}

#[derive(Debug)]
struct Step {
    by: DVector<f64>,
    /// The change that takes one unit of rotation away at the least cost.
    unspin: DVector<f64>,
    /// The new multiplier of Δθ.
    rotation: f64,
    /// What the objective and the barrier gain to first order: about twice what they will.
    expected: f64,
}

#[derive(Debug)]
struct New {
    coefficients: DMatrix<f64>,
    ratio: f64,
    length: f64,
}
