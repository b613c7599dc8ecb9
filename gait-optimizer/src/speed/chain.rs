//! A closed chain of arcs: its net displacement, rotation and mean heading, with their slopes.

use std::ops::Range;

use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::Model;

use super::arc::{Jet, MOST_PARAMETERS, Place, Shape};
use super::quadrature::Rule;

/// How a chain is written as one vector: the corners (2n), the times of the arcs (n), then the bends of each.
#[derive(Debug, Clone)]
pub(crate) struct Layout {
    pub(crate) shapes: Vec<Shape>,
    /// Where the bends of each arc begin.
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

    /// Arcs of one shape from corner to corner that do not bend yet, each with the time that its number and its ends tell.
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

    /// Index of a corner's first coordinate.
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

    /// The shape at a share of the period, modulo 1.
    pub(crate) fn at(&self, z: &DVector<f64>, share: f64) -> Vector2<f64> {
        let mut left = share.rem_euclid(1.0) * self.period(z);
        for arc in 0..self.arcs() {
            let time = z[self.time_index(arc)];
            if left <= time {
                return self.place(z, arc, left / time).phi;
            }
            left -= time;
        }
        self.corner(z, 0)
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

    /// A place on an arc, s in \[0, 1\].
    pub(crate) fn place(&self, z: &DVector<f64>, arc: usize, s: f64) -> Place<MOST_PARAMETERS> {
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

    /// Poses before each arc, and what the chain brings.
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

    /// Index of an arc's parameter.
    pub(crate) fn parameter_index(&self, arc: usize, parameter: usize) -> usize {
        match parameter {
            0 | 1 => self.corner_index(arc) + parameter,
            2 | 3 => self.corner_index(arc + 1) + parameter - 2,
            bend => self.bends_at[arc] + bend - 4,
        }
    }

    /// The arcs that a coordinate is a parameter of: two for a corner, one for bends, none for times.
    fn arcs_of(&self, index: usize) -> [Option<usize>; 2] {
        let arcs = self.arcs();
        if index < 2 * arcs {
            let corner = index / 2;
            return [Some((corner + arcs - 1) % arcs), Some(corner)];
        }
        if index < 3 * arcs {
            return [None, None];
        }
        [
            Some(self.bends_at.partition_point(|&at| at <= index) - 1),
            None,
        ]
    }
}

/// What a chain brings.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Net {
    pub(crate) displacement: Vector2<f64>,
    pub(crate) rotation: f64,
    /// Mean of θ over the time, against θ at the first corner.
    pub(crate) mean_heading: f64,
}

impl Net {
    pub(crate) fn distance(&self) -> f64 {
        self.displacement.norm()
    }

    /// Of the displacement against the mean heading.
    pub(crate) fn heading(&self) -> f64 {
        self.displacement.y.atan2(self.displacement.x) - self.mean_heading
    }
}

/// Weights of ln |d|, rotation and heading in a sum.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Weights {
    pub(crate) log_distance: f64,
    pub(crate) rotation: f64,
    pub(crate) heading: f64,
}

/// Poses before each arc, and what the chain brings; `times` per arc.
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

/// Gradient of a weighted sum of ln |d|, rotation and heading.
pub(crate) fn gradient(
    layout: &Layout,
    jets: &[Jet],
    z: &DVector<f64>,
    weights: Weights,
) -> (Net, DVector<f64>) {
    let times = &z.as_slice()[layout.times()];
    let (before, net) = net(jets.iter().map(|jet| jet.value), times);
    let d = net.displacement;
    let distance = d.norm();
    let period: f64 = times.iter().sum();
    let unit = d / distance.max(f64::MIN_POSITIVE);
    // ∂(sum)/∂d in the world's frame.
    let pull = (unit * weights.log_distance + Vector2::new(-unit.y, unit.x) * weights.heading)
        / distance.max(f64::MIN_POSITIVE);
    let mut gradient = DVector::zeros(layout.size);
    let mut time_after = period;
    for (arc, jet) in jets.iter().enumerate() {
        let theta = before[arc][2];
        let (sin, cos) = theta.sin_cos();
        time_after -= times[arc];
        let after = match before.get(arc + 1) {
            Some(next) => d - Vector2::new(next[0], next[1]),
            None => Vector2::zeros(),
        };
        let of_turn = pull.dot(&Vector2::new(-after.y, after.x)) + weights.rotation
            - weights.heading * time_after / period;
        let of_value = [
            cos * pull.x + sin * pull.y,
            cos * pull.y - sin * pull.x,
            of_turn,
            -weights.heading * times[arc] / period,
        ];
        for p in 0..4 + layout.shapes[arc].bends() {
            let slope = &jet.slopes[p];
            let sum: f64 = slope.iter().zip(&of_value).map(|(s, v)| s * v).sum();
            gradient[layout.parameter_index(arc, p)] += sum;
        }
        gradient[layout.time_index(arc)] -=
            weights.heading * (theta + jet.value[3] - net.mean_heading) / period;
    }
    (net, gradient)
}

/// Second derivatives of the weighted sum, by central (or one-sided) differences of its gradient.
pub(crate) fn hessian(
    (layout, model, rule): (&Layout, &Model<f64>, &Rule),
    jets: &[Jet],
    z: &DVector<f64>,
    weights: Weights,
    central: bool,
) -> DMatrix<f64> {
    let step = if central { 2e-5 } else { 1e-6 };
    let mut jets = jets.to_vec();
    let mut z = z.clone();
    let (_, here) = gradient(layout, &jets, &z, weights);
    let mut hessian = DMatrix::zeros(layout.size, layout.size);
    for index in 0..layout.size {
        let touched = layout.arcs_of(index);
        if touched[0].is_none() && weights.heading == 0.0 {
            continue;
        }
        let kept = touched.map(|arc| arc.map(|arc| jets[arc]));
        let value = z[index];
        let mut moved = |to: f64| {
            z[index] = to;
            for arc in touched.into_iter().flatten() {
                jets[arc] = layout.jet(model, rule, &z, arc);
            }
            gradient(layout, &jets, &z, weights).1
        };
        let up = moved(value + step);
        let column = if central {
            (up - moved(value - step)) / (2.0 * step)
        } else {
            (up - &here) / step
        };
        z[index] = value;
        for (arc, jet) in touched.into_iter().zip(kept) {
            if let (Some(arc), Some(jet)) = (arc, jet) {
                jets[arc] = jet;
            }
        }
        hessian.set_column(index, &column);
    }
    let transposed = hessian.transpose();
    (hessian + transposed) * 0.5
}
