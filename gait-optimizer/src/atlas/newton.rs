//! Primal–dual interior-point method for a closed curve without net rotation, with exact second derivatives, damped until the
//! Hessian on the constraint is positive definite.
//!
//! The shift of u along the curve is a null direction, which the damping regularises. A second-order correction along K⁻¹∇Δθ keeps
//! full steps acceptable near the solution.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2, Vector4};

use super::barrier::{Barrier, MOST};
use super::objective::{Aim, Expansion};
use crate::closed_curve::{Functional, Values, Weights, Workspace, column};
use crate::region::Level;

/// Stopping criteria and barrier parameters.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Settings {
    pub(crate) iterations: usize,
    /// Estimated distance of the objective from its optimum at which the iteration stops.
    pub(crate) residual: f64,
    /// First and last barrier parameter.
    pub(crate) barrier: (f64, f64),
}

/// Curve at which the first variation vanishes.
#[derive(Debug, Clone)]
pub(crate) struct Stationary {
    pub(crate) coefficients: DMatrix<f64>,
    pub(crate) values: Values,
}

/// Iteration with a workspace that is reused for every start.
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
    /// Barrier parameter; the next fields are the damping and the penalty of the rotation.
    weight: f64,
    damping: f64,
    penalty: f64,
}

/// Accepted iterate.
#[derive(Debug, Clone, Copy)]
struct Iterate {
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

    /// Iterates from a start inside the barrier to a stationary curve. Returns `None` if the iteration does not converge.
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
            let here = Iterate {
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

    /// Performs one step, with increasing damping until it is accepted.
    fn accepted(&mut self, from: &DMatrix<f64>, here: &Iterate, scale: f64) -> Option<(Step, New)> {
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

    /// Estimated distance of the objective from its optimum: squared gradient over the curvature scale of the damping, with the
    /// least-squares multiplier of Δθ.
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

    /// Evaluates the margins at the nodes of the curve. Returns `None` if one is not positive.
    fn look_at_margins(&mut self) -> Option<()> {
        for (node, margins) in self.margins.iter_mut().enumerate() {
            *margins = self.barrier.margins(&column(&self.work.phi, node));
            if margins.iter().any(|margin| margin.value <= 0.0) {
                return None;
            }
        }
        Some(())
    }

    /// Gradient of the Lagrangian with the dual variables of the barrier, and gradient of Δθ.
    fn first_order(&mut self, here: &Iterate) {
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

    /// Hessian of the Lagrangian with the barrier term.
    fn second_order(&mut self, here: &Iterate) {
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

    /// 2 max(κ, 0.1) over ∮|Φ′|² du; times the roughness of a function it is the scale of the second derivative of ln E.
    fn scale(&self) -> f64 {
        let length = self.work.slope.norm_squared() / self.functional.basis.nodes() as f64;
        let panels = self.functional.basis.panels() as f64;
        2.0 * self.aim.energy_weight.max(0.1) / (length * panels * panels).max(1e-12)
    }

    /// Damped Newton step. Returns `None` if the matrix is not positive definite.
    fn step(&mut self, here: &Iterate, damping: f64) -> Option<Step> {
        let unknowns = self.gradient.len();
        self.matrix.copy_from(&self.work.hessian);
        let mut trace = 0.0;
        for i in 0..unknowns {
            self.matrix[(i, i)] += damping * self.functional.basis.roughness(i / 2);
            trace += self.matrix[(i, i)].abs();
        }
        // The weight of the squared constraint does not change the step; it makes the matrix definite in the direction of the
        // constraint.
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
        // The gradient contains the old multiplier, which does not belong to the objective.
        let expected = -self.gradient.dot(&towards) - here.rotation * off;
        Some(Step {
            by: towards,
            unspin,
            rotation,
            expected,
        })
    }

    /// Point after a step, shortened to stay inside the barrier. Returns `None` if the merit function does not decrease.
    fn try_step(&mut self, from: &DMatrix<f64>, step: &Step, here: &Iterate) -> Option<New> {
        let merit_here = self.merit(&here.values, true)?;
        let mut length = 1.0;
        for _ in 0..8 {
            let mut there = from.clone();
            add(&mut there, length, &step.by);
            let mut values = self.functional.values(&there, &mut self.work);
            // A full step should remove the rotation.
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

    /// Merit function: objective, barrier and penalty of the present curve. Returns `None` outside the barrier. `old` uses the stored
    /// margins.
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
                // Fraction-to-boundary rule: no margin may shrink to one percent in one step.
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

    /// Updates the dual variables of the margins.
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
    /// Change that removes one unit of rotation at the least cost.
    unspin: DVector<f64>,
    /// New multiplier of Δθ.
    rotation: f64,
    /// First-order change of objective and barrier, about twice the actual one.
    expected: f64,
}

#[derive(Debug)]
struct New {
    coefficients: DMatrix<f64>,
    ratio: f64,
    length: f64,
}
