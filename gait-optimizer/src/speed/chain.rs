//! Closed chain of arcs: net displacement, rotation and mean heading, with gradient and Hessian.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::Model;

use super::arc::{ArcPoint, Jet, MOST_PARAMETERS, Shape};
use super::quadrature::Rule;

/// Layout of a chain's unknowns in one vector: corners (2n), times of the arcs (n), then the bends of each arc.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    pub(crate) shapes: Vec<Shape>,
    /// Index of the first bend of each arc.
    bends_at: Vec<usize>,
    pub(crate) size: usize,
}

impl Layout {
    pub(crate) fn new(shapes: Vec<Shape>) -> Self {
        let mut size = 3 * shapes.len();
        let mut bends_at = Vec::with_capacity(shapes.len());
        for shape in &shapes {
            bends_at.push(size);
            size += shape.bends();
        }
        Self {
            shapes,
            bends_at,
            size,
        }
    }

    /// Returns a chain of arcs of one shape from corner to corner, with no bends and with the times that `time` returns.
    pub(crate) fn of_corners(
        corners: &[Vector2<f64>],
        shape: Shape,
        time: impl Fn(usize, [Vector2<f64>; 2]) -> f64,
    ) -> (Self, DVector<f64>) {
        let layout = Self::new(vec![shape; corners.len()]);
        let mut z = DVector::zeros(layout.size);
        for (k, corner) in corners.iter().enumerate() {
            let next = corners[(k + 1) % corners.len()];
            z.fixed_rows_mut::<2>(2 * k).copy_from(corner);
            z[layout.time_index(k)] = time(k, [*corner, next]);
        }
        (layout, z)
    }

    pub(crate) fn arcs(&self) -> usize {
        self.shapes.len()
    }

    /// Index of the first coordinate of a corner.
    pub(crate) fn corner_index(&self, corner: usize) -> usize {
        2 * (corner % self.arcs())
    }

    pub(crate) fn corner(&self, z: &DVector<f64>, corner: usize) -> Vector2<f64> {
        let at = self.corner_index(corner);
        Vector2::new(z[at], z[at + 1])
    }

    pub(crate) fn time_index(&self, arc: usize) -> usize {
        2 * self.arcs() + arc
    }

    /// Indices of all times.
    pub(crate) fn times(&self) -> Range<usize> {
        2 * self.arcs()..3 * self.arcs()
    }

    pub(crate) fn bends_index(&self, arc: usize) -> usize {
        self.bends_at[arc]
    }

    pub(crate) fn period(&self, z: &DVector<f64>) -> f64 {
        (0..self.arcs()).map(|arc| z[self.time_index(arc)]).sum()
    }

    pub(crate) fn ends(&self, z: &DVector<f64>, arc: usize) -> [Vector2<f64>; 2] {
        [self.corner(z, arc), self.corner(z, arc + 1)]
    }

    pub(crate) fn bends<'z>(&self, z: &'z DVector<f64>, arc: usize) -> &'z [f64] {
        let from = self.bends_at[arc];
        z.as_slice()
            .get(from..from + self.shapes[arc].bends())
            .unwrap_or_default()
    }

    /// Returns the point of an arc at s in \[0, 1\].
    pub(crate) fn place(&self, z: &DVector<f64>, arc: usize, s: f64) -> ArcPoint<MOST_PARAMETERS> {
        self.shapes[arc].place(&self.ends(z, arc), self.bends(z, arc), s)
    }

    pub(crate) fn jet(&self, model: &Model<f64>, rule: &Rule, z: &DVector<f64>, arc: usize) -> Jet {
        self.shapes[arc].jet(model, rule, &self.ends(z, arc), self.bends(z, arc))
    }

    pub(crate) fn jets(&self, model: &Model<f64>, rule: &Rule, z: &DVector<f64>) -> Vec<Jet> {
        (0..self.arcs())
            .map(|arc| self.jet(model, rule, z, arc))
            .collect()
    }

    /// Returns the pose before each arc, and the net motion of the chain.
    pub(crate) fn net(
        &self,
        model: &Model<f64>,
        rule: &Rule,
        z: &DVector<f64>,
    ) -> (Vec<[f64; 3]>, Net) {
        let value = |arc: usize| {
            self.shapes[arc].value(model, rule, &self.ends(z, arc), self.bends(z, arc))
        };
        net((0..self.arcs()).map(value), &z.as_slice()[self.times()])
    }

    /// Index of a parameter of an arc.
    pub(crate) fn parameter_index(&self, arc: usize, parameter: usize) -> usize {
        match parameter {
            0 | 1 => self.corner_index(arc) + parameter,
            2 | 3 => self.corner_index(arc + 1) + parameter - 2,
            bend => self.bends_at[arc] + bend - 4,
        }
    }
}

/// Net motion of a chain.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Net {
    pub(crate) displacement: Vector2<f64>,
    pub(crate) rotation: f64,
    /// Time average of θ, relative to θ at the first corner.
    pub(crate) mean_heading: f64,
}

impl Net {
    pub(crate) fn distance(&self) -> f64 {
        self.displacement.norm()
    }

    /// Direction of the displacement relative to the mean heading.
    pub(crate) fn heading(&self) -> f64 {
        self.displacement.y.atan2(self.displacement.x) - self.mean_heading
    }
}

/// Weights of ln |d|, rotation and heading.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Weights {
    pub(crate) log_distance: f64,
    pub(crate) rotation: f64,
    pub(crate) heading: f64,
}

/// Returns the pose before each arc, and the net motion; `times` are those of the arcs.
fn net(values: impl Iterator<Item = [f64; 4]>, times: &[f64]) -> (Vec<[f64; 3]>, Net) {
    let mut pose = [0.0; 3];
    let mut before = Vec::with_capacity(times.len());
    let (mut heading, mut period) = (0.0, 0.0);
    for ([x, y, theta, mean], time) in values.zip(times) {
        before.push(pose);
        heading += time * (pose[2] + mean);
        period += time;
        let (sin, cos) = pose[2].sin_cos();
        pose[0] += cos * x - sin * y;
        pose[1] += sin * x + cos * y;
        pose[2] += theta;
    }
    let net = Net {
        displacement: Vector2::new(pose[0], pose[1]),
        rotation: pose[2],
        mean_heading: heading / period,
    };
    (before, net)
}

/// Derivatives of the weighted sum of ln |d|, rotation and heading with respect to the motion over each arc.
struct Pulls {
    net: Net,
    /// Direction of d, and |d|.
    unit: Vector2<f64>,
    distance: f64,
    /// Derivative of the sum with respect to d.
    pull: Vector2<f64>,
    period: f64,
    arcs: Vec<ArcPull>,
}

/// Derivatives with respect to the motion over one arc.
struct ArcPull {
    /// Sine and cosine of the heading before the arc.
    turn: (f64, f64),
    theta: f64,
    /// Displacement after the arc.
    after: Vector2<f64>,
    /// Derivatives with respect to its x, y, θ and mean heading.
    of_value: [f64; 4],
}

impl Pulls {
    fn new(jets: &[Jet], times: &[f64], weights: Weights) -> Self {
        let (before, net) = net(jets.iter().map(|jet| jet.value), times);
        let d = net.displacement;
        let distance = d.norm().max(f64::MIN_POSITIVE);
        let unit = d / distance;
        let pull =
            (unit * weights.log_distance + perpendicular(&unit) * weights.heading) / distance;
        let period: f64 = times.iter().sum();
        let mut time_after = period;
        let arcs = before.iter().enumerate().map(|(arc, pose)| {
            time_after -= times[arc];
            let (sin, cos) = pose[2].sin_cos();
            let after = match before.get(arc + 1) {
                Some(next) => d - Vector2::new(next[0], next[1]),
                None => Vector2::zeros(),
            };
            let of_turn = pull.dot(&perpendicular(&after)) + weights.rotation
                - weights.heading * time_after / period;
            ArcPull {
                turn: (sin, cos),
                theta: pose[2],
                after,
                of_value: [
                    cos * pull.x + sin * pull.y,
                    cos * pull.y - sin * pull.x,
                    of_turn,
                    -weights.heading * times[arc] / period,
                ],
            }
        });
        Self {
            arcs: arcs.collect(),
            net,
            unit,
            distance,
            pull,
            period,
        }
    }
}

fn perpendicular(v: &Vector2<f64>) -> Vector2<f64> {
    Vector2::new(-v.y, v.x)
}

/// Gradient of a weighted sum of ln |d|, rotation and heading.
pub(crate) fn gradient(
    layout: &Layout,
    jets: &[Jet],
    z: &DVector<f64>,
    weights: Weights,
) -> (Net, DVector<f64>) {
    let pulls = Pulls::new(jets, &z.as_slice()[layout.times()], weights);
    let mut gradient = DVector::zeros(layout.size);
    for (arc, (jet, pull)) in jets.iter().zip(&pulls.arcs).enumerate() {
        for p in 0..4 + layout.shapes[arc].bends() {
            let slope = &jet.slopes[p];
            let sum: f64 = slope.iter().zip(&pull.of_value).map(|(s, v)| s * v).sum();
            gradient[layout.parameter_index(arc, p)] += sum;
        }
        gradient[layout.time_index(arc)] -=
            weights.heading * (pull.theta + jet.value[3] - pulls.net.mean_heading) / pulls.period;
    }
    (pulls.net, gradient)
}

/// Hessian of the weighted sum.
pub(crate) fn hessian(
    (layout, model, rule): (&Layout, &Model<f64>, &Rule),
    jets: &[Jet],
    z: &DVector<f64>,
    weights: Weights,
) -> DMatrix<f64> {
    let times = &z.as_slice()[layout.times()];
    let pulls = Pulls::new(jets, times, weights);
    let size = layout.size;
    let mut hessian = DMatrix::zeros(size, size);
    // Gradients of the displacement along and across itself, of the heading before an arc, and of the mean heading.
    let (mut along, mut across) = (DVector::zeros(size), DVector::zeros(size));
    let mut headings = DVector::<f64>::zeros(size);
    let mut mean = DVector::<f64>::zeros(size);
    // For each arc, gradient of the heading before it plus its own mean.
    let mut of_times = Vec::new();
    for (arc, (jet, pull)) in jets.iter().zip(&pulls.arcs).enumerate() {
        let index = |p: usize| layout.parameter_index(arc, p);
        let (sin, cos) = pull.turn;
        let parameters = 4 + layout.shapes[arc].bends();
        let beyond = pulls.pull.dot(&pull.after);
        for p in 0..parameters {
            let [x, y, theta, _] = jet.slopes[p];
            let moved = Vector2::new(cos * x - sin * y, sin * x + cos * y);
            let d = moved + perpendicular(&pull.after) * theta;
            along[index(p)] += d.dot(&pulls.unit);
            across[index(p)] += d.dot(&perpendicular(&pulls.unit));
            // The displacement over this arc rotates with the heading before it.
            let turned = pulls.pull.dot(&perpendicular(&moved)) - beyond * theta;
            let column = index(p);
            let moving = headings.iter().enumerate();
            for (row, heading) in moving.filter(|(_, heading)| **heading != 0.0) {
                hessian[(row, column)] += heading * turned;
                hessian[(column, row)] += heading * turned;
            }
        }
        let at = (&layout.ends(z, arc), layout.bends(z, arc));
        layout.shapes[arc].curvature((model, rule), at, &pull.of_value, |p, q, value| {
            let value = value - beyond * jet.slopes[p][2] * jet.slopes[q][2];
            let (row, column) = (index(p), index(q));
            hessian[(row, column)] += value;
            if p != q {
                hessian[(column, row)] += value;
            }
        });
        if weights.heading != 0.0 {
            let mut of_time = headings.clone();
            for p in 0..parameters {
                of_time[index(p)] += jet.slopes[p][3];
            }
            mean.axpy(times[arc] / pulls.period, &of_time, 1.0);
            of_times.push(of_time);
        }
        for p in 0..parameters {
            headings[index(p)] += jet.slopes[p][2];
        }
    }
    let square = pulls.distance * pulls.distance;
    let stretch = weights.log_distance / square;
    hessian.ger(stretch, &across, &across, 1.0);
    hessian.ger(-stretch, &along, &along, 1.0);
    if weights.heading != 0.0 {
        let turn = -weights.heading / square;
        hessian.ger(turn, &along, &across, 1.0);
        hessian.ger(turn, &across, &along, 1.0);
        add_mean_heading(
            (layout, &pulls),
            jets,
            (&of_times, &mean),
            weights,
            &mut hessian,
        );
    }
    hessian
}

/// Adds the second derivatives of the mean heading that involve times.
fn add_mean_heading(
    (layout, pulls): (&Layout, &Pulls),
    jets: &[Jet],
    (of_times, mean): (&[DVector<f64>], &DVector<f64>),
    weights: Weights,
    hessian: &mut DMatrix<f64>,
) {
    let off = |arc: usize| pulls.arcs[arc].theta + jets[arc].value[3] - pulls.net.mean_heading;
    let share = weights.heading / pulls.period;
    for (arc, of_time) in of_times.iter().enumerate() {
        let time = layout.time_index(arc);
        for other in 0..of_times.len() {
            let both = share / pulls.period * (off(arc) + off(other));
            hessian[(time, layout.time_index(other))] += both;
        }
        for (row, (here, mean)) in of_time.iter().zip(mean).enumerate() {
            let mixed = share * (here - mean);
            hessian[(row, time)] -= mixed;
            hessian[(time, row)] -= mixed;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::region::{Clearance, Piece};
    use swimmer_model::Swimmer;

    #[test]
    fn second_derivatives_are_differences_of_the_gradient() {
        let model = Model::new(&Swimmer::<f64>::robot().of_unit_length()).unwrap();
        let links = swimmer_model::Links {
            middle: 0.2,
            front: 0.4,
            back: 0.4,
        };
        let clearance = Shape::Along {
            clearance: Clearance::new(&links, 0.02).unwrap(),
            piece: Piece::Tip(0),
            pace: 0,
        };
        let bent = Shape::Bent { joint: 1, bends: 3 };
        let layout = Layout::new(vec![Shape::Straight, bent, clearance, Shape::Straight]);
        let mut z = DVector::zeros(layout.size);
        let corners = [1.4, 0.3, 0.2, 1.1, 0.9, 2.3, 1.4, 1.9];
        z.as_mut_slice()[..8].copy_from_slice(&corners);
        for (k, value) in [0.7, 1.1, 0.6, 0.9, 0.1, -0.05, 0.02]
            .into_iter()
            .enumerate()
        {
            z[8 + k] = value;
        }
        let rule = Rule::new(20);
        for weights in [[1.0, 0.0, 0.0], [-0.7, 0.4, 0.0], [0.6, 0.3, -0.8]] {
            let weights = Weights {
                log_distance: weights[0],
                rotation: weights[1],
                heading: weights[2],
            };
            let slope = |z: &DVector<f64>| {
                let jets = layout.jets(&model, &rule, z);
                gradient(&layout, &jets, z, weights).1
            };
            let jets = layout.jets(&model, &rule, &z);
            let exact = hessian((&layout, &model, &rule), &jets, &z, weights);
            for k in 0..layout.size {
                let (mut up, mut down) = (z.clone(), z.clone());
                up[k] += 1e-5;
                down[k] -= 1e-5;
                let column = (slope(&up) - slope(&down)) / 2e-5;
                let off = (column - exact.column(k)).amax();
                assert!(off < 1e-6 * exact.amax(), "{weights:?} {k} {off}");
            }
        }
    }
}
