//! An independent direct method: the quarter gait as a polygon with one degree of freedom a node, climbed on the swum X.
//!
//! Nodes slide on fixed rays across a rough guess, the first along φ₁ = φ₂ and the last along φ₁ = −φ₂. Each sweep
//! moves every node by a damped Newton step on its own, from differences of the swum displacement; bounds clip the node. It
//! shares nothing with the arcs but the model's cycle integration.

use nalgebra::Vector2;
use swimmer_files::AnyGait;
use swimmer_model::{Model, Swimmer, Tolerance, swim};

pub(crate) struct Direct {
    model: Model<f64>,
    length: f64,
    max_angle: f64,
    nodes: Vec<Vector2<f64>>,
    rays: Vec<Vector2<f64>>,
}

/// A node and the direction it may slide in.
pub(crate) type Node = (Vector2<f64>, Vector2<f64>);

/// Nodes evenly spread on the polyline through `guess`, with rays from a centre at (0, `centre`).
pub(crate) fn fan(guess: &[[f64; 2]], centre: f64, intervals: usize) -> Vec<Node> {
    let guess: Vec<Vector2<f64>> = guess.iter().map(|&point| point.into()).collect();
    let whole: f64 = guess
        .windows(2)
        .map(|side| (side[1] - side[0]).norm())
        .sum();
    (0..=intervals)
        .map(|k| along(&guess, whole * k as f64 / intervals as f64))
        .map(|node| (node, (node - Vector2::new(0.0, centre)).normalize()))
        .collect()
}

/// Nodes evenly spread on the straight line between two points, its last one left out, all with the same ray.
pub(crate) fn row(from: [f64; 2], to: [f64; 2], ray: [f64; 2], intervals: usize) -> Vec<Node> {
    let (from, to) = (Vector2::from(from), Vector2::from(to));
    (0..intervals)
        .map(|k| {
            (
                from + (to - from) * (k as f64 / intervals as f64),
                ray.into(),
            )
        })
        .collect()
}

impl Direct {
    /// Starts from these nodes, the first on φ₁ = φ₂ and the last on φ₁ = −φ₂; those two slide along these lines.
    pub(crate) fn new(swimmer: &Swimmer<f64>, max_angle: f64, start: Vec<Node>) -> Self {
        let (nodes, mut rays): (Vec<_>, Vec<_>) = start.into_iter().unzip();
        let last = rays.len() - 1;
        rays[0] = Vector2::new(1.0, 1.0).normalize();
        rays[last] = Vector2::new(-1.0, 1.0).normalize();
        let model = Model::new(swimmer).unwrap();
        Self {
            model,
            length: swimmer.total_length(),
            max_angle,
            nodes,
            rays,
        }
    }

    /// X over L of the closed polygon through these quarter nodes and their images.
    fn displacement(&self, quarter: &[Vector2<f64>]) -> f64 {
        let last = quarter.len() - 1;
        let mut phi: Vec<Vector2<f64>> = quarter.to_vec();
        phi.extend(
            quarter[..last]
                .iter()
                .rev()
                .map(|p| Vector2::new(-p.y, -p.x)),
        );
        phi.pop();
        phi.extend(phi.clone().iter().map(|p| -p));
        let u: Vec<f64> = (0..phi.len())
            .map(|k| k as f64 / phi.len() as f64)
            .collect();
        // A corner at every knot: straight sides.
        let corners: Vec<usize> = (0..phi.len()).collect();
        let gait = AnyGait::from_samples(&u, &phi, &corners).unwrap();
        let stroke = swim(&self.model, &gait, &Tolerance::new(1e-10));
        stroke.displacement.x / self.length
    }

    /// Climbs until no node moves more than 1e-6; returns X over L.
    pub(crate) fn climb(&mut self) -> f64 {
        const H: f64 = 1e-3;
        for _ in 0..60 {
            let here = self.displacement(&self.nodes);
            let mut largest: f64 = 0.0;
            let moved: Vec<_> = (0..self.nodes.len())
                .map(|k| {
                    let at = |h: f64| {
                        let mut nodes = self.nodes.clone();
                        nodes[k] += self.rays[k] * h;
                        self.displacement(&nodes)
                    };
                    let (plus, minus) = (at(H), at(-H));
                    let slope = (plus - minus) / (2.0 * H);
                    let bend = (plus - 2.0 * here + minus) / (H * H);
                    let newton = if bend < 0.0 {
                        -0.6 * slope / bend
                    } else {
                        0.01 * slope.signum()
                    };
                    let next =
                        self.inside(self.nodes[k] + self.rays[k] * newton.clamp(-0.05, 0.05), k);
                    largest = largest.max((next - self.nodes[k]).norm());
                    next
                })
                .collect();
            self.nodes = moved;
            if largest < 1e-6 {
                break;
            }
        }
        self.displacement(&self.nodes)
    }

    /// Pulls a node back along its ray to `|φᵢ| ≤ φ_max`.
    fn inside(&self, node: Vector2<f64>, k: usize) -> Vector2<f64> {
        let ray = self.rays[k];
        (0..2).fold(node, |node, i| {
            let excess = node[i].abs() - self.max_angle;
            let towards = ray[i] * node[i].signum();
            if excess > 0.0 && towards != 0.0 {
                node - ray * (excess / towards)
            } else {
                node
            }
        })
    }
}

/// The point of a polyline this far along it.
fn along(polyline: &[Vector2<f64>], mut way: f64) -> Vector2<f64> {
    for side in polyline.windows(2) {
        let length = (side[1] - side[0]).norm();
        if way <= length {
            return side[0] + (side[1] - side[0]) * (way / length);
        }
        way -= length;
    }
    polyline[polyline.len() - 1]
}
