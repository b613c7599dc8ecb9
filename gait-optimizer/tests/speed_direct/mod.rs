//! An independent direct method for the fastest gait: a polygon whose corners and times are free, climbed by a barrier method.
//!
//! From the model it takes A(Φ) alone. Slopes are differences of the swum polygon, second derivatives differences of the
//! slopes; nothing is known of arcs, heights or multipliers.

#[path = "../direct/pose.rs"]
mod pose;

use gait_optimizer::SpeedProblem;
use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::Model;

use pose::Pose;

/// Sides of the polygon.
const SIDES: usize = 24;
/// Differences for slopes and for second derivatives \[rad\].
const FINE: f64 = 1e-5;
const COARSE: f64 = 1e-4;
const LAST_BARRIER: f64 = 2e-12;

pub(crate) struct Direct {
    model: Model<f64>,
    rates: [f64; 2],
    max_angle: f64,
    /// Corners, then times.
    z: DVector<f64>,
    /// Multiplier of the rotation.
    lambda: f64,
}

/// A side as it is, and with each coordinate of its ends moved both ways.
struct Side {
    here: Pose,
    moved: [[Pose; 2]; 4],
}

fn corner(z: &DVector<f64>, k: usize) -> Vector2<f64> {
    let at = 2 * (k % SIDES);
    Vector2::new(z[at], z[at + 1])
}

/// Price of the rotation beside its multiplier.
const PRICE: f64 = 10.0;

impl Direct {
    /// Round a circle, drawn into the bounds.
    pub(crate) fn from_circle(problem: &SpeedProblem, centre: Vector2<f64>, radius: f64) -> Self {
        let max_angle = problem.bounds.max_angle.unwrap_or(f64::INFINITY);
        let mut z = DVector::zeros(3 * SIDES);
        for k in 0..SIDES {
            let angle = std::f64::consts::TAU * (k as f64 + 0.3) / SIDES as f64;
            let phi = centre + Vector2::new(angle.cos(), angle.sin()) * radius;
            let inside = 0.97 * max_angle;
            z[2 * k] = phi.x.clamp(-inside, inside);
            z[2 * k + 1] = phi.y.clamp(-inside, inside);
        }
        let mut direct = Self {
            model: Model::new(&problem.swimmer).unwrap(),
            rates: problem.rates,
            max_angle,
            z,
            lambda: 0.0,
        };
        for k in 0..SIDES {
            let way = corner(&direct.z, k + 1) - corner(&direct.z, k);
            let least = (way.x.abs() / direct.rates[0]).max(way.y.abs() / direct.rates[1]);
            direct.z[2 * SIDES + k] = 1.2 * least + 1e-2;
        }
        direct
    }

    fn side(&self, z: &DVector<f64>, k: usize) -> Side {
        let ends = [corner(z, k), corner(z, k + 1)];
        let along = |ends: [Vector2<f64>; 2]| Pose::along(&self.model, ends[0], ends[1]);
        Side {
            here: along(ends),
            moved: std::array::from_fn(|p| {
                [FINE, -FINE].map(|step| {
                    let mut ends = ends;
                    ends[p / 2][p % 2] += step;
                    along(ends)
                })
            }),
        }
    }

    fn worth(&self, whole: Pose) -> f64 {
        -whole.x.hypot(whole.y).ln() + self.lambda * whole.theta + 0.5 * PRICE * whole.theta.powi(2)
    }

    /// ln of the period less that of the distance, with the rotation's price, and its gradient.
    fn smooth(&self, z: &DVector<f64>, sides: &[Side]) -> (f64, DVector<f64>, Pose) {
        let mut after = vec![Pose::default(); SIDES + 1];
        for k in (0..SIDES).rev() {
            after[k] = sides[k].here * after[k + 1];
        }
        let mut before = Pose::default();
        let period: f64 = z.rows(2 * SIDES, SIDES).sum();
        let mut gradient = DVector::zeros(3 * SIDES);
        for (k, side) in sides.iter().enumerate() {
            for p in 0..4 {
                let [up, down] = side.moved[p].map(|one| self.worth(before * one * after[k + 1]));
                let at = 2 * ((k + p / 2) % SIDES) + p % 2;
                gradient[at] += (up - down) / (2.0 * FINE);
            }
            gradient[2 * SIDES + k] += 1.0 / period;
            before = before * side.here;
        }
        (self.worth(before) + period.ln(), gradient, before)
    }

    fn sides(&self, z: &DVector<f64>) -> Vec<Side> {
        (0..SIDES).map(|k| self.side(z, k)).collect()
    }

    /// Slacks of all limits, with their slopes.
    fn slacks(&self, z: &DVector<f64>) -> Vec<(f64, [(usize, f64); 3])> {
        let mut all = Vec::new();
        for k in 0..SIDES {
            for (joint, rate) in self.rates.into_iter().enumerate() {
                let (from, to) = (2 * k + joint, 2 * ((k + 1) % SIDES) + joint);
                let time = 2 * SIDES + k;
                for sign in [1.0, -1.0] {
                    let slack = rate * z[time] - sign * (z[to] - z[from]);
                    all.push((slack, [(time, rate), (to, -sign), (from, sign)]));
                    if self.max_angle.is_finite() {
                        let slack = self.max_angle - sign * z[from];
                        all.push((slack, [(from, -sign), (from, 0.0), (from, 0.0)]));
                    }
                }
            }
        }
        all
    }

    fn merit(&self, z: &DVector<f64>, barrier: f64) -> f64 {
        let slacks = self.slacks(z);
        if slacks.iter().any(|(slack, _)| *slack <= 0.0) {
            return f64::INFINITY;
        }
        let whole = (0..SIDES).fold(Pose::default(), |pose, k| {
            pose * Pose::along(&self.model, corner(z, k), corner(z, k + 1))
        });
        let logs: f64 = slacks.iter().map(|(slack, _)| slack.ln()).sum();
        self.worth(whole) + z.rows(2 * SIDES, SIDES).sum().ln() - barrier * logs
    }

    fn second(&self, sides: &mut [Side]) -> DMatrix<f64> {
        let mut matrix = DMatrix::zeros(3 * SIDES, 3 * SIDES);
        for at in 0..2 * SIDES {
            let corner = at / 2;
            let touched = [(corner + SIDES - 1) % SIDES, corner];
            let columns = [COARSE, -COARSE].map(|step| {
                let mut z = self.z.clone();
                z[at] += step;
                for k in touched {
                    sides[k] = self.side(&z, k);
                }
                self.smooth(&z, sides).1
            });
            for k in touched {
                sides[k] = self.side(&self.z, k);
            }
            matrix.set_column(at, &((&columns[0] - &columns[1]) / (2.0 * COARSE)));
        }
        let period: f64 = self.z.rows(2 * SIDES, SIDES).sum();
        let mut times = matrix.view_mut((2 * SIDES, 2 * SIDES), (SIDES, SIDES));
        times.fill(-1.0 / (period * period));
        let transposed = matrix.transpose();
        (matrix + transposed) * 0.5
    }

    /// Climbs; |d|/(L T) of the polygon, whose rotation vanishes, or none where it does not come to rest.
    pub(crate) fn climb(&mut self) -> Option<f64> {
        let mut barrier = 1e-2;
        let mut damping = 0.0_f64;
        for _ in 0..400 {
            let mut sides = self.sides(&self.z);
            let (_, smooth, whole) = self.smooth(&self.z, &sides);
            let slacks = self.slacks(&self.z);
            let mut gradient = smooth;
            for (slack, slopes) in &slacks {
                for (at, slope) in slopes {
                    gradient[*at] -= barrier / slack * slope;
                }
            }
            let mut matrix = self.second(&mut sides);
            for (slack, slopes) in &slacks {
                for (i, a) in slopes {
                    for (j, b) in slopes {
                        matrix[(*i, *j)] += barrier / (slack * slack) * a * b;
                    }
                }
            }
            let step = loop {
                let mut damped = matrix.clone();
                for i in 0..3 * SIDES {
                    damped[(i, i)] += damping;
                }
                if let Some(factors) = damped.cholesky() {
                    break -factors.solve(&gradient);
                }
                damping = (4.0 * damping).max(1e-6);
            };
            let gain = -gradient.dot(&step);
            let here = self.merit(&self.z, barrier);
            let mut length = 1.0;
            while length > 1e-9 && self.merit(&(&self.z + &step * length), barrier) > here - 1e-15 {
                length *= 0.5;
            }
            if length > 1e-9 {
                self.z += &step * length;
                damping = if damping < 1e-9 { 0.0 } else { 0.2 * damping };
            }
            if gain < 1e-3 * barrier.max(1e-10) || length <= 1e-9 {
                // At rest for this barrier.
                self.lambda += PRICE * whole.theta;
                if barrier <= LAST_BARRIER && whole.theta.abs() < 1e-9 {
                    let period: f64 = self.z.rows(2 * SIDES, SIDES).sum();
                    return Some(whole.x.hypot(whole.y) / period);
                }
                if barrier > LAST_BARRIER {
                    barrier = (0.2 * barrier).max(LAST_BARRIER);
                }
            }
        }
        None
    }
}
