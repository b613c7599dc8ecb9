//! A candidate: the shapes at all points of the mesh, and everything that the state equations make of them.
//!
//! The collocated state equations are solved, not constrained. φ̇ = u makes u the slope of the polynomials; θ then follows by
//! quadrature, and from it x and E. So every iterate is a gait of the discretised problem, and the objective is a plain
//! function of the shapes, whose gradient is found by going back.

use gait_optimizer::region::{Bound, Level};
use nalgebra::{Matrix2xX, Matrix3xX, Vector2, Vector3};
use swimmer_model::{FirstDerivatives, Model};

use super::mesh::Mesh;

/// The shapes and the states that follow: one column or entry per point of the mesh. The first point is no node and has no
/// rates.
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

    /// ξ of a quarter: `c_t L x_f²/E_f`, `t_f = 1`.
    pub(crate) fn efficiency(&self, model: &Model<f64>) -> f64 {
        let per_power = model.side_drag() * model.swimmer().total_length();
        per_power * self.final_x * self.final_x / self.final_energy
    }

    /// ln E − 2 ln(±x), what is made least; the sign is the wanted one of x. None where x has the other sign.
    pub(crate) fn objective(&self, sign: f64) -> Option<f64> {
        let (x, energy) = (sign * self.final_x, self.final_energy);
        let value = energy.ln() - 2.0 * x.ln();
        (x > 0.0 && energy > 0.0 && value.is_finite()).then_some(value)
    }

    /// The gradient of ln E − 2 ln x, per shape, by going back from the last element to the first.
    pub(crate) fn slope(&self, mesh: &Mesh) -> Matrix2xX<f64> {
        let (rule, per_time) = (&mesh.rule, mesh.elements as f64);
        let (of_x, of_energy) = (-2.0 / self.final_x, 1.0 / self.final_energy);
        let mut by_phi = Matrix2xX::<f64>::zeros(self.phi.ncols());
        // ∂x_f/∂θ of a node alone, and of all later elements.
        let pull = -self.rates.row(1).transpose().component_mul(&mesh.weights);
        let mut later = 0.0;
        for first in mesh.firsts().rev() {
            for (node, slopes) in rule.slopes.column_iter().enumerate() {
                let point = first + 1 + node;
                let (weight, physics) = (mesh.weights[point], &self.physics[point]);
                // A turn at a node turns the nodes after it, by the quadrature's shares, and all later elements.
                let pulls = pull.rows(first + 1, rule.degree());
                let turned = rule.integrals.row(node).tr_dot(&pulls);
                let by_theta = later + turned / (per_time * weight);
                let rate = self.control.column(point);
                // What `x_f` gains from the body velocity.
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

/// How far shapes are within each wall, shape by shape with its number.
pub(crate) fn levels<'a>(
    walls: &'a [Bound],
    shapes: &'a Matrix2xX<f64>,
) -> impl Iterator<Item = (usize, Level)> + 'a {
    (0..shapes.ncols() * walls.len()).map(move |i| {
        let (point, wall) = (i / walls.len(), &walls[i % walls.len()]);
        (point, wall.smooth_level(&shapes.column(point).into_owned()))
    })
}
