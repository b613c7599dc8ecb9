//! A sampled cycle swum along its own samples: poses, connection and power at every node.

use nalgebra::{Vector2, Vector3};
use swimmer_model::{FirstDerivatives, Model};

use super::grid::{Degree, Grid};
use super::stencil;
use crate::momentum::Momentum;
use crate::runge_kutta::{Point, exact_step};

/// One node of the curve, swum.
#[derive(Debug, Clone, Copy)]
pub(super) struct Place {
    pub(super) phi: Vector2<f64>,
    /// dΦ/du.
    pub(super) rate: Vector2<f64>,
    pub(super) first: FirstDerivatives<f64>,
    /// x, y over L and θ, from the first sample.
    pub(super) pose: [f64; 3],
    /// sin θ and cos θ.
    pub(super) heading: (f64, f64),
    /// The root of the power `P = Φ'ᵀWΦ'`.
    pub(super) root_power: f64,
}

impl Place {
    /// The height of one choice of the multipliers here.
    pub(super) fn height(&self, momentum: &Momentum) -> f64 {
        momentum.at(&self.pose).dot(&self.first.curvature())
    }
}

/// The whole cycle.
#[derive(Debug, Clone)]
pub(super) struct Path {
    pub(super) places: Vec<Place>,
    /// ∫√P du to every node.
    pub(super) power_length: Vec<f64>,
}

impl Path {
    /// Swims the curve through these shapes; the model is of the swimmer with L = 1.
    pub(super) fn new(
        model: &Model<f64>,
        grid: &Grid,
        shapes: &[Vector2<f64>],
        degree: Degree,
    ) -> Self {
        let firsts = shapes.iter().map(|phi| model.first_derivatives(phi));
        Self::through(grid, shapes, firsts, degree)
    }

    /// The same path by other polynomials.
    pub(super) fn again(&self, grid: &Grid, shapes: &[Vector2<f64>], degree: Degree) -> Self {
        let firsts = self.places.iter().map(|place| place.first);
        Self::through(grid, shapes, firsts, degree)
    }

    fn through(
        grid: &Grid,
        shapes: &[Vector2<f64>],
        firsts: impl Iterator<Item = FirstDerivatives<f64>>,
        degree: Degree,
    ) -> Self {
        let rates = grid.slopes(shapes, degree);
        let mut places: Vec<Place> = shapes
            .iter()
            .zip(&rates)
            .zip(firsts)
            .map(|((&phi, &rate), first)| Place {
                phi,
                rate,
                first,
                pose: [0.0; 3],
                heading: (0.0, 1.0),
                root_power: rate.dot(&(first.power * rate)).max(0.0).sqrt(),
            })
            .collect();
        let body: Vec<Vector3<f64>> = places
            .iter()
            .map(|place| place.first.connection * place.rate)
            .collect();
        let turning: Vec<f64> = body.iter().map(|rate| rate.z).collect();
        let headings = grid.integrals(&turning, 0.0, degree);
        for (place, theta) in places.iter_mut().zip(&headings) {
            place.heading = theta.sin_cos();
        }
        let velocities = body.iter().zip(&places).map(|(body, place)| {
            let (sin, cos) = place.heading;
            Vector2::new(cos * body.x - sin * body.y, sin * body.x + cos * body.y)
        });
        let velocities: Vec<Vector2<f64>> = velocities.collect();
        let positions = grid.integrals(&velocities, Vector2::zeros(), degree);
        for ((place, position), theta) in places.iter_mut().zip(&positions).zip(&headings) {
            place.pose = [position.x, position.y, *theta];
        }
        let roots: Vec<f64> = places.iter().map(|place| place.root_power).collect();
        Self {
            power_length: grid.integrals(&roots, 0.0, degree),
            places,
        }
    }

    /// Net displacement over L, in the frame of the first sample.
    pub(super) fn displacement(&self) -> Vector2<f64> {
        let [x, y, _] = self.end();
        Vector2::new(x, y)
    }

    /// Net rotation.
    pub(super) fn rotation(&self) -> f64 {
        self.end()[2]
    }

    /// ∮√P du.
    pub(super) fn total_power_length(&self) -> f64 {
        self.power_length.last().copied().unwrap_or_default()
    }

    pub(super) fn end(&self) -> [f64; 3] {
        self.places.last().map_or([0.0; 3], |place| place.pose)
    }

    /// The largest distance between the poses of two paths over the same nodes.
    pub(super) fn pose_distance(&self, other: &Self) -> f64 {
        let distance = |(a, b): (&Place, &Place)| {
            a.pose
                .iter()
                .zip(&b.pose)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, f64::max)
        };
        self.places
            .iter()
            .zip(&other.places)
            .map(distance)
            .fold(0.0, f64::max)
    }
}

/// The net pose once more: (ẋ, ẏ, θ̇) = G(Φ, θ) Φ̇ stepped by the Runge–Kutta method of order eight from sample to sample.
pub(super) fn stepped(model: &Model<f64>, grid: &Grid, shapes: &[Vector2<f64>]) -> [f64; 3] {
    let mut pose = [0.0; 3];
    for node in 0..grid.nodes.len() {
        let (Some(before), Some(stencil)) = (grid.before(node), grid.stencil(node)) else {
            continue;
        };
        let places = grid.places(&stencil);
        let shapes = shapes.get(stencil).unwrap_or_default();
        let rate = |z: &[f64; 4]| {
            let [value, slope] = stencil::derivatives(&places, z[0]);
            let weigh = |weights: &stencil::Weights| {
                shapes
                    .iter()
                    .zip(weights)
                    .fold(Vector2::zeros(), |sum, (shape, weight)| {
                        sum + shape * *weight
                    })
            };
            let (phi, rate): (Vector2<f64>, Vector2<f64>) = (weigh(&value), weigh(&slope));
            let body = model.local_connection(&phi) * rate;
            let (sin, cos) = z[3].sin_cos();
            [
                1.0,
                cos * body.x - sin * body.y,
                sin * body.x + cos * body.y,
                body.z,
            ]
        };
        let u = |node: usize| grid.nodes.get(node).map_or(0.0, |node| node.u);
        let [x, y, theta] = pose;
        let start = Point::new(&rate, [u(before), x, y, theta]);
        let [_, x, y, theta] = exact_step(&rate, &start, u(node) - u(before)).z;
        pose = [x, y, theta];
    }
    pose
}
