//! Iterate of the collocation: shapes at all mesh points, and the states and derivatives that follow from them.
//!
//! The collocated state equations are solved instead of imposed as constraints. Since φ̇ = u, the control is the slope of the
//! polynomials; θ follows by quadrature, then x and E. Every iterate is therefore feasible, and the objective is an unconstrained
//! function of the shapes. A backward (adjoint) sweep gives its gradient.

use gait_optimizer::region::{Bound, Level};
use nalgebra::{Matrix2xX, Matrix3xX, Vector2, Vector3};
use swimmer_model::{FirstDerivatives, Model};

use super::mesh::Mesh;

/// Shapes and states, one column or entry per mesh point. The first point is not a collocation node and has no rates.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub(crate) phi: Matrix2xX<f64>,
    /// φ̇.
    pub(crate) control: Matrix2xX<f64>,
    /// cos θ and sin θ.
    heading: Matrix2xX<f64>,
    /// ẋ, ẏ and Ė.
    rates: Matrix3xX<f64>,
    pub(crate) physics: Vec<FirstDerivatives<f64>>,
    pub(crate) final_x: f64,
    pub(crate) final_energy: f64,
}

impl Path {
    /// Solves the state equations for the shapes.
    pub(crate) fn new(model: &Model<f64>, mesh: &Mesh, phi: Matrix2xX<f64>) -> Self {
        let physics: Vec<_> = phi
            .column_iter()
            .map(|shape| model.first_derivatives(&shape.into_owned()))
            .collect();
        let (rule, per_time) = (&mesh.rule, mesh.elements as f64);
        let mut control = Matrix2xX::zeros(phi.ncols());
        let mut velocities = Matrix3xX::zeros(phi.ncols());
        let mut heading = Matrix2xX::zeros(phi.ncols());
        let mut theta: f64 = 0.0;
        let mut rates = Matrix3xX::zeros(phi.ncols());
        for first in mesh.firsts() {
            for (node, slopes) in rule.slopes.column_iter().enumerate() {
                let rate = phi.columns(first, slopes.len()) * slopes * per_time;
                let point = first + 1 + node;
                control.set_column(point, &rate);
                velocities.set_column(point, &(physics[point].connection * rate));
            }
            let start = theta;
            for (node, shares) in rule.integrals.column_iter().enumerate() {
                let point = first + 1 + node;
                let turned = velocities.columns(first + 1, shares.len()) * shares / per_time;
                theta = start + turned.z;
                let (sin, cos) = theta.sin_cos();
                heading.set_column(point, &Vector2::new(cos, sin));
                let (rate, body) = (control.column(point), velocities.column(point));
                let x = cos * body.x - sin * body.y;
                let y = sin * body.x + cos * body.y;
                let power = rate.dot(&(physics[point].power * rate));
                rates.set_column(point, &Vector3::new(x, y, power));
            }
        }
        let ends = &rates * &mesh.weights;
        Self {
            phi,
            control,
            heading,
            rates,
            physics,
            final_x: ends.x,
            final_energy: ends.z,
        }
    }

    /// Lighthill efficiency of the quarter: `c_t L x_f²/E_f` with `t_f = 1`.
    pub(crate) fn efficiency(&self, model: &Model<f64>) -> f64 {
        let per_power = model.side_drag() * model.swimmer().total_length();
        per_power * self.final_x * self.final_x / self.final_energy
    }

    /// Objective to be minimised, ln E − 2 ln(±x), for the required sign of x. Returns `None` if x has the other sign.
    pub(crate) fn objective(&self, sign: f64) -> Option<f64> {
        let (x, energy) = (sign * self.final_x, self.final_energy);
        let value = energy.ln() - 2.0 * x.ln();
        (x > 0.0 && energy > 0.0 && value.is_finite()).then_some(value)
    }

    /// Gradient of ln E − 2 ln x with respect to each shape, by a backward sweep over the elements.
    pub(crate) fn slope(&self, mesh: &Mesh) -> Matrix2xX<f64> {
        let (rule, per_time) = (&mesh.rule, mesh.elements as f64);
        let (of_x, of_energy) = (-2.0 / self.final_x, 1.0 / self.final_energy);
        let mut by_phi = Matrix2xX::<f64>::zeros(self.phi.ncols());
        // ∂x_f/∂θ of a single node and of all later elements.
        let pull = -self.rates.row(1).transpose().component_mul(&mesh.weights);
        let mut later = 0.0;
        for first in mesh.firsts().rev() {
            for (node, slopes) in rule.slopes.column_iter().enumerate() {
                let point = first + 1 + node;
                let (weight, physics) = (mesh.weights[point], &self.physics[point]);
                // A rotation at a node rotates the nodes after it, by the weights of the quadrature, and all later elements.
                let pulls = pull.rows(first + 1, rule.degree());
                let turned = rule.integrals.row(node).tr_dot(&pulls);
                let by_theta = later + turned / (per_time * weight);
                let rate = self.control.column(point);
                // ∂x_f/∂(body velocity).
                let (cos, sin) = (self.heading[(0, point)], self.heading[(1, point)]);
                let carry = Vector3::new(cos, -sin, by_theta) * (of_x * weight);
                let energy = of_energy * weight;
                for i in 0..2 {
                    by_phi[(i, point)] += carry.dot(&(physics.d_connection[i] * rate))
                        + energy * rate.dot(&(physics.d_power[i] * rate));
                }
                let by_rate =
                    physics.connection.tr_mul(&carry) + physics.power * rate * (2.0 * energy);
                by_phi
                    .columns_mut(first, slopes.len())
                    .ger(per_time, &by_rate, &slopes, 1.0);
            }
            later += pull.rows(first + 1, rule.degree()).sum();
        }
        by_phi
    }
}

/// Margins of all shapes to all bounds, as pairs of point index and level.
pub(crate) fn levels<'a>(
    walls: &'a [Bound],
    shapes: &'a Matrix2xX<f64>,
) -> impl Iterator<Item = (usize, Level)> + 'a {
    (0..shapes.ncols() * walls.len()).map(move |i| {
        let (point, wall) = (i / walls.len(), &walls[i % walls.len()]);
        (point, wall.smooth_level(&shapes.column(point).into_owned()))
    })
}
