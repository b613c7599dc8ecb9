//! An independent direct method for the fastest gait: a polygon whose corners and times are free.
//!
//! For several swimmers with one gait it maximises the weighted sum of displacements. From the model it takes A(Φ) alone. Slopes
//! are differences of the integrated polygon, second derivatives differences of the slopes; nothing is known of arcs, heights or
//! switching functions. Limits are handled by a primal–dual barrier, the rotation and a prescribed heading by an augmented
//! Lagrangian. If the fastest gait is a polygon, that is, without a singular arc, this is exact.

mod limits;
mod swum;

use gait_optimizer::SpeedProblem;
use nalgebra::{DMatrix, DVector, Vector2};
use swimmer_model::{Model, Swimmer};

use limits::{Slack, longest};
use swum::Poses;

/// Differences for slopes and for second derivatives \[rad\].
const FINE: f64 = 1e-5;
const COARSE: f64 = 1e-4;
/// The gap of the answer is this times the limits that are active, about as many as there are unknowns.
const LAST_BARRIER: f64 = 1e-11;
/// Penalty weight of the rotation in the augmented Lagrangian.
const PRICE: f64 = 300.0;
const MOST_STEPS: usize = 300;
pub(crate) struct Direct {
    /// Swimmers with the gain of their servos: actual over commanded angle. The rotation of the first one vanishes.
    swimmers: Vec<(Model<f64>, f64)>,
    /// Weights of their displacements.
    weights: Vec<f64>,
    rates: [f64; 2],
    max_angle: f64,
    sides: usize,
    /// Corners, then times.
    z: DVector<f64>,
    /// Multiplier of the rotation.
    lambda: f64,
    /// A corner that stays.
    held: Option<usize>,
    /// `true` to maximise the rotation, which need not vanish then.
    turning: bool,
    /// Prescribed direction of the displacement against the mean heading, modulo half a turn, and its multiplier.
    heading: Option<(f64, f64)>,
}

/// A side as it is, and with each coordinate of its ends moved both ways.
struct Side {
    here: Poses,
    moved: [[Poses; 2]; 4],
    /// In slightly more and slightly less time, for a prescribed heading.
    timed: Option<[Poses; 2]>,
}

impl Direct {
    /// From a closed curve of angles, drawn into the bounds.
    pub(crate) fn new(
        problem: &SpeedProblem,
        sides: usize,
        curve: impl Fn(f64) -> Vector2<f64>,
    ) -> Self {
        let max_angle = problem.bounds.max_angle.unwrap_or(f64::INFINITY);
        let mut direct = Self {
            swimmers: vec![(Model::new(&problem.swimmer.of_unit_length()).unwrap(), 1.0)],
            weights: vec![1.0],
            rates: problem.rates,
            max_angle,
            sides,
            z: DVector::zeros(3 * sides),
            lambda: 0.0,
            held: None,
            turning: false,
            heading: None,
        };
        for k in 0..sides {
            let phi = curve(std::f64::consts::TAU * (k as f64 + 0.3) / sides as f64);
            for joint in 0..2 {
                direct.z[2 * k + joint] = phi[joint].clamp(-0.97 * max_angle, 0.97 * max_angle);
            }
        }
        direct.give_time();
        direct
    }

    /// More than the servos need.
    fn give_time(&mut self) {
        for k in 0..self.sides {
            let [from, to] = self.ends(&self.z, k);
            let way = to - from;
            let least = (way.x.abs() / self.rates[0]).max(way.y.abs() / self.rates[1]);
            self.z[2 * self.sides + k] = 1.2 * least + 1e-2;
        }
    }

    /// For the displacements of these swimmers with these gains and weights; that of the problem's does not count, but it does not
    /// rotate.
    pub(crate) fn of(mut self, members: &[(Swimmer<f64>, f64, f64)]) -> Self {
        self.weights = vec![0.0];
        for (swimmer, gain, weight) in members {
            let model = Model::new(&swimmer.of_unit_length()).unwrap();
            self.swimmers.push((model, *gain));
            self.weights.push(*weight);
        }
        self
    }

    /// With the nearest corner here, where it stays.
    pub(crate) fn through(mut self, shape: Vector2<f64>) -> Self {
        let corner = |k: usize| Vector2::new(self.z[2 * k], self.z[2 * k + 1]);
        let off = |k: &usize| (corner(*k) - shape).norm();
        let nearest = (0..self.sides).min_by(|a, b| off(a).total_cmp(&off(b)));
        let nearest = nearest.unwrap_or(0);
        self.z.fixed_rows_mut::<2>(2 * nearest).copy_from(&shape);
        self.held = Some(nearest);
        self.give_time();
        self
    }

    /// For the rotation.
    pub(crate) fn turning(self) -> Self {
        Self {
            turning: true,
            ..self
        }
    }

    /// Leading this way against the mean heading, or the opposite one \[rad\].
    pub(crate) fn heading(self, aim: f64) -> Self {
        Self {
            heading: Some((aim, 0.0)),
            ..self
        }
    }

    fn ends(&self, z: &DVector<f64>, side: usize) -> [Vector2<f64>; 2] {
        [side, side + 1].map(|corner| {
            let at = 2 * (corner % self.sides);
            Vector2::new(z[at], z[at + 1])
        })
    }

    fn times<'z>(&self, z: &'z DVector<f64>) -> &'z [f64] {
        &z.as_slice()[2 * self.sides..]
    }

    fn period(&self, z: &DVector<f64>) -> f64 {
        self.times(z).iter().sum()
    }

    fn along(&self, z: &DVector<f64>, side: usize) -> Poses {
        self.along_ends(self.ends(z, side), self.times(z)[side])
    }

    fn along_ends(&self, ends: [Vector2<f64>; 2], time: f64) -> Poses {
        Poses::along(&self.swimmers, ends, self.heading.map(|_| time))
    }

    fn side(&self, z: &DVector<f64>, k: usize) -> Side {
        let here = self.along(z, k);
        let time = self.times(z)[k];
        Side {
            timed: self
                .heading
                .map(|_| [FINE, -FINE].map(|step| here.lasting(time + step))),
            here,
            moved: std::array::from_fn(|p| {
                [FINE, -FINE].map(|step| {
                    let mut ends = self.ends(z, k);
                    ends[p / 2][p % 2] += step;
                    self.along_ends(ends, time)
                })
            }),
        }
    }

    fn distance(&self, whole: &Poses) -> f64 {
        let weighted = self.weights.iter().zip(whole.all());
        weighted
            .map(|(weight, pose)| weight * pose.x.hypot(pose.y))
            .sum()
    }

    fn worth(&self, whole: &Poses) -> f64 {
        let theta = whole.first().theta;
        if self.turning {
            return -theta.abs().ln();
        }
        let priced = |off: f64, multiplier: f64| multiplier * off + 0.5 * PRICE * off.powi(2);
        let heading = self
            .heading
            .map_or(0.0, |(aim, mu)| priced(misses(whole, aim), mu));
        -self.distance(whole).ln() + priced(theta, self.lambda) + heading
    }

    /// Gradient of ln of the period less that of the distance, with the rotation's price; and the whole cycle's pose.
    fn gradient(&self, z: &DVector<f64>, sides: &[Side]) -> (DVector<f64>, Poses) {
        let still = Poses::still(self.swimmers.len());
        let mut after = vec![still.clone(); self.sides + 1];
        for k in (0..self.sides).rev() {
            after[k] = &sides[k].here * &after[k + 1];
        }
        let mut before = still;
        let mut gradient = DVector::zeros(3 * self.sides);
        for (k, side) in sides.iter().enumerate() {
            for p in 0..4 {
                let [up, down] = [0, 1].map(|way| {
                    let moved = &(&before * &side.moved[p][way]) * &after[k + 1];
                    self.worth(&moved)
                });
                let at = 2 * ((k + p / 2) % self.sides) + p % 2;
                gradient[at] += (up - down) / (2.0 * FINE);
            }
            gradient[2 * self.sides + k] += 1.0 / self.period(z);
            if let Some(timed) = &side.timed {
                let [more, less] = timed
                    .each_ref()
                    .map(|timed| self.worth(&(&(&before * timed) * &after[k + 1])));
                gradient[2 * self.sides + k] += (more - less) / (2.0 * FINE);
            }
            before = &before * &side.here;
        }
        (gradient, before)
    }

    fn second(&self, sides: &mut [Side]) -> DMatrix<f64> {
        let n = self.sides;
        let mut matrix = DMatrix::zeros(3 * n, 3 * n);
        let mut z = self.z.clone();
        // The time of a side counts for the heading alone.
        let unknowns = if self.heading.is_some() { 3 } else { 2 };
        for at in 0..unknowns * n {
            let corner = at / 2;
            let touched = if at < 2 * n {
                [(corner + n - 1) % n, corner]
            } else {
                [at - 2 * n; 2]
            };
            let columns = [COARSE, -COARSE].map(|step| {
                z[at] = self.z[at] + step;
                for k in touched {
                    sides[k] = self.side(&z, k);
                }
                self.gradient(&z, sides).0
            });
            z[at] = self.z[at];
            for k in touched {
                sides[k] = self.side(&z, k);
            }
            matrix.set_column(at, &((&columns[0] - &columns[1]) / (2.0 * COARSE)));
        }
        if self.heading.is_none() {
            let mut times = matrix.view_mut((2 * n, 2 * n), (n, n));
            times.fill(-self.period(&self.z).powi(-2));
        }
        let transposed = matrix.transpose();
        (matrix + transposed) * 0.5
    }

    fn slacks(&self, z: &DVector<f64>) -> Vec<Slack> {
        limits::slacks(z, self.sides, self.rates, self.max_angle)
    }

    fn merit(&self, z: &DVector<f64>, barrier: f64) -> f64 {
        let slacks = self.slacks(z);
        if slacks.iter().any(|slack| slack.value <= 0.0) {
            return f64::INFINITY;
        }
        let still = Poses::still(self.swimmers.len());
        let whole = (0..self.sides).fold(still, |pose, k| &pose * &self.along(z, k));
        let logs: f64 = slacks.iter().map(|slack| slack.value.ln()).sum();
        self.worth(&whole) + self.period(z).ln() - barrier * logs
    }

    /// Maximises; returns |d|/(L T) of the polygon, whose rotation vanishes, or |Δθ|/T. Returns `None` if it does not converge.
    pub(crate) fn climb(&mut self) -> Option<f64> {
        let mut barrier = 1e-2;
        let mut damping = 0.0_f64;
        let slacks = self.slacks(&self.z);
        let mut pushes: Vec<f64> = slacks.iter().map(|slack| barrier / slack.value).collect();
        for _ in 0..MOST_STEPS {
            let mut sides: Vec<Side> = (0..self.sides).map(|k| self.side(&self.z, k)).collect();
            let (smooth, whole) = self.gradient(&self.z, &sides);
            let slacks = self.slacks(&self.z);
            let (mut primal, mut dual, mut apart) = (smooth.clone(), smooth, 0.0_f64);
            for (slack, push) in slacks.iter().zip(&pushes) {
                slack.add(&mut primal, -barrier / slack.value);
                slack.add(&mut dual, -push);
                apart = apart.max((slack.value * push - barrier).abs());
            }
            let held = self.held.map(|corner| 2 * corner..2 * corner + 2);
            for at in held.clone().into_iter().flatten() {
                (primal[at], dual[at]) = (0.0, 0.0);
            }
            if apart < 5.0 * barrier && dual.amax() < (10.0 * barrier).max(3e-8) {
                let theta = whole.first().theta;
                if barrier <= LAST_BARRIER && self.turning {
                    return Some(theta.abs() / self.period(&self.z));
                }
                self.lambda += PRICE * theta;
                let mut left = self.lambda * theta;
                let mut met = theta.abs() < 1e-8;
                if let Some((aim, mu)) = &mut self.heading {
                    let off = misses(&whole, *aim);
                    *mu += PRICE * off;
                    left += *mu * off;
                    met &= off.abs() < 1e-8;
                }
                if barrier <= LAST_BARRIER && met {
                    // The residuals of rotation and heading are priced to first order.
                    return Some(self.distance(&whole) / self.period(&self.z) * (-left).exp());
                }
                barrier = (0.2 * barrier).min(barrier.powf(1.4)).max(LAST_BARRIER);
                continue;
            }
            let mut matrix = self.second(&mut sides);
            for (slack, push) in slacks.iter().zip(&pushes) {
                slack.stiffen(&mut matrix, push / slack.value);
            }
            for at in held.into_iter().flatten() {
                matrix.row_mut(at).fill(0.0);
                matrix.column_mut(at).fill(0.0);
                matrix[(at, at)] = 1.0;
            }
            let step = loop {
                let mut damped = matrix.clone();
                for i in 0..3 * self.sides {
                    damped[(i, i)] += damping;
                }
                if let Some(factors) = damped.cholesky() {
                    break -factors.solve(&primal);
                }
                damping = (4.0 * damping).max(1e-4);
            };
            let here = self.merit(&self.z, barrier);
            let mut length = longest(slacks.iter().map(|slack| (slack.value, slack.along(&step))));
            while length > 1e-7
                && self.merit(&(&self.z + &step * length), barrier) > here + 1e-13 * here.abs()
            {
                length *= 0.5;
            }
            if length <= 1e-7 {
                damping = (10.0 * damping).max(1e-3);
                if damping > 1e9 {
                    return None;
                }
                continue;
            }
            self.z += &step * length;
            damping = if damping < 1e-6 { 0.0 } else { 0.2 * damping };
            let moves: Vec<f64> = slacks
                .iter()
                .zip(&pushes)
                .map(|(slack, push)| (barrier - push * slack.along(&step)) / slack.value - push)
                .collect();
            let dual_length = longest(pushes.iter().copied().zip(moves.iter().copied()));
            for ((push, moved), slack) in pushes.iter_mut().zip(moves).zip(self.slacks(&self.z)) {
                let central = barrier / slack.value;
                *push = (*push + dual_length * moved).clamp(1e-6 * central, 1e6 * central);
            }
        }
        None
    }
}

/// By how much the displacement misses a direction against the mean heading, modulo half a turn.
fn misses(whole: &Poses, aim: f64) -> f64 {
    use std::f64::consts::{FRAC_PI_2, PI};
    let pose = whole.first();
    let off = pose.y.atan2(pose.x) - whole.mean_heading() - aim;
    (off + FRAC_PI_2).rem_euclid(PI) - FRAC_PI_2
}
