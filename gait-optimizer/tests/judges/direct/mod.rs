//! An independent direct method: the quarter gait as a polygon with one degree of freedom a node, climbed on its own swum X.
//!
//! Nodes slide on fixed rays across a rough start, corners along the bound they lie on, the first and last along the
//! diagonals. A projected Newton method with all second differences climbs the final x. From the model it takes A(Φ) alone, from
//! the library's gaits only the order of arcs.

use gait_optimizer::{ArcKind, OptimalGait};
use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::{Model, Swimmer};

use crate::plane::Pose;
use crate::swimmers::Apart;

/// A node: where it is and how it may move.
#[derive(Debug, Clone, Copy)]
struct Node {
    at: Vector2<f64>,
    way: Way,
}

#[derive(Debug, Clone, Copy)]
enum Way {
    Fixed,
    /// Along this direction.
    Ray(Vector2<f64>),
    /// Round the origin on the border of the shapes with links apart.
    Border,
}

pub(crate) struct Direct {
    model: Model<f64>,
    sign: f64,
    max_angle: f64,
    apart: Option<Apart>,
    nodes: Vec<Node>,
    /// `true` if the side after the node follows the border of the shapes with links apart.
    on_border: Vec<bool>,
}

/// Second differences are taken over this \[rad\].
const H: f64 = 1e-3;
/// Sides of a curved border.
const BORDER_SIDES: usize = 400;

impl Direct {
    /// Round a circle's quarter, free of bounds.
    pub(crate) fn from_circle(swimmer: &Swimmer<f64>, radius: f64, intervals: usize) -> Self {
        let nodes: Vec<Node> = (0..=intervals)
            .map(|k| {
                let angle = std::f64::consts::FRAC_PI_4
                    + std::f64::consts::FRAC_PI_2 * k as f64 / intervals as f64;
                let ray = Vector2::new(angle.cos(), angle.sin());
                Node {
                    at: ray * radius,
                    way: Way::Ray(ray),
                }
            })
            .collect();
        Self {
            model: Model::new(&swimmer.of_unit_length()).unwrap(),
            sign: 1.0,
            max_angle: f64::INFINITY,
            apart: None,
            on_border: vec![false; nodes.len()],
            nodes,
        }
    }

    /// With the arcs of a gait, its shape moved off by `off` \[rad\] or more: free arcs bent to alternating sides, corners slid
    /// along their bounds.
    pub(crate) fn off_from(gait: &OptimalGait, off: f64, intervals: usize) -> Self {
        let bounds = &gait.bounds;
        let apart = bounds
            .no_overlap
            .then(|| Apart::new(gait.swimmer.links, bounds.clearance));
        let quarter = gait.u().partition_point(|&u| u < 0.25 - 1e-12);
        let samples = &gait.phi()[..=quarter];
        let mut direct = Self {
            model: Model::new(&gait.swimmer.of_unit_length()).unwrap(),
            sign: gait.displacement_over_length.signum(),
            max_angle: bounds.max_angle.unwrap_or(f64::INFINITY),
            apart,
            nodes: Vec::new(),
            on_border: Vec::new(),
        };
        let last = gait.arcs.len() - 1;
        for (i, arc) in gait.arcs.iter().enumerate() {
            let side = if i % 2 == 0 { 1.0 } else { -1.0 };
            let (from, to) = (Vector2::from(arc.from), Vector2::from(arc.to));
            // The node where the arc begins.
            let before = (i > 0).then(|| gait.arcs[i - 1]);
            let way = match before {
                None if arc.kind == ArcKind::Singular => {
                    Way::Ray(Vector2::new(1.0, 1.0).normalize())
                }
                None => Way::Fixed,
                Some(before) => corner(&before, arc),
            };
            direct.push(from, way, side * off, arc.kind == ArcKind::Clearance);
            if arc.kind == ArcKind::Singular {
                let points = spread(samples, from, to, intervals);
                for k in 1..points.len() - 1 {
                    let along = (points[k + 1] - points[k - 1]).normalize();
                    let ray = Vector2::new(along.y, -along.x);
                    direct.push(points[k], Way::Ray(ray), side * off, false);
                }
            }
            if i == last {
                let way = if arc.kind == ArcKind::Singular {
                    Way::Ray(Vector2::new(-1.0, 1.0).normalize())
                } else {
                    Way::Fixed
                };
                direct.push(to, way, side * off, false);
            }
        }
        direct
    }

    fn push(&mut self, at: Vector2<f64>, way: Way, off: f64, on_border: bool) {
        let node = Node { at, way };
        let moved = self.moved(&node, off);
        self.nodes.push(Node {
            at: self.inside(&node, moved),
            way,
        });
        self.on_border.push(on_border);
    }

    /// Position of a node that moves by t.
    fn moved(&self, node: &Node, t: f64) -> Vector2<f64> {
        match (node.way, &self.apart) {
            (Way::Ray(ray), _) => node.at + ray * t,
            (Way::Border, Some(apart)) => {
                apart.border(node.at.y.atan2(node.at.x) + t / node.at.norm())
            }
            _ => node.at,
        }
    }

    /// The nearest allowed place on the way back from a move.
    fn inside(&self, node: &Node, there: Vector2<f64>) -> Vector2<f64> {
        let allowed = |phi: &Vector2<f64>| {
            phi.amax() <= self.max_angle + 1e-12
                && self.apart.as_ref().is_none_or(|apart| apart.allows(phi))
        };
        if !matches!(node.way, Way::Ray(_)) || allowed(&there) {
            return there;
        }
        let back = node.at - there;
        let (mut low, mut high) = (0.0, 1.0);
        for _ in 0..60 {
            let middle = 0.5 * (low + high);
            if allowed(&(there + back * middle)) {
                high = middle;
            } else {
                low = middle;
            }
        }
        there + back * high
    }

    /// The pose from one node to the next.
    fn side(&self, k: usize, from: Vector2<f64>, to: Vector2<f64>) -> Pose {
        if !self.on_border[k] {
            return Pose::along(&self.model, [from, to]);
        }
        let points = self.border(from, to);
        let sides = points.array_windows();
        let poses = sides.map(|side| Pose::along(&self.model, *side));
        poses.fold(Pose::default(), |pose, side| pose * side)
    }

    fn border(&self, from: Vector2<f64>, to: Vector2<f64>) -> Vec<Vector2<f64>> {
        let apart = self.apart.as_ref().unwrap();
        let angle = |phi: &Vector2<f64>| phi.y.atan2(phi.x);
        let (first, last) = (angle(&from), angle(&to));
        (0..=BORDER_SIDES)
            .map(|i| apart.border(first + (last - first) * i as f64 / BORDER_SIDES as f64))
            .collect()
    }

    /// X over L, signed, by the poses of its sides.
    pub(crate) fn carries(&self) -> f64 {
        4.0 * self.sign * self.value()
    }

    /// λ₃ x at the end of the quarter.
    fn value(&self) -> f64 {
        let whole = (0..self.nodes.len() - 1).fold(Pose::default(), |pose, k| {
            pose * self.side(k, self.nodes[k].at, self.nodes[k + 1].at)
        });
        self.sign * whole.x
    }

    /// Gradient and second derivatives of the value over all moves.
    fn derivatives(&self) -> (DVector<f64>, DMatrix<f64>) {
        let count = self.nodes.len();
        let at = |k: usize, step: usize| self.moved(&self.nodes[k], H * (step as f64 - 1.0));
        // Each side with both ends moved by −H, 0, H.
        let sides: Vec<[[Pose; 3]; 3]> = (0..count - 1)
            .map(|k| {
                std::array::from_fn(|i| {
                    std::array::from_fn(|j| self.side(k, at(k, i), at(k + 1, j)))
                })
            })
            .collect();
        // From each node to the end.
        let mut after = vec![Pose::default(); count];
        for k in (0..count - 1).rev() {
            after[k] = sides[k][1][1] * after[k + 1];
        }
        let mut gradient = DVector::zeros(count);
        let mut second = DMatrix::zeros(count, count);
        // Up to the node before i.
        let mut before = Pose::default();
        for i in 0..count {
            for (a, way) in [(0, -1.0), (2, 1.0)] {
                // Up to the node before j, with node i moved.
                let begun = i.checked_sub(1).map(|side| before * sides[side][1][a]);
                let (mut up, mut from) = (begun.unwrap_or_default(), a);
                for j in i + 1..count {
                    for (b, other) in [(0, -1.0), (2, 1.0)] {
                        let rest = sides.get(j).map(|side| side[b][1] * after[j + 1]);
                        let whole = up * sides[j - 1][from][b] * rest.unwrap_or_default();
                        second[(i, j)] += way * other * whole.x / (4.0 * H * H);
                    }
                    up = up * sides[j - 1][from][1];
                    from = 1;
                }
                gradient[i] += way * up.x / (2.0 * H);
                second[(i, i)] += (up.x - after[0].x) / (H * H);
            }
            if i > 0 {
                before = before * sides[i - 1][1][1];
            }
        }
        second.fill_lower_triangle_with_upper_triangle();
        (gradient * self.sign, second * self.sign)
    }

    /// Climbs until the moves are below 1e-8; returns X over L, signed.
    pub(crate) fn climb(&mut self) -> f64 {
        let mut damping = 1e-2;
        let mut here = self.value();
        for _ in 0..200 {
            let (gradient, second) = self.derivatives();
            // Nodes that rest on a bound and push against it stay.
            let free: Vec<usize> = (0..self.nodes.len())
                .filter(|&k| {
                    let node = &self.nodes[k];
                    let probe = self.moved(node, 1e-7 * gradient[k].signum());
                    !matches!(node.way, Way::Fixed)
                        && (self.inside(node, probe) - node.at).norm() > 5e-8
                })
                .collect();
            let scale = second.amax();
            let matrix = DMatrix::from_fn(free.len(), free.len(), |i, j| {
                let damped = if i == j { damping * scale } else { 0.0 };
                damped - second[(free[i], free[j])]
            });
            let right = DVector::from_fn(free.len(), |i, _| gradient[free[i]]);
            let Some(factors) = matrix.cholesky() else {
                damping = (damping * 4.0).max(1e-6);
                continue;
            };
            let step = factors.solve(&right);
            let kept = self.nodes.clone();
            let mut largest: f64 = 0.0;
            for (i, &k) in free.iter().enumerate() {
                let node = self.nodes[k];
                let there = self.moved(&node, step[i].clamp(-0.1, 0.1));
                self.nodes[k].at = self.inside(&node, there);
                largest = largest.max((self.nodes[k].at - node.at).norm());
            }
            let value = self.value();
            if value >= here - 1e-15 {
                here = value;
                damping *= 0.2;
                if largest < 1e-8 {
                    break;
                }
            } else {
                self.nodes = kept;
                damping = (damping * 10.0).max(1e-6);
                if damping > 1e6 {
                    break;
                }
            }
        }
        self.carries()
    }
}

/// Admissible motion of the corner between two arcs: along the bound that one of them runs along; fixed between two bounds.
fn corner(before: &gait_optimizer::Arc, after: &gait_optimizer::Arc) -> Way {
    let bound = match (before.kind, after.kind) {
        (ArcKind::Singular, ArcKind::Clearance) | (ArcKind::Clearance, ArcKind::Singular) => {
            return Way::Border;
        }
        (ArcKind::Singular, _) => after,
        (_, ArcKind::Singular) => before,
        _ => return Way::Fixed,
    };
    let way = Vector2::from(bound.to) - Vector2::from(bound.from);
    Way::Ray(way.normalize())
}

/// Points spread evenly over the samples from one place to another.
fn spread(
    samples: &[Vector2<f64>],
    from: Vector2<f64>,
    to: Vector2<f64>,
    intervals: usize,
) -> Vec<Vector2<f64>> {
    let nearest = |place: Vector2<f64>| {
        let apart = |k: usize| (samples[k] - place).norm();
        let places = 0..samples.len();
        places
            .min_by(|&a, &b| apart(a).total_cmp(&apart(b)))
            .unwrap()
    };
    let arc = &samples[nearest(from)..=nearest(to)];
    let mut way = vec![0.0];
    for [from, to] in arc.array_windows() {
        way.push(way[way.len() - 1] + (to - from).norm());
    }
    let whole = way[way.len() - 1];
    (0..=intervals)
        .map(|k| {
            let along = whole * k as f64 / intervals as f64;
            let next = way.partition_point(|&w| w < along).clamp(1, arc.len() - 1);
            let share = (along - way[next - 1]) / (way[next] - way[next - 1]);
            arc[next - 1] + (arc[next] - arc[next - 1]) * share
        })
        .collect()
}
