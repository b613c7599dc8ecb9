//! Displacement, rotation, energy and power length of a curve, and their gradients by the coefficients.
//!
//! With `v` the slope of the curve over a panel and `b` the weight of a node, the heading turns by `ω = b A_θ v` and the body
//! moves by `a = b A_xy v` at each node; ϑ at the nodes is the panel's first heading plus [`PARTIAL`] times the ω; then
//! d = Σ R(ϑ) a, Δθ = Σ ω and ∮P du = panels Σ b vᵀWv. The sums are differentiated exactly.

use nalgebra::{DMatrix, DVector, Matrix2x3, Matrix3x2, Rotation2, Vector2, Vector3};
use swimmer_model::{Model, SecondDerivatives};

use super::Basis;
use super::basis::{PARTIAL, STAGES, WEIGHTS};
use crate::batch::{self, Batch, Second};

/// Results of one cycle. Lengths are in the model's unit, energies over μ for a period of 1.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub(crate) struct Values {
    /// (X, Y) in the frame of the curve's first point, u = 0.
    pub(crate) displacement: Vector2<f64>,
    /// Δθ.
    pub(crate) rotation: f64,
    /// ∮P du: the energy as parametrised, at least the square of the power length.
    pub(crate) energy: f64,
    /// S = ∮√P du.
    pub(crate) power_length: f64,
}

/// Swimmer with a family of curves.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Functional<'a> {
    pub(crate) model: &'a Model<f64>,
    pub(crate) basis: &'a Basis,
}

/// Reusable workspace.
#[derive(Debug, Clone)]
pub(crate) struct Workspace {
    /// Joint angles and slope over a panel at each node.
    pub(crate) phi: DMatrix<f64>,
    pub(crate) slope: DMatrix<f64>,
    pub(crate) heading: Vec<f64>,
    /// b A v: body motion `(a_x, a_y, ω)` at each node.
    pub(crate) motion: Vec<Vector3<f64>>,
    pub(crate) derivatives: Vec<SecondDerivatives<f64>>,
    /// ∂d/∂ω at each node.
    pub(crate) lever: Vec<Vector2<f64>>,
    /// Gradients of X, Y, Δθ and energy by the coefficients, in four columns.
    pub(crate) gradients: DMatrix<f64>,
    pub(crate) hessian: DMatrix<f64>,
    /// Half of the coupling of earlier rotations with later motions.
    pub(crate) coupling: DMatrix<f64>,
    /// ∇ω and ∇ϑ of each node, one column each; the next field is the transposed other factor.
    pub(crate) turn: DMatrix<f64>,
    pub(crate) heading_gradient: DMatrix<f64>,
    pub(crate) partner: DMatrix<f64>,
    /// ∇ϑ at the start of the panel.
    pub(crate) running: DVector<f64>,
}

impl<'a> Functional<'a> {
    pub(crate) fn new(model: &'a Model<f64>, basis: &'a Basis) -> Self {
        Self { model, basis }
    }

    /// Number of coefficients of a curve: two per basis function.
    pub(crate) fn unknowns(&self) -> usize {
        2 * self.basis.functions()
    }

    /// Allocates a workspace.
    pub(crate) fn workspace(&self) -> Workspace {
        let (nodes, unknowns) = (self.basis.nodes(), self.unknowns());
        let still = self.model.second_derivatives(&Vector2::zeros());
        Workspace {
            phi: DMatrix::zeros(2, nodes),
            slope: DMatrix::zeros(2, nodes),
            heading: vec![0.0; nodes],
            motion: vec![Vector3::zeros(); nodes],
            derivatives: vec![still; nodes],
            lever: vec![Vector2::zeros(); nodes],
            gradients: DMatrix::zeros(unknowns, 4),
            hessian: DMatrix::zeros(unknowns, unknowns),
            coupling: DMatrix::zeros(unknowns, unknowns),
            turn: DMatrix::zeros(unknowns, nodes),
            heading_gradient: DMatrix::zeros(unknowns, nodes),
            partner: DMatrix::zeros(nodes, unknowns),
            running: DVector::zeros(unknowns),
        }
    }

    /// Evaluates the curve with these coefficients: (φ₁, φ₂) of the first function, of the second, …
    pub(crate) fn values(&self, coefficients: &DMatrix<f64>, work: &mut Workspace) -> Values {
        self.place(coefficients, work);
        let mut costs = (0.0, 0.0);
        let phi = (0..self.basis.nodes()).map(|node| column(&work.phi, node));
        Batch::of(self.model).each(batch::Values, phi, |node, (connection, power)| {
            let slope = column(&work.slope, node);
            let weight = WEIGHTS[node % STAGES];
            add_cost(&mut costs, weight, slope.dot(&(power * slope)));
            work.motion[node] = connection * slope * weight;
        });
        self.summed(work, costs)
    }

    /// Evaluates values and gradients ([`Workspace::gradients`]), and stores what [`Functional::hessian`] needs.
    pub(crate) fn gradients(&self, coefficients: &DMatrix<f64>, work: &mut Workspace) -> Values {
        self.place(coefficients, work);
        let mut costs = (0.0, 0.0);
        let phi = (0..self.basis.nodes()).map(|node| column(&work.phi, node));
        Batch::of(self.model).each(Second, phi, |node, second| {
            let slope = column(&work.slope, node);
            let weight = WEIGHTS[node % STAGES];
            add_cost(&mut costs, weight, slope.dot(&(second.first.power * slope)));
            work.motion[node] = second.first.connection * slope * weight;
            work.derivatives[node] = second;
        });
        let values = self.summed(work, costs);
        self.levers(work);
        work.gradients.fill(0.0);
        for node in 0..self.basis.nodes() {
            self.add_gradients(work, node);
        }
        values
    }

    fn place(&self, coefficients: &DMatrix<f64>, work: &mut Workspace) {
        work.phi.gemm(1.0, coefficients, &self.basis.values, 0.0);
        work.slope.gemm(1.0, coefficients, &self.basis.slopes, 0.0);
    }

    /// Computes the headings from the rotations, and all sums.
    fn summed(&self, work: &mut Workspace, (energy, power_length): (f64, f64)) -> Values {
        let mut theta = 0.0;
        let mut displacement = Vector2::zeros();
        for (motions, headings) in work
            .motion
            .chunks_exact(STAGES)
            .zip(work.heading.chunks_exact_mut(STAGES))
        {
            for ((heading, row), motion) in headings.iter_mut().zip(&PARTIAL).zip(motions) {
                let inside: f64 = row.iter().zip(motions).map(|(part, m)| part * m.z).sum();
                *heading = theta + inside;
                displacement += Rotation2::new(*heading) * motion.xy();
            }
            theta += motions.iter().map(|motion| motion.z).sum::<f64>();
        }
        Values {
            displacement,
            rotation: theta,
            energy: energy * self.basis.panels() as f64,
            power_length,
        }
    }

    /// ∂d/∂ω of each node: the displacement after it, rotated by 90°.
    fn levers(&self, work: &mut Workspace) {
        let mut after = Vector2::zeros();
        for panel in (0..self.basis.panels()).rev() {
            let first = panel * STAGES;
            let quarter: [Vector2<f64>; STAGES] = std::array::from_fn(|q| {
                let turn = Rotation2::new(work.heading[first + q]);
                let moved = turn * work.motion[first + q].xy();
                Vector2::new(-moved.y, moved.x)
            });
            for (r, lever) in work.lever.iter_mut().skip(first).take(STAGES).enumerate() {
                let parts = quarter.iter().zip(&PARTIAL);
                let inside: Vector2<f64> = parts.map(|(moved, row)| moved * row[r]).sum();
                *lever = after + inside;
            }
            after += quarter.iter().sum::<Vector2<f64>>();
        }
    }

    fn add_gradients(&self, work: &mut Workspace, node: usize) {
        let weight = WEIGHTS[node % STAGES];
        let slope = column(&work.slope, node);
        let first = &work.derivatives[node].first;
        let (sin, cos) = work.heading[node].sin_cos();
        let lever = work.lever[node];
        // Rows: derivatives of X, Y, Δθ by (a_x, a_y, ω) at this node.
        let reach = nalgebra::Matrix3::new(
            cos, -sin, lever.x, //
            sin, cos, lever.y, //
            0.0, 0.0, 1.0,
        );
        let by_slope: Matrix3x2<f64> = reach * first.connection * weight;
        let by_phi = Matrix3x2::from_columns(&[
            reach * (first.d_connection[0] * slope) * weight,
            reach * (first.d_connection[1] * slope) * weight,
        ]);
        let cost = weight * self.basis.panels() as f64;
        let cost_by_slope = first.power * slope * (2.0 * cost);
        let cost_by_phi = Vector2::new(
            slope.dot(&(first.d_power[0] * slope)),
            slope.dot(&(first.d_power[1] * slope)),
        ) * cost;
        let (phi, rate): (Matrix2x3<f64>, Matrix2x3<f64>) =
            (by_phi.transpose(), by_slope.transpose());
        for (j, (value, rise)) in self.basis.at_node(node).enumerate() {
            let part = phi * value + rate * rise;
            let energy = cost_by_phi * value + cost_by_slope * rise;
            for joint in 0..2 {
                for quantity in 0..3 {
                    work.gradients[(2 * j + joint, quantity)] += part[(joint, quantity)];
                }
                work.gradients[(2 * j + joint, 3)] += energy[joint];
            }
        }
    }
}

pub(crate) fn column(matrix: &DMatrix<f64>, node: usize) -> Vector2<f64> {
    Vector2::new(matrix[(0, node)], matrix[(1, node)])
}

fn add_cost(costs: &mut (f64, f64), weight: f64, power: f64) {
    costs.0 += weight * power;
    costs.1 += weight * power.max(0.0).sqrt();
}
