//! Hessian of a weighted sum of a curve's values by its coefficients, in closed form.
//!
//! One part is local: second derivatives of a, ω and the power at each node. The other couples nodes, since an earlier rotation
//! rotates all later motion; it is a product of two matrices with one column per node.

use nalgebra::{Matrix2, Rotation2, Vector2};

use super::basis::{PARTIAL, STAGES, WEIGHTS};
use super::functional::{Functional, Workspace, column};

/// Weights of X, Y, Δθ and energy in the sum.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Weights {
    pub(crate) momentum: Vector2<f64>,
    pub(crate) rotation: f64,
    pub(crate) energy: f64,
}

impl Functional<'_> {
    /// Computes the Hessian of the weighted sum in [`Workspace::hessian`]. `local` has second derivatives by the joint angles of an
    /// additional term that depends on the shape of a node only, such as a barrier at a bound. [`Functional::gradients`] must have
    /// been evaluated for the same curve.
    pub(crate) fn hessian(&self, weights: &Weights, local: &[Matrix2<f64>], work: &mut Workspace) {
        work.hessian.fill(0.0);
        work.running.fill(0.0);
        for panel in 0..self.basis.panels() {
            for node in panel * STAGES..(panel + 1) * STAGES {
                self.turn_gradient(work, node);
            }
            heading_gradients(work, panel);
        }
        for node in 0..self.basis.nodes() {
            self.partner(weights, work, node);
            let extra = local.get(node).copied().unwrap_or_default();
            self.add_local(weights, &extra, work, node);
        }
        let Workspace {
            hessian,
            coupling,
            heading_gradient,
            partner,
            ..
        } = work;
        coupling.gemm(1.0, heading_gradient, partner, 0.0);
        for column in 0..hessian.ncols() {
            for row in 0..=column {
                let entry =
                    hessian[(row, column)] + coupling[(row, column)] + coupling[(column, row)];
                hessian[(row, column)] = entry;
                hessian[(column, row)] = entry;
            }
        }
    }

    /// ∇ω of a node.
    fn turn_gradient(&self, work: &mut Workspace, node: usize) {
        let weight = WEIGHTS[node % STAGES];
        let slope = column(&work.slope, node);
        let first = &work.derivatives[node].first;
        let by_phi = first
            .d_connection
            .map(|d| weight * (d[(2, 0)] * slope.x + d[(2, 1)] * slope.y));
        let by_slope = [
            weight * first.connection[(2, 0)],
            weight * first.connection[(2, 1)],
        ];
        let mut out = work.turn.column_mut(node);
        for (j, (value, rise)) in self.basis.at_node(node).enumerate() {
            out[2 * j] = value * by_phi[0] + rise * by_slope[0];
            out[2 * j + 1] = value * by_phi[1] + rise * by_slope[1];
        }
    }

    /// Row of Σ of a node: ∇_a of p · J R a, minus half of p · R a times ∇ϑ.
    fn partner(&self, weights: &Weights, work: &mut Workspace, node: usize) {
        let weight = WEIGHTS[node % STAGES];
        let slope = column(&work.slope, node);
        let body = Rotation2::new(-work.heading[node]) * weights.momentum;
        let motion = &work.motion[node];
        let pull = 0.5 * (body.x * motion.x + body.y * motion.y);
        let first = &work.derivatives[node].first;
        let weigh = |x: f64, y: f64| weight * (body.y * x - body.x * y);
        let by_phi = first.d_connection.map(|d| {
            let moved = d * slope;
            weigh(moved.x, moved.y)
        });
        let a = &first.connection;
        let by_slope = [weigh(a[(0, 0)], a[(1, 0)]), weigh(a[(0, 1)], a[(1, 1)])];
        for (j, (value, rise)) in self.basis.at_node(node).enumerate() {
            for joint in 0..2 {
                work.partner[(node, 2 * j + joint)] = value * by_phi[joint]
                    + rise * by_slope[joint]
                    - pull * work.heading_gradient[(2 * j + joint, node)];
            }
        }
    }

    /// Adds a node's own second derivatives to the upper triangle.
    fn add_local(
        &self,
        weights: &Weights,
        extra: &Matrix2<f64>,
        work: &mut Workspace,
        node: usize,
    ) {
        let weight = WEIGHTS[node % STAGES];
        let slope = column(&work.slope, node);
        let second = &work.derivatives[node];
        let body = Rotation2::new(-work.heading[node]) * weights.momentum;
        // Derivatives of the sum by (a_x, a_y, ω) at this node.
        let rows = [
            body.x * weight,
            body.y * weight,
            (weights.momentum.dot(&work.lever[node]) + weights.rotation) * weight,
        ];
        let cost = weights.energy * weight * self.basis.panels() as f64;
        let weigh = |m: &nalgebra::Matrix3x2<f64>| {
            m.row(0) * rows[0] + m.row(1) * rows[1] + m.row(2) * rows[2]
        };
        let both = |n: usize| {
            (weigh(&second.d2_connection[n]) * slope)[0]
                + cost * slope.dot(&(second.d2_power[n] * slope))
        };
        let phi_phi = Matrix2::new(both(0), both(1), both(1), both(2)) + extra;
        let mixed = |i: usize| {
            weigh(&second.first.d_connection[i]).transpose()
                + second.first.d_power[i] * slope * (2.0 * cost)
        };
        // Row: joint angle; column: slope.
        let phi_slope = Matrix2::from_columns(&[mixed(0), mixed(1)]).transpose();
        let slope_slope = second.first.power * (2.0 * cost);
        for (k, (value_k, rise_k)) in self.basis.at_node(node).enumerate() {
            if value_k == 0.0 && rise_k == 0.0 {
                continue;
            }
            let by_value = phi_phi * value_k + phi_slope * rise_k;
            let by_rise = phi_slope.transpose() * value_k + slope_slope * rise_k;
            for (j, (value_j, rise_j)) in self.basis.at_node(node).enumerate().take(k + 1) {
                let block = by_value * value_j + by_rise * rise_j;
                work.hessian[(2 * j, 2 * k)] += block.m11;
                work.hessian[(2 * j, 2 * k + 1)] += block.m12;
                work.hessian[(2 * j + 1, 2 * k + 1)] += block.m22;
                if j < k {
                    work.hessian[(2 * j + 1, 2 * k)] += block.m21;
                }
            }
        }
    }
}

/// ∇ϑ of a panel's nodes from ∇ω, and the running sum up to the start of the next panel.
fn heading_gradients(work: &mut Workspace, panel: usize) {
    let first = panel * STAGES;
    for (q, row) in PARTIAL.iter().enumerate() {
        let mut out = work.heading_gradient.column_mut(first + q);
        out.copy_from(&work.running);
        for (r, part) in row.iter().enumerate() {
            out.axpy(*part, &work.turn.column(first + r), 1.0);
        }
    }
    for r in 0..STAGES {
        work.running.axpy(1.0, &work.turn.column(first + r), 1.0);
    }
}
