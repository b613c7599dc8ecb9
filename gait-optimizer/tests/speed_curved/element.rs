//! What a cubic element of a closed curve brings: its pose, and what each limit asks of its time; with differences of both.

use nalgebra::{Matrix2, SMatrix, SVector, Vector2};
use swimmer_model::Model;

use crate::plane::Pose;

/// Of first and second differences \[rad\].
const STEP: f64 = 1e-4;
/// What weighs less in a smooth maximum is left out of its curvature.
const SLIGHT: f64 = 1e-12;

/// The coordinates of an element's four control points (Bernstein): it begins at the first and ends at the last.
pub(super) const POINTS: usize = 8;
pub(super) type Points = SVector<f64, POINTS>;
/// x, y, θ, time, and ∮|Φ'|² by its own parameter.
pub(super) const TOLD: usize = 5;
type Told = SVector<f64, TOLD>;

/// The least time for a turn of the joints where W is this.
pub(super) type Gauge = Box<dyn Fn(&Matrix2<f64>, &Vector2<f64>) -> f64>;

pub(super) struct Limits {
    pub(super) model: Model<f64>,
    pub(super) gauges: Vec<Gauge>,
}

/// An element along Gauss steps.
pub(super) struct Element {
    pub(super) pose: Pose,
    squares: f64,
    /// Of each node its weight, and what each limit asks for.
    nodes: Vec<(f64, Vec<f64>)>,
}

/// What it tells with its derivatives.
pub(super) struct Varied {
    pub(super) pose: Pose,
    pub(super) told: Told,
    pub(super) slopes: SMatrix<f64, TOLD, POINTS>,
    pub(super) curved: [SMatrix<f64, POINTS, POINTS>; TOLD],
}

/// ‖G‖ₚ of what is not negative.
fn smooth_maximum(all: &[f64], p: f64) -> f64 {
    let most = maximum(all);
    let sum: f64 = all.iter().map(|g| (g.max(0.0) / most).powf(p)).sum();
    most * sum.powf(1.0 / p)
}

fn maximum(all: &[f64]) -> f64 {
    all.iter().copied().fold(0.0, f64::max)
}

impl Limits {
    pub(super) fn element(&self, points: &Points, steps: usize) -> Element {
        let [a, b, c, d] = [0, 2, 4, 6].map(|k| Vector2::new(points[k], points[k + 1]));
        let [first, second, third] = [b - a, c - b, d - c].map(|way| way * 3.0);
        let width = 1.0 / steps as f64;
        let (mut pose, mut squares) = (Pose::default(), 0.0);
        let mut nodes = Vec::with_capacity(3 * steps);
        for step in 0..steps {
            let mut at = 0;
            let rates = Pose::NODES.map(|node| {
                let s = (step as f64 + node) * width;
                let r = 1.0 - s;
                let phi = a * r.powi(3) + (b * r + c * s) * (3.0 * r * s) + d * s.powi(3);
                let rate = first * (r * r) + second * (2.0 * r * s) + third * (s * s);
                let (connection, power) = self.model.connection_and_power(&phi);
                let weight = Pose::WEIGHTS[at] * width;
                at += 1;
                squares += weight * rate.norm_squared();
                let gauges = self.gauges.iter().map(|gauge| gauge(&power, &rate));
                nodes.push((weight, gauges.collect()));
                connection * rate * width
            });
            pose = pose * Pose::stepped(&rates);
        }
        Element {
            pose,
            squares,
            nodes,
        }
    }

    /// With all first and second differences. Those of the smooth maximum are made of its limits' own, for it bends too sharply.
    pub(super) fn slopes(&self, points: &Points, steps: usize, p: f64) -> Varied {
        let here = self.element(points, steps);
        let maxima = here.nodes.iter().map(|(_, all)| smooth_maximum(all, p));
        let maxima: Vec<f64> = maxima.collect();
        let shares = here.nodes.iter().zip(&maxima);
        let shares = shares.map(|((_, all), most)| {
            let share = |g: &f64| (g.max(0.0) / most).powf(p - 1.0);
            all.iter().map(share).collect::<Vec<f64>>()
        });
        let shares: Vec<Vec<f64>> = shares.collect();
        let tell = |element: &Element| element.told(&shares);
        let step = |i: usize, sign: f64| Points::ith(i, STEP * sign);
        let moved: [[Element; 2]; POINTS] = std::array::from_fn(|i| {
            [1.0, -1.0].map(|sign| self.element(&(points + step(i, sign)), steps))
        });
        let centre = tell(&here);
        let told = moved.each_ref().map(|both| both.each_ref().map(tell));
        let mut slopes = SMatrix::<f64, TOLD, POINTS>::zeros();
        let mut curved = [SMatrix::<f64, POINTS, POINTS>::zeros(); TOLD];
        for i in 0..POINTS {
            slopes.set_column(i, &((told[i][0] - told[i][1]) / (2.0 * STEP)));
            for j in 0..=i {
                let ways = [1.0, -1.0].map(|sign| {
                    tell(&self.element(&(points + step(i, sign) + step(j, sign)), steps))
                });
                let apart: Told = told[i].iter().chain(&told[j]).sum();
                let second = (ways[0] + ways[1] + centre * 2.0 - apart) / (2.0 * STEP.powi(2));
                for (matrix, value) in curved.iter_mut().zip(&second) {
                    matrix[(i, j)] = *value;
                    matrix[(j, i)] = *value;
                }
            }
        }
        for (q, (weight, all)) in here.nodes.iter().enumerate() {
            let bend = weight * (p - 1.0) / maxima[q];
            let mut mean = Points::zeros();
            for (g, gauge) in all.iter().enumerate() {
                let sharp = (gauge.max(0.0) / maxima[q]).powf(p - 2.0);
                if sharp < SLIGHT {
                    continue;
                }
                let by = moved
                    .each_ref()
                    .map(|[up, down]| (up.nodes[q].1[g] - down.nodes[q].1[g]) / (2.0 * STEP));
                let by = Points::from(by);
                mean += by * shares[q][g];
                curved[3] += by * by.transpose() * (bend * sharp);
            }
            curved[3] -= mean * mean.transpose() * bend;
        }
        Varied {
            pose: here.pose,
            told: Told::from([
                here.pose.x,
                here.pose.y,
                here.pose.theta,
                here.smooth_time(p),
                here.squares,
            ]),
            slopes,
            curved,
        }
    }
}

impl Element {
    /// Its time with these shares of each limit.
    fn told(&self, shares: &[Vec<f64>]) -> Told {
        let time = self
            .nodes
            .iter()
            .zip(shares)
            .map(|((weight, all), shares)| {
                let asked = all.iter().zip(shares).map(|(g, share)| g * share);
                weight * asked.sum::<f64>()
            });
        let Pose { x, y, theta } = self.pose;
        Told::from([x, y, theta, time.sum(), self.squares])
    }

    pub(super) fn smooth_time(&self, p: f64) -> f64 {
        let nodes = self.nodes.iter();
        nodes
            .map(|(weight, all)| weight * smooth_maximum(all, p))
            .sum()
    }

    pub(super) fn time(&self) -> f64 {
        let nodes = self.nodes.iter();
        nodes.map(|(weight, all)| weight * maximum(all)).sum()
    }

    pub(super) fn squares(&self) -> f64 {
        self.squares
    }
}
