//! Lighthill numbers by an independent direct method: the quarter gait as a polygon with one degree of freedom a node.
//!
//! Nodes slide on fixed rays across a guess; the measure is the length of the polygon in the metric of the power, with the
//! midpoint rule, so that time, polynomials, states and barrier do not occur. Exact gradient, dense Newton steps with the
//! nodes at a bound held there, and Richardson's extrapolation over two numbers of nodes.

use collocation::{CollocationProblem, CollocationSolution, QuarterGuess, solve};
use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::{Model, Swimmer};

struct Polygon<'a> {
    model: &'a Model<f64>,
    sign: f64,
    feet: Vec<Vector2<f64>>,
    rays: Vec<Vector2<f64>>,
    /// How far each node may slide.
    ends: Vec<f64>,
}

/// Steps of the guess on either side of a node, over which its ray is made square to the curve.
const BESIDE: f64 = 1e-4;

impl<'a> Polygon<'a> {
    fn new(
        model: &'a Model<f64>,
        sign: f64,
        max_angle: Option<f64>,
        guess: &CollocationSolution,
        intervals: u32,
    ) -> Self {
        let times: Vec<f64> = (0..=intervals)
            .map(|i| f64::from(i) / f64::from(intervals))
            .collect();
        let feet: Vec<_> = times.iter().map(|&t| guess.phi(t)).collect();
        let mut rays: Vec<_> = times
            .iter()
            .map(|&t| {
                let along = guess.phi((t + BESIDE).min(1.0)) - guess.phi((t - BESIDE).max(0.0));
                Vector2::new(along.y, -along.x).normalize()
            })
            .collect();
        rays[0] = Vector2::new(1.0, 1.0).normalize();
        *rays.last_mut().unwrap() = Vector2::new(-1.0, 1.0).normalize();
        let ends = feet
            .iter()
            .zip(&rays)
            .map(|(foot, ray)| {
                let Some(max) = max_angle else {
                    return f64::INFINITY;
                };
                (0..2)
                    .filter(|&i| ray[i].abs() > 1e-9)
                    .map(|i| (max * ray[i].signum() - foot[i]) / ray[i])
                    .fold(f64::INFINITY, f64::min)
            })
            .collect();
        Self {
            model,
            sign,
            feet,
            rays,
            ends,
        }
    }

    /// ln S − ln(±x), its gradient, and ξ.
    fn measure(&self, slides: &DVector<f64>) -> (f64, DVector<f64>, f64) {
        let count = self.feet.len();
        let node = |i: usize| self.feet[i] + self.rays[i] * slides[i];
        let (mut x, mut length, mut theta) = (0.0, 0.0, 0.0);
        let mut sides = Vec::with_capacity(count - 1);
        for i in 1..count {
            let (step, middle) = (node(i) - node(i - 1), (node(i) + node(i - 1)) * 0.5);
            let first = self.model.first_derivatives(&middle);
            let body = first.connection * step;
            let (sin, cos) = (theta + 0.5 * body.z).sin_cos();
            let part = step.dot(&(first.power * step)).sqrt();
            x += cos * body.x - sin * body.y;
            length += part;
            theta += body.z;
            sides.push((step, first, sin, cos, part));
        }
        let (by_x, by_length) = (-1.0 / x, 1.0 / length);
        let mut gradient = DVector::zeros(count);
        let mut later = 0.0;
        for (i, (step, first, sin, cos, part)) in sides.iter().enumerate().rev() {
            let body = first.connection * step;
            let pull = -by_x * (sin * body.x + cos * body.y);
            let carry = nalgebra::Vector3::new(by_x * cos, -by_x * sin, later + 0.5 * pull);
            later += pull;
            let by_step = first.connection.tr_mul(&carry) + first.power * step * (by_length / part);
            let by_middle = Vector2::from([0, 1].map(|k| {
                carry.dot(&(first.d_connection[k] * step))
                    + 0.5 * by_length / part * step.dot(&(first.d_power[k] * step))
            }));
            gradient[i] += self.rays[i].dot(&(by_middle * 0.5 - by_step));
            gradient[i + 1] += self.rays[i + 1].dot(&(by_middle * 0.5 + by_step));
        }
        let unit = self.model.side_drag() * self.model.swimmer().total_length();
        let value = length.ln() - (self.sign * x).ln();
        (value, gradient, unit * (x / length).powi(2))
    }

    /// Newton's method on the nodes that are not held by a bound; returns ξ.
    fn optimise(&self) -> f64 {
        const H: f64 = 1e-5;
        let count = self.feet.len();
        // Not from the guess itself.
        let mut slides = DVector::from_fn(count, |i, _| {
            let wave = 0.02 * (3.0 * i as f64 / count as f64).sin();
            (-wave.abs()).min(self.ends[i])
        });
        let (mut value, mut gradient, mut xi) = self.measure(&slides);
        for _ in 0..40 {
            let free: Vec<usize> = (0..count)
                .filter(|&i| slides[i] < self.ends[i] || gradient[i] > 0.0)
                .collect();
            let slope = DVector::from_fn(free.len(), |k, _| gradient[free[k]]);
            if slope.amax() < 1e-12 {
                break;
            }
            let mut hessian = DMatrix::zeros(free.len(), free.len());
            for (k, &i) in free.iter().enumerate() {
                let at = |h: f64| {
                    let mut moved = slides.clone();
                    moved[i] += h;
                    self.measure(&moved).1
                };
                let column = (at(H) - at(-H)) / (2.0 * H);
                for (l, &j) in free.iter().enumerate() {
                    hessian[(l, k)] += 0.5 * column[j];
                    hessian[(k, l)] += 0.5 * column[j];
                }
            }
            let mut shift = 0.0;
            let newton = loop {
                let shifted = &hessian + DMatrix::identity(free.len(), free.len()) * shift;
                if let Some(factor) = shifted.cholesky() {
                    break factor.solve(&-&slope);
                }
                shift = (shift * 4.0_f64).max(1e-3);
            };
            let mut pace = 1.0;
            let before = slides.clone();
            loop {
                slides.copy_from(&before);
                for (k, &i) in free.iter().enumerate() {
                    slides[i] = (before[i] + pace * newton[k]).min(self.ends[i]);
                }
                let next = self.measure(&slides);
                if next.0 <= value + 1e-14 || pace < 1e-6 {
                    (value, gradient, xi) = next;
                    break;
                }
                pace *= 0.5;
            }
            if newton.amax() * pace < 1e-10 {
                break;
            }
        }
        xi
    }
}

/// ξ by collocation and by polygons.
fn both(swimmer: &Swimmer<f64>, sign: f64, amplitude: f64, max_angle: Option<f64>) -> [f64; 2] {
    let model = Model::new(swimmer).unwrap();
    let mut problem = CollocationProblem::new(&model, sign);
    problem.bounds.max_angle = max_angle;
    let solution = solve(&problem, &QuarterGuess::circle(amplitude).unwrap()).unwrap();
    let polygon =
        |intervals| Polygon::new(&model, sign, max_angle, &solution, intervals).optimise();
    let (coarse, fine) = (polygon(100), polygon(200));
    [solution.efficiency, fine + (fine - coarse) / 3.0]
}

fn agree(swimmer: &Swimmer<f64>, sign: f64, amplitude: f64, max_angle: Option<f64>) {
    let [collocated, polygon] = both(swimmer, sign, amplitude, max_angle);
    let off = polygon / collocated - 1.0;
    assert!(
        off.abs() < 1e-6,
        "within {max_angle:?}: {collocated} by collocation, {polygon} by polygons, {off:.1e} apart"
    );
}

#[test]
fn free_gaits_of_both_swimmers() {
    for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
        agree(&swimmer, 1.0, 1.3, None);
        agree(&swimmer, -1.0, 3.3, None);
    }
}

#[test]
fn bounded_gaits_of_both_swimmers() {
    agree(&Swimmer::purcell(), 1.0, 1.3, Some(1.2));
    agree(&Swimmer::purcell(), -1.0, 3.3, Some(2.8));
    agree(&Swimmer::robot(), 1.0, 1.3, Some(1.6));
    agree(&Swimmer::robot(), 1.0, 1.3, Some(1.2));
}
