//! A candidate: the shapes at all points of the mesh, and everything that the state equations make of them.
//!
//! The collocated state equations are solved, not constrained. φ̇ = u makes u the slope of the polynomials; θ then follows by
//! quadrature, and from it x and E. So every iterate is a gait of the discretised problem, and the objective is a plain
//! function of the shapes, whose gradient is found by going back.

use nalgebra::{DVector, Matrix2xX, Matrix3xX, Vector2, Vector3};
use swimmer_model::{FirstDerivatives, Model};

use super::mesh::Mesh;

/// The shapes and the states that follow: one column or entry per point of the mesh. The first point is no node and has no
/// rates.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub(crate) phi: Matrix2xX<f64>,
    /// φ̇.
    pub(crate) control: Matrix2xX<f64>,
    theta: DVector<f64>,
    /// ẋ, ẏ and Ė.
    rates: Matrix3xX<f64>,
    pub(crate) physics: Vec<FirstDerivatives<f64>>,
    pub(crate) final_x: f64,
    pub(crate) final_energy: f64,
}

impl Path {
    /// Solves the state equations for the shapes.
    pub(crate) fn new(model: &Model<f64>, mesh: &Mesh, phi: Matrix2xX<f64>) -> Self {
        let (degree, per_time) = (mesh.rule.degree(), mesh.elements as f64);
        let mut control = Matrix2xX::zeros(phi.ncols());
        let mut turning = DVector::zeros(phi.ncols());
        let mut theta = DVector::zeros(phi.ncols());
        let mut rates = Matrix3xX::zeros(phi.ncols());
        let physics: Vec<_> = phi
            .column_iter()
            .map(|shape| model.first_derivatives(&shape.into_owned()))
            .collect();
        for first in mesh.firsts() {
            let slopes = phi.columns(first, degree + 1) * &mesh.rule.slopes * per_time;
            control.columns_mut(first + 1, degree).copy_from(&slopes);
            for point in first + 1..=first + degree {
                turning[point] = physics[point]
                    .connection
                    .row(2)
                    .tr_dot(&control.column(point));
            }
            let turned = mesh.rule.integrals.tr_mul(&turning.rows(first + 1, degree)) / per_time;
            let start = theta[first];
            theta
                .rows_mut(first + 1, degree)
                .copy_from(&turned.add_scalar(start));
        }
        for point in 1..phi.ncols() {
            let (sin, cos) = theta[point].sin_cos();
            let rate = control.column(point);
            let body = physics[point].connection * rate;
            rates.set_column(
                point,
                &Vector3::new(
                    cos * body.x - sin * body.y,
                    sin * body.x + cos * body.y,
                    rate.dot(&(physics[point].power * rate)),
                ),
            );
        }
        let ends = &rates * &mesh.weights;
        Self {
            phi,
            control,
            theta,
            rates,
            physics,
            final_x: ends.x,
            final_energy: ends.z,
        }
    }

    /// ln E − 2 ln(±x), what is made least; the sign is the wanted one of x. None where x has the other sign.
    pub(crate) fn objective(&self, sign: f64) -> Option<f64> {
        let (x, energy) = (sign * self.final_x, self.final_energy);
        let value = energy.ln() - 2.0 * x.ln();
        (x > 0.0 && energy > 0.0 && value.is_finite()).then_some(value)
    }

    /// The gradient of ln E − 2 ln x, per shape, by going back from the last element to the first.
    pub(crate) fn slope(&self, mesh: &Mesh) -> Matrix2xX<f64> {
        let (degree, per_time) = (mesh.rule.degree(), mesh.elements as f64);
        let (of_x, of_energy) = (-2.0 / self.final_x, 1.0 / self.final_energy);
        let mut by_phi = Matrix2xX::zeros(self.phi.ncols());
        // ∂x_f/∂θ of all later elements.
        let mut later = 0.0;
        for first in mesh.firsts().rev() {
            // A turn at a node turns the nodes after it, by the quadrature's shares, and all later elements.
            let weights = mesh.weights.rows(first + 1, degree);
            let pull = -self
                .rates
                .row(1)
                .columns(first + 1, degree)
                .transpose()
                .component_mul(&weights);
            let here = (&mesh.rule.integrals * &pull / per_time).component_div(&weights);
            let by_theta = here.add_scalar(later);
            later += pull.sum();
            let mut by_rate = Matrix2xX::zeros(degree);
            for node in 0..degree {
                let point = first + 1 + node;
                let (weight, physics) = (weights[node], &self.physics[point]);
                let rate = self.control.column(point);
                let (sin, cos) = self.theta[point].sin_cos();
                // What `x_f` gains from the body velocity.
                let carry = Vector3::new(cos, -sin, by_theta[node]) * (of_x * weight);
                let energy = of_energy * weight;
                by_rate.set_column(
                    node,
                    &(physics.connection.tr_mul(&carry) + physics.power * rate * (2.0 * energy)),
                );
                let mut own = by_phi.column_mut(point);
                own += Vector2::from([0, 1].map(|i| {
                    carry.dot(&(physics.d_connection[i] * rate))
                        + energy * rate.dot(&(physics.d_power[i] * rate))
                }));
            }
            let mut shapes = by_phi.columns_mut(first, degree + 1);
            shapes += by_rate * mesh.rule.slopes.transpose() * per_time;
        }
        by_phi
    }
}
