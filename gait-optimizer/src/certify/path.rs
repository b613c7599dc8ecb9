//! Integration of a sampled cycle along its samples: poses, connection and power at every node.

use nalgebra::{SVector, Vector2, Vector3};
use swimmer_model::{FirstDerivatives, Model};

use super::grid::{Degree, Grid};
use super::stencil;
use crate::momentum::Momentum;
use crate::numerics::worse;
use crate::runge_kutta::{Point, exact_step};

/// Values at a node of the curve.
#[derive(Debug, Clone, Copy)]
pub(super) struct CurveNode {
    pub(super) phi: Vector2<f64>,
    /// dΦ/du.
    pub(super) rate: Vector2<f64>,
    /// d²Φ/du².
    pub(super) bend: Vector2<f64>,
    pub(super) first: FirstDerivatives<f64>,
    /// x, y over L and θ, from the first sample.
    pub(super) pose: [f64; 3],
    /// sin θ and cos θ.
    pub(super) heading: (f64, f64),
    /// Square root of the power `P = Φ'ᵀWΦ'`.
    pub(super) root_power: f64,
}

impl CurveNode {
    /// Derivative of the pose by u.
    fn velocity(&self) -> Vector3<f64> {
        let body = self.first.connection * self.rate;
        let (sin, cos) = self.heading;
        Vector3::new(
            cos * body.x - sin * body.y,
            sin * body.x + cos * body.y,
            body.z,
        )
    }

    /// Unit vector to the right of the motion.
    pub(super) fn right(&self) -> Vector2<f64> {
        Vector2::new(self.rate.y, -self.rate.x).normalize()
    }

    /// Shape, rate and pose, with their derivatives.
    fn state(&self) -> [SVector<f64, 7>; 2] {
        let Self {
            phi, rate, bend, ..
        } = self;
        let ([x, y, theta], moves) = (self.pose, self.velocity());
        [
            [phi.x, phi.y, rate.x, rate.y, x, y, theta].into(),
            [rate.x, rate.y, bend.x, bend.y, moves.x, moves.y, moves.z].into(),
        ]
    }

    /// Height for given multipliers.
    pub(super) fn height(&self, momentum: &Momentum) -> f64 {
        momentum.at(&self.pose).dot(&self.first.curvature())
    }
}

/// Values between nodes.
pub(super) struct CurvePoint {
    pub(super) phi: Vector2<f64>,
    /// dΦ/du.
    pub(super) rate: Vector2<f64>,
    /// d²Φ/du².
    pub(super) bend: Vector2<f64>,
    pub(super) pose: [f64; 3],
}

/// The whole cycle.
#[derive(Debug, Clone)]
pub(super) struct Path {
    pub(super) places: Vec<CurveNode>,
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
        let (rates, bends) = (grid.slopes(shapes, degree), grid.bends(shapes, degree));
        let mut places: Vec<CurveNode> = shapes
            .iter()
            .zip(rates.iter().zip(&bends))
            .zip(firsts)
            .map(|((&phi, (&rate, &bend)), first)| CurveNode {
                phi,
                rate,
                bend,
                first,
                pose: [0.0; 3],
                heading: (0.0, 1.0),
                root_power: rate.dot(&(first.power * rate)).max(0.0).sqrt(),
            })
            .collect();
        // Turning is the same in every frame.
        let turning: Vec<f64> = places.iter().map(|place| place.velocity().z).collect();
        let headings = grid.integrals(&turning, 0.0, degree);
        for (place, theta) in places.iter_mut().zip(&headings) {
            place.heading = theta.sin_cos();
        }
        let velocities: Vec<Vector2<f64>> =
            places.iter().map(|place| place.velocity().xy()).collect();
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

    /// At u, by the cubic through values and slopes at the nodes on either side; none beyond the last.
    pub(super) fn between(&self, grid: &Grid, u: f64) -> Option<CurvePoint> {
        let after = grid.nodes.partition_point(|node| node.u < u).max(1);
        let before = grid.before(after)?;
        let from = grid.nodes.get(before)?.u;
        let width = grid.nodes.get(after)?.u - from;
        let ([p, a], [q, b]) = (
            self.places.get(before)?.state(),
            self.places.get(after)?.state(),
        );
        let (t, way) = ((u - from) / width, q - p);
        // p + a w t + β t² + γ t³, w the width.
        let beta = way * 3.0 - (a * 2.0 + b) * width;
        let gamma = (a + b) * width - way * 2.0;
        let here = p + a * (width * t) + (beta + gamma * t) * (t * t);
        let change = a + (beta * 2.0 + gamma * (3.0 * t)) * (t / width);
        Some(CurvePoint {
            phi: here.fixed_rows::<2>(0).into(),
            rate: here.fixed_rows::<2>(2).into(),
            bend: change.fixed_rows::<2>(2).into(),
            pose: [here[4], here[5], here[6]],
        })
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

    /// Largest distance between the poses of two paths over the same nodes.
    pub(super) fn pose_distance(&self, other: &Self) -> f64 {
        let distance = |(a, b): (&CurveNode, &CurveNode)| {
            a.pose
                .iter()
                .zip(&b.pose)
                .map(|(a, b)| (a - b).abs())
                .fold(0.0, worse)
        };
        self.places
            .iter()
            .zip(&other.places)
            .map(distance)
            .fold(0.0, worse)
    }
}

/// Approximate number of steps of a densely sampled cycle; the next constant is the largest number of sample intervals per step.
const STEPS: usize = 256;
const LONGEST_STEP: usize = 4;

/// Net pose by a second method: (ẋ, ẏ, θ̇) = G(Φ, θ) Φ̇, integrated by the Runge–Kutta method of order eight along the samples.
pub(super) fn stepped(model: &Model<f64>, grid: &Grid, shapes: &[Vector2<f64>]) -> [f64; 3] {
    let stride = (grid.nodes.len() / STEPS).clamp(1, LONGEST_STEP);
    let u = |node: usize| grid.nodes.get(node).map_or(0.0, |node| node.u);
    let ends = grid.pieces.iter().flat_map(|piece| {
        let (first, last) = (*piece.nodes.start(), *piece.nodes.end());
        let steps = (first..last).step_by(stride);
        steps.map(move |from| (first, from, (from + stride).min(last), last))
    });
    ends.fold([0.0; 3], |[x, y, theta], (first, from, to, last)| {
        let (low, width) = stencil::around(from - first, to - first, last + 1 - first, 0);
        let stencil = first + low..=first + low + width - 1;
        let places = grid.places(&stencil);
        let shapes = shapes.get(stencil).unwrap_or_default();
        let rate = |z: &[f64; 4]| {
            let [value, slope] = stencil::derivatives(&places, z[0]);
            let weigh = |weights: &stencil::Weights| -> Vector2<f64> {
                let terms = shapes.iter().zip(weights);
                terms.map(|(shape, weight)| shape * *weight).sum()
            };
            let body = model.local_connection(&weigh(&value)) * weigh(&slope);
            let (sin, cos) = z[3].sin_cos();
            [
                1.0,
                cos * body.x - sin * body.y,
                sin * body.x + cos * body.y,
                body.z,
            ]
        };
        let start = Point::new(&rate, [u(from), x, y, theta]);
        let [_, x, y, theta] = exact_step(&rate, &start, u(to) - u(from)).z;
        [x, y, theta]
    })
}
