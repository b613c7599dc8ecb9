//! Initial guess of the shooting from any closed curve: states along it, with the least-squares momenta.

use nalgebra::{Vector2, Vector3};
use swimmer_model::{Gait, Model, Tolerance, TrajectoryPoint, trajectory, wrapped_angle};

use super::equations::{Motion, State, Turning};
use super::shooting::{Chain, Class, Entry, Stretch};
use crate::cycle::power;
use crate::numerics::between;
use crate::runge_kutta::{Point, StepControl, advance};

/// Integrated closed curve with dense samples.
pub(crate) struct Trajectory {
    /// Power length at each sample.
    pub(crate) length: Vec<f64>,
    /// States: shapes, directions (never wrapped), momenta.
    pub(crate) states: Vec<State>,
    /// Total turn of the direction \[rad\], a multiple of 2π.
    pub(crate) turn: f64,
}

/// Number of samples of a curve.
const SAMPLES: usize = 1440;

impl Trajectory {
    /// Integrates a gait and fits the multiplier of rotation to the parts of the curve that are `free`.
    ///
    /// Returns `None` if the gait is a point or has no net displacement.
    pub(crate) fn new<G: Gait<f64> + ?Sized>(
        model: &Model<f64>,
        gait: &G,
        free: impl Fn(&Vector2<f64>) -> bool,
    ) -> Option<Self> {
        let mut points: Vec<TrajectoryPoint<f64>> = Vec::with_capacity(SAMPLES + 1);
        trajectory(model, gait, &Tolerance::new(1e-10), SAMPLES, |point| {
            points.push(point);
        });
        let rates: Vec<Vector2<f64>> = points.iter().map(|point| gait.at(point.u).rate).collect();
        let psi = directions(&rates);
        let mut length = vec![0.0];
        let mut so_far = 0.0;
        let speeds: Vec<f64> = points
            .iter()
            .zip(&rates)
            .map(|(point, rate)| power(model, &point.phi, rate).sqrt())
            .collect();
        for [from, to] in speeds.array_windows() {
            so_far += 0.5 * (from + to) / SAMPLES as f64;
            length.push(so_far);
        }
        let end = points.last()?;
        let displacement = Vector2::new(end.pose.x, end.pose.y);
        if points.len() != SAMPLES + 1
            || so_far.is_nan()
            || so_far <= 0.0
            || displacement.norm() < 1e-12
        {
            return None;
        }
        let p = displacement * (so_far / displacement.norm_squared());
        let turn = psi.last()? - psi.first()?;
        let turn = (turn / std::f64::consts::TAU).round() * std::f64::consts::TAU;
        let mut swum = Self {
            length,
            states: Vec::with_capacity(points.len()),
            turn,
        };
        for (point, psi) in points.iter().zip(&psi) {
            let (sin, cos) = point.pose.theta.sin_cos();
            swum.states.push([
                point.phi.x,
                point.phi.y,
                *psi,
                p.x * cos + p.y * sin,
                p.y * cos - p.x * sin,
                p.x * point.pose.y - p.y * point.pose.x,
            ]);
        }
        let rotation = swum.fitted_rotation(model, free);
        for state in &mut swum.states {
            state[5] += rotation;
        }
        Some(swum)
    }

    /// Multiplier of rotation that fits the curvature of the curve best in the least-squares sense.
    fn fitted_rotation(&self, model: &Model<f64>, free: impl Fn(&Vector2<f64>) -> bool) -> f64 {
        let (mut top, mut bottom) = (0.0, 0.0);
        let intervals = self.states.array_windows().zip(self.length.array_windows());
        for ([before, after], [from, to]) in intervals {
            let step = to - from;
            let phi = Vector2::new(0.5 * (before[0] + after[0]), 0.5 * (before[1] + after[1]));
            if step <= 0.0 || !free(&phi) {
                continue;
            }
            let local = Turning::at(model, &phi, 0.5 * (before[2] + after[2]));
            let mu = Vector3::new(
                0.5 * (before[3] + after[3]),
                0.5 * (before[4] + after[4]),
                0.5 * (before[5] + after[5]),
            );
            let missing =
                (after[2] - before[2]) / step - local.plain - local.gain * mu.dot(&local.curvature);
            let slope = local.gain * local.curvature.z;
            top += step * missing * slope;
            bottom += step * slope * slope;
        }
        if bottom > 0.0 { top / bottom } else { 0.0 }
    }

    /// Iterates over power length and state of every sample.
    pub(crate) fn rows(
        &self,
    ) -> impl DoubleEndedIterator<Item = (f64, &State)> + ExactSizeIterator {
        self.length.iter().copied().zip(&self.states)
    }

    /// Power length of the cycle.
    pub(crate) fn total(&self) -> f64 {
        self.length.last().copied().unwrap_or(0.0)
    }

    /// State at a power length modulo the cycle.
    pub(crate) fn at(&self, length: f64) -> State {
        let total = self.total();
        let laps = (length / total).floor();
        let (before, share) = between(&self.length, length - laps * total);
        let pick = |i: usize| self.states.get(i).copied().unwrap_or_default();
        let (low, high) = (pick(before), pick(before + 1));
        let mut state: State = std::array::from_fn(|i| low[i] + share * (high[i] - low[i]));
        state[2] += laps * self.turn;
        state
    }
}

/// Chain of `pieces` pieces along a `curve` over s ∈ (0, π/2), a free quarter from φ₁ = φ₂ to φ₁ = −φ₂. Returns `None` if it cannot
/// be integrated or has no displacement.
pub(crate) fn quarter_of_curve(
    model: &Model<f64>,
    curve: &impl Fn(f64) -> (Vector2<f64>, Vector2<f64>),
    pieces: usize,
) -> Option<Chain> {
    const CONTROL: StepControl = StepControl::to(1e-9);
    let length = |z: &[f64; 2]| {
        let (phi, rate) = curve(z[0]);
        [1.0, power(model, &phi, &rate).sqrt()]
    };
    let whole = Point::new(&length, [0.0; 2]);
    let total = advance(&length, whole, std::f64::consts::FRAC_PI_2, CONTROL)?.z[1];
    // State over the power length: s, x, y, θ.
    let rates = |z: &[f64; 4]| {
        let (phi, rate) = curve(z[0]);
        let (a, w) = model.connection_and_power(&phi);
        let slower = rate.dot(&(w * rate)).sqrt().recip();
        let body = a * rate * slower;
        let (sin, cos) = z[3].sin_cos();
        [
            slower,
            cos * body.x - sin * body.y,
            sin * body.x + cos * body.y,
            body.z,
        ]
    };
    let mut here = Point::new(&rates, [0.0; 4]);
    let mut points = vec![here.z];
    for _ in 0..pieces {
        here = advance(&rates, here, total / pieces as f64, CONTROL)?;
        points.push(here.z);
    }
    let [_, x, end_y, _] = points.pop()?;
    let p = total / x;
    if !(p.is_finite() && total > 0.0) {
        return None;
    }
    let mut psi = 0.75 * std::f64::consts::PI;
    let states = points.iter().map(|&[s, _, y, theta]| {
        let (phi, rate) = curve(s);
        psi += wrapped_angle(rate.y.atan2(rate.x) - psi);
        let (sin, cos) = theta.sin_cos();
        // The momentum of rotation vanishes at the end by symmetry.
        [phi.x, phi.y, psi, p * cos, -p * sin, p * (y - end_y)]
    });
    Some(Chain {
        class: Class::Quarter,
        states: states.collect(),
        arcs: vec![Stretch {
            motion: Motion::Free,
            entry: Entry::Smooth,
            pieces,
            length: total,
        }],
    })
}

/// Directions of motion, each within π of the previous one. A rate of zero keeps the direction.
fn directions(rates: &[Vector2<f64>]) -> Vec<f64> {
    let mut directions = Vec::with_capacity(rates.len());
    let mut last = None;
    for rate in rates {
        let raw = rate.y.atan2(rate.x);
        let psi = match last {
            Some(before) if rate.norm() > 0.0 => before + wrapped_angle(raw - before),
            Some(before) => before,
            None => raw,
        };
        directions.push(psi);
        last = Some(psi);
    }
    directions
}
