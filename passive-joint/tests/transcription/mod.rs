//! Direct transcription of the search: pseudospectral states on half a cycle, derivatives by differences, a primal barrier.
//!
//! It shares A and W with the library, and nothing else. Half-wave symmetry makes the states odd under half a cycle, so a
//! trigonometric derivative matrix of odd functions represents them on half of the nodes.

use std::f64::consts::{PI, TAU};

use nalgebra::{DMatrix, DVector, Vector2};
use passive_joint::{Objective, Optimum, Problem};
use swimmer_model::Model;

/// Nodes of a cycle, and of the half cycle that determines it.
const NODES: usize = 80;
const HALF: usize = NODES / 2;
/// Instants of half a cycle at which the angle is bounded, as in the search.
const INSTANTS: usize = 1000;

pub(crate) struct Transcription<'a> {
    model: &'a Model<f64>,
    passive: usize,
    objective: Objective,
    max_angle: f64,
    harmonics: usize,
    /// Derivative with respect to u of values at the nodes of half a cycle, which change sign in the other half.
    derivative: DMatrix<f64>,
    resistance: f64,
}

/// Angle and rate of the waveform; coefficients c₁, c₃, s₃, ….
fn waveform(coefficients: &[f64], u: f64) -> [f64; 2] {
    let mut sum = [0.0; 2];
    for (k, c) in coefficients.iter().enumerate() {
        let n = TAU * (2 * k.div_ceil(2) + 1) as f64;
        if k > 0 && k.is_multiple_of(2) {
            sum[0] += c * (n * u).sin();
            sum[1] += c * n * (n * u).cos();
        } else {
            sum[0] += c * (n * u).cos();
            sum[1] -= c * n * (n * u).sin();
        }
    }
    sum
}

impl<'a> Transcription<'a> {
    pub(crate) fn new(problem: &Problem<'a>) -> Self {
        let entry = |i: usize, j: usize| {
            if i == j {
                return 0.0;
            }
            let apart = PI * (i as f64 - j as f64) / NODES as f64;
            let sign = if (i + j).is_multiple_of(2) { 1.0 } else { -1.0 };
            PI * sign / apart.tan()
        };
        let derivative = DMatrix::from_fn(HALF, HALF, |i, j| entry(i, j) - entry(i, j + HALF));
        let passive = problem.joint.index();
        let resistance = problem.model.power_matrix(&Vector2::zeros())[(passive, passive)];
        Self {
            model: problem.model,
            passive,
            objective: problem.objective,
            max_angle: problem.max_angle,
            harmonics: problem.harmonics,
            derivative,
            resistance,
        }
    }

    fn shape(&self, driven: f64, passive: f64) -> Vector2<f64> {
        let mut shape = Vector2::zeros();
        shape[1 - self.passive] = driven;
        shape[self.passive] = passive;
        shape
    }

    /// Logarithm of the objective of coefficients and `κ/W_pp(0)`, from a passive motion that fulfils the balance at every node.
    fn value(&self, x: &DVector<f64>) -> Option<f64> {
        let count = x.len() - 1;
        let kappa = x[count] * self.resistance;
        if kappa <= 0.0 {
            return None;
        }
        let drive: Vec<[f64; 2]> = (0..NODES)
            .map(|k| waveform(&x.as_slice()[..count], k as f64 / NODES as f64))
            .collect();
        let (p, d) = (self.passive, 1 - self.passive);
        let residual = |angles: &DVector<f64>| {
            let rates = &self.derivative * angles;
            DVector::from_fn(HALF, |k, _| {
                let power = self.model.power_matrix(&self.shape(drive[k][0], angles[k]));
                power[(p, d)] * drive[k][1] + power[(p, p)] * rates[k] + kappa * angles[k]
            })
        };
        let mut angles = DVector::zeros(HALF);
        let mut converged = false;
        for _ in 0..30 {
            let here = residual(&angles);
            if here.amax() < 1e-12 * self.resistance {
                converged = true;
                break;
            }
            // The balance at a node depends on the angle there, and on all angles through their derivative.
            let rates = &self.derivative * &angles;
            let mut jacobian = DMatrix::zeros(HALF, HALF);
            for k in 0..HALF {
                let power = |angle: f64| self.model.power_matrix(&self.shape(drive[k][0], angle));
                let local = |angle: f64| {
                    let power = power(angle);
                    power[(p, d)] * drive[k][1] + power[(p, p)] * rates[k]
                };
                let resistance = power(angles[k])[(p, p)];
                for j in 0..HALF {
                    jacobian[(k, j)] = resistance * self.derivative[(k, j)];
                }
                let step = 1e-6;
                jacobian[(k, k)] +=
                    kappa + (local(angles[k] + step) - local(angles[k] - step)) / (2.0 * step);
            }
            angles -= jacobian.lu().solve(&here)?;
        }
        if !converged {
            return None;
        }
        let rates = whole(&(&self.derivative * &angles));
        let angles = whole(&angles);
        let shapes: Vec<_> = (0..NODES)
            .map(|k| self.shape(drive[k][0], angles[k]))
            .collect();
        let velocities: Vec<_> = (0..NODES)
            .map(|k| self.shape(drive[k][1], rates[k]))
            .collect();
        let bodies: Vec<_> = (0..NODES)
            .map(|k| self.model.local_connection(&shapes[k]) * velocities[k])
            .collect();
        let heading = integral(&bodies.iter().map(|body| body.z).collect::<Vec<_>>());
        let mut moved = Vector2::<f64>::zeros();
        let mut energy = 0.0;
        for k in 0..NODES {
            let (sin, cos) = heading[k].sin_cos();
            moved.x += cos * bodies[k].x - sin * bodies[k].y;
            moved.y += sin * bodies[k].x + cos * bodies[k].y;
            energy += velocities[k].dot(&(self.model.power_matrix(&shapes[k]) * velocities[k]));
        }
        let displacement = moved.norm() / NODES as f64;
        let energy = energy / NODES as f64;
        Some(match self.objective {
            Objective::Displacement => displacement.ln(),
            Objective::Efficiency => 2.0 * displacement.ln() - energy.ln(),
            Objective::Speed => return None,
        })
    }

    /// Best value and coefficients, from a feasible sinusoid: Newton's method with differences on the objective with a barrier.
    pub(crate) fn maximise(&self, sine: &Optimum) -> (f64, Vec<f64>) {
        let count = 2 * self.harmonics;
        let mut x = DVector::zeros(count);
        x[0] = 0.98 * sine.waveform.coefficients()[0];
        x[count - 1] = sine.passive.kappa / self.resistance;
        let rows = DMatrix::from_fn(INSTANTS, count - 1, |i, k| {
            let mut unit = vec![0.0; count - 1];
            unit[k] = 1.0;
            waveform(&unit, 0.5 * i as f64 / INSTANTS as f64)[0]
        });
        // A larger barrier would push the search off the branch of one stroke forth and back a cycle.
        let mut barrier = 1e-5;
        while barrier > 1e-10 {
            for _ in 0..200 {
                let angles = &rows * x.rows(0, count - 1);
                let merit = |value: f64, angles: &DVector<f64>| {
                    let margins = angles
                        .iter()
                        .map(|a| (self.max_angle - a).ln() + (self.max_angle + a).ln());
                    value + barrier * margins.sum::<f64>()
                };
                let value = |x: &DVector<f64>| self.value(x);
                let here = value(&x).unwrap();
                let (gradient, hessian) = differences(&value, &x, here);
                let mut slope = gradient.clone();
                let mut matrix = -hessian;
                for (i, a) in angles.iter().enumerate() {
                    let row = rows.row(i).transpose();
                    let (below, above) = (1.0 / (self.max_angle + a), 1.0 / (self.max_angle - a));
                    let mut part = slope.rows_mut(0, count - 1);
                    part += &row * (barrier * (below - above));
                    let mut part = matrix.view_mut((0, 0), (count - 1, count - 1));
                    part += &row * row.transpose() * (barrier * (below * below + above * above));
                }
                let mut shift = 0.0;
                let step = loop {
                    let shifted = &matrix + DMatrix::identity(count, count) * shift;
                    if let Some(factors) = shifted.cholesky() {
                        break factors.solve(&slope);
                    }
                    shift = if shift > 0.0 { 10.0 * shift } else { 1e-4 };
                };
                let from = merit(here, &angles);
                let mut length = (0.1 / step.amax()).min(1.0);
                let moved = (0..40).any(|_| {
                    let next = &x + &step * length;
                    let angles = &rows * next.rows(0, count - 1);
                    let better = angles.amax() < self.max_angle
                        && value(&next).is_some_and(|value| merit(value, &angles) > from);
                    if better {
                        x = next;
                    } else {
                        length *= 0.5;
                    }
                    better
                });
                if !moved || step.amax() < 1e-8 {
                    break;
                }
            }
            barrier *= 0.2;
        }
        (self.value(&x).unwrap(), x.as_slice()[..count - 1].to_vec())
    }
}

/// Values at all nodes of a cycle from those of its first half.
fn whole(half: &DVector<f64>) -> Vec<f64> {
    half.iter()
        .copied()
        .chain(half.iter().map(|value| -value))
        .collect()
}

/// Integral from node 0 to each node of periodic values of zero mean, by their Fourier series.
fn integral(values: &[f64]) -> Vec<f64> {
    let n = values.len();
    let mut sums = vec![0.0; n];
    for order in 1..n / 2 {
        let speed = TAU * order as f64;
        let (mut cos, mut sin) = (0.0, 0.0);
        for (k, value) in values.iter().enumerate() {
            let angle = speed * k as f64 / n as f64;
            cos += 2.0 / n as f64 * value * angle.cos();
            sin += 2.0 / n as f64 * value * angle.sin();
        }
        for (k, sum) in sums.iter_mut().enumerate() {
            let angle = speed * k as f64 / n as f64;
            *sum += cos * angle.sin() / speed + sin * (1.0 - angle.cos()) / speed;
        }
    }
    sums
}

/// Gradient and Hessian by central differences.
fn differences(
    value: &dyn Fn(&DVector<f64>) -> Option<f64>,
    x: &DVector<f64>,
    here: f64,
) -> (DVector<f64>, DMatrix<f64>) {
    let n = x.len();
    let at = |shifts: &[(usize, f64)]| {
        let mut x = x.clone();
        for (k, by) in shifts {
            x[*k] += by;
        }
        value(&x).unwrap()
    };
    let (small, large) = (1e-4, 1e-3);
    let gradient = DVector::from_fn(n, |k, _| {
        // Fourth order.
        let [near, far] = [small, 2.0 * small].map(|h| at(&[(k, h)]) - at(&[(k, -h)]));
        (8.0 * near - far) / (12.0 * small)
    });
    let mut hessian = DMatrix::zeros(n, n);
    for i in 0..n {
        for j in 0..=i {
            let entry = if i == j {
                (at(&[(i, large)]) - 2.0 * here + at(&[(i, -large)])) / (large * large)
            } else {
                (at(&[(i, large), (j, large)])
                    - at(&[(i, large), (j, -large)])
                    - at(&[(i, -large), (j, large)])
                    + at(&[(i, -large), (j, -large)]))
                    / (4.0 * large * large)
            };
            hessian[(i, j)] = entry;
            hessian[(j, i)] = entry;
        }
    }
    (gradient, hessian)
}
