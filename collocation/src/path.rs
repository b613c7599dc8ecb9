//! A candidate: the shapes at all points of the mesh, and everything that the state equations make of them.
//!
//! The collocated state equations are solved, not constrained. φ̇ = u makes u the slope of the polynomials; θ then follows by
//! quadrature, and from it x and E. So every iterate is a gait of the discretised problem, and the objective is a plain
//! function of the shapes. The multipliers of the eliminated equations are the discrete costates, found by going back.

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};
use swimmer_model::Model;

use super::mesh::{Element, Mesh};

/// What one node is made of.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Node {
    pub(crate) rate: Vector2<f64>,
    pub(crate) theta: f64,
    pub(crate) sin: f64,
    pub(crate) cos: f64,
    pub(crate) connection: Matrix3x2<f64>,
    pub(crate) power: Matrix2<f64>,
    /// Body velocity A u.
    pub(crate) body: Vector3<f64>,
}

impl Node {
    const NONE: Self = Self {
        rate: Vector2::new(0.0, 0.0),
        theta: 0.0,
        sin: 0.0,
        cos: 1.0,
        connection: Matrix3x2::new(0.0, 0.0, 0.0, 0.0, 0.0, 0.0),
        power: Matrix2::new(0.0, 0.0, 0.0, 0.0),
        body: Vector3::new(0.0, 0.0, 0.0),
    };

    /// ẋ and ẏ.
    pub(crate) fn velocity(&self) -> Vector2<f64> {
        Vector2::new(
            self.cos * self.body.x - self.sin * self.body.y,
            self.sin * self.body.x + self.cos * self.body.y,
        )
    }

    pub(crate) fn power_spent(&self) -> f64 {
        self.rate.dot(&(self.power * self.rate))
    }
}

/// The shapes and the states that follow. All vectors have one entry per point of the mesh.
#[derive(Debug, Clone)]
pub(crate) struct Path {
    pub(crate) phi: Vec<Vector2<f64>>,
    /// The first, which is no node, holds nothing but θ = 0.
    pub(crate) nodes: Vec<Node>,
    pub(crate) final_x: f64,
    pub(crate) final_energy: f64,
}

impl Path {
    pub(crate) fn new(model: &Model<f64>, mesh: &Mesh, phi: Vec<Vector2<f64>>) -> Self {
        let mut path = Self {
            nodes: vec![Node::NONE; phi.len()],
            phi,
            final_x: 0.0,
            final_energy: 0.0,
        };
        path.follow(model, mesh);
        path
    }

    /// Solves the state equations for the shapes.
    pub(crate) fn follow(&mut self, model: &Model<f64>, mesh: &Mesh) {
        (self.final_x, self.final_energy) = (0.0, 0.0);
        for element in &mesh.elements {
            self.follow_element(model, element);
        }
    }

    fn follow_element(&mut self, model: &Model<f64>, element: &Element) {
        let rule = element.rule;
        let first = element.first;
        for j in 1..=rule.degree {
            let rate = element.rate(&self.phi, j);
            let (connection, power) = model.connection_and_power(&self.phi[first + j]);
            let node = &mut self.nodes[first + j];
            node.rate = rate;
            node.body = connection * rate;
            (node.connection, node.power) = (connection, power);
        }
        for (j, weight) in (1..=rule.degree).zip(rule.weights()) {
            let turned: f64 = rule
                .integral(j)
                .iter()
                .zip(&self.nodes[first + 1..])
                .map(|(share, node)| share * node.body.z)
                .sum();
            let theta = self.nodes[first].theta + element.length * turned;
            let node = &mut self.nodes[first + j];
            node.theta = theta;
            (node.sin, node.cos) = theta.sin_cos();
            self.final_x += element.length * weight * node.velocity().x;
            self.final_energy += element.length * weight * node.power_spent();
        }
    }

    /// ln E − 2 ln(±x), what is made least; the sign is the wanted one of x. None where x has the other sign.
    pub(crate) fn objective(&self, sign: f64) -> Option<f64> {
        let (x, energy) = (sign * self.final_x, self.final_energy);
        let value = energy.ln() - 2.0 * x.ln();
        (x > 0.0 && energy > 0.0 && value.is_finite()).then_some(value)
    }

    /// x, y and E at every point.
    pub(crate) fn travelled(&self, mesh: &Mesh) -> Vec<[f64; 3]> {
        let mut all = vec![[0.0; 3]; self.phi.len()];
        for element in &mesh.elements {
            let nodes = &self.nodes[element.first + 1..];
            for j in 1..=element.rule.degree {
                let mut here = all[element.first];
                for (share, node) in element.rule.integral(j).iter().zip(nodes) {
                    let velocity = node.velocity();
                    let rates = [velocity.x, velocity.y, node.power_spent()];
                    for (sum, rate) in here.iter_mut().zip(rates) {
                        *sum += element.length * share * rate;
                    }
                }
                all[element.first + j] = here;
            }
        }
        all
    }
}
