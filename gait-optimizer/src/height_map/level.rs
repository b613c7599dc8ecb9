//! Predictor–corrector continuation along a zero-level curve of a function of the joint angles with its exact gradient. The
//! continuation passes straight through points at which another curve crosses.

use nalgebra::{Matrix2, Vector2};

use crate::numerics::locate;

/// Function of the joint angles with its gradient.
pub(crate) struct Level<F>(pub(crate) F);

/// Step control along a curve \[rad\].
#[derive(Debug, Clone, Copy)]
pub(crate) struct Stride {
    /// Largest step.
    pub(crate) longest: f64,
    /// Largest turn of the curve per step.
    pub(crate) turn: f64,
}

/// Largest |value| at a vertex.
const POLISHED: f64 = 1e-12;
/// |value| at which the corrector stops.
const ROUNDING: f64 = 1e-15;
/// Least number of steps of a closed curve.
const FEWEST_ROUND: usize = 10;
/// Smallest step, as a share of the largest.
const SHORTEST: f64 = 1e-7;
/// Largest number of vertices; curves on these squares have less than a tenth of it.
const MOST_POINTS: usize = 100_000;

/// Point of a curve with the direction of travel.
#[derive(Debug, Clone, Copy)]
pub(crate) struct OnCurve {
    pub(crate) phi: Vector2<f64>,
    pub(crate) tangent: Vector2<f64>,
    pub(crate) value: f64,
    /// Slope of the function to the left of the tangent.
    pub(crate) slope_left: f64,
}

/// End of a continuation.
#[derive(Debug, Clone, Copy)]
pub(crate) enum End {
    /// Back at the start.
    Closed,
    /// The next step would reach this point, which must not be passed.
    Met(f64, OnCurve),
    /// The step became too small.
    Stuck,
}

impl OnCurve {
    /// Returns the same point with the opposite direction.
    pub(crate) fn back(self) -> Self {
        Self {
            tangent: -self.tangent,
            slope_left: -self.slope_left,
            ..self
        }
    }
}

impl<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)> Level<F> {
    pub(crate) fn at(&self, phi: &Vector2<f64>) -> (f64, Vector2<f64>) {
        self.0(phi)
    }

    /// Zero on a segment whose ends have opposite signs.
    pub(crate) fn between(&self, a: &Vector2<f64>, b: &Vector2<f64>) -> Option<Vector2<f64>> {
        let along = b - a;
        let falls = if self.at(b).0 > self.at(a).0 {
            -1.0
        } else {
            1.0
        };
        let (phi, _) = locate(
            [0.5, 1.0],
            1e-16,
            |share| Some(a + along * share),
            |phi| {
                let (value, gradient) = self.at(phi);
                (falls * value, falls * gradient.dot(&along))
            },
        )?;
        (self.at(&phi).0.abs() <= POLISHED).then_some(phi)
    }

    /// Continues the curve from the last of the points, appending points, until it is closed or must not be continued.
    pub(crate) fn walk(
        &self,
        points: &mut Vec<OnCurve>,
        stride: Stride,
        may_pass: impl Fn(&OnCurve) -> bool,
    ) -> End {
        let Some(start) = points.last().copied() else {
            return End::Stuck;
        };
        let (mut here, mut step) = (start, stride.longest);
        let fewest = points.len() + FEWEST_ROUND;
        while points.len() < MOST_POINTS {
            let to_start = start.phi - here.phi;
            let ahead = to_start.dot(&here.tangent);
            let back_home = points.len() > fewest
                && ahead > 0.0
                && to_start.norm() <= step.max(0.5 * stride.longest)
                && (to_start - here.tangent * ahead).norm() <= 0.25 * ahead
                && here.tangent.dot(&start.tangent) > 0.9;
            if back_home {
                points.push(start);
                return End::Closed;
            }
            match self.stepped(&here, step, stride.turn) {
                Some(next) if !may_pass(&next) => return End::Met(step, next),
                Some(next) => {
                    points.push(next);
                    here = next;
                    step = (1.4 * step).min(stride.longest);
                }
                None if step < SHORTEST * stride.longest => break,
                None => step *= 0.5,
            }
        }
        End::Stuck
    }

    /// Point within a step at which a value falls through zero, with its distance along the step.
    pub(crate) fn cut(
        &self,
        here: &OnCurve,
        step: f64,
        value: impl Fn(&OnCurve) -> (f64, f64),
    ) -> Option<(OnCurve, f64)> {
        let at = |length: f64| {
            let guess = here.phi + here.tangent * length;
            self.corrected(&guess, Some(&here.tangent), step)
        };
        // The curve bends within the step, so the slope differs slightly.
        locate([0.5 * step, step], 1e-22, at, value)
    }

    /// Performs one step along the curve. Returns `None` if it would turn too much or leave the curve.
    fn stepped(&self, here: &OnCurve, step: f64, most_turn: f64) -> Option<OnCurve> {
        let guess = here.phi + here.tangent * step;
        let next = self.corrected(&guess, Some(&here.tangent), 0.2 * step)?;
        let turn = here
            .tangent
            .perp(&next.tangent)
            .atan2(here.tangent.dot(&next.tangent));
        // The chord must agree with both tangents; otherwise the step changed to another branch.
        let chord = (next.phi - here.phi).normalize();
        let kink = here
            .tangent
            .perp(&chord)
            .abs()
            .max(chord.perp(&next.tangent).abs());
        // The slope changes its sign only at a crossing.
        let goes_on =
            || here.slope_left * next.slope_left >= 0.0 || self.node(here, &next).is_some();
        (turn.abs() <= most_turn && kink <= 0.8 * most_turn && goes_on()).then_some(next)
    }

    /// Crossing with another curve between two points, with the direction of the other curve to the left.
    pub(crate) fn node(&self, before: &OnCurve, after: &OnCurve) -> Option<OnCurve> {
        let (a, b) = (before.slope_left.abs(), after.slope_left.abs());
        let guess = before.phi + (after.phi - before.phi) * (a / (a + b));
        let mut phi = guess;
        let mut hessian = Matrix2::zeros();
        for _ in 0..20 {
            hessian = self.hessian(&phi);
            let step = hessian.try_inverse()? * self.at(&phi).1;
            phi -= step;
            if step.norm() < 1e-13 {
                break;
            }
        }
        let apart = (after.phi - before.phi).norm();
        let (value, _) = self.at(&phi);
        // The second derivative vanishes along the curve and along the one that crosses it.
        let along = (after.phi - before.phi).normalize();
        let across = Vector2::new(-along.y, along.x);
        let [mixed, second] = [along, across].map(|way| across.dot(&(hessian * way)));
        let left = (along * second - across * (2.0 * mixed)) * -mixed.signum();
        let is_node = value.abs() <= POLISHED && (phi - guess).norm() <= apart && mixed != 0.0;
        is_node.then(|| OnCurve {
            phi,
            tangent: left.normalize(),
            value,
            slope_left: 0.0,
        })
    }

    fn hessian(&self, phi: &Vector2<f64>) -> Matrix2<f64> {
        let h = 1e-5;
        let column =
            |step: Vector2<f64>| (self.at(&(phi + step)).1 - self.at(&(phi - step)).1) / (2.0 * h);
        let raw = Matrix2::from_columns(&[Vector2::x() * h, Vector2::y() * h].map(column));
        (raw + raw.transpose()) * 0.5
    }

    /// Newton corrector along the gradient, within `reach` of the guess; the tangent is oriented along `onward`.
    pub(crate) fn corrected(
        &self,
        guess: &Vector2<f64>,
        onward: Option<&Vector2<f64>>,
        reach: f64,
    ) -> Option<OnCurve> {
        let mut phi = *guess;
        let mut best: Option<OnCurve> = None;
        for _ in 0..12 {
            let (value, gradient) = self.at(&phi);
            let slope = gradient.norm();
            if !(value.is_finite() && slope > 0.0 && (phi - guess).norm() <= reach) {
                break;
            }
            if best.is_some_and(|best| value.abs() >= best.value.abs()) {
                break;
            }
            let tangent = Vector2::new(gradient.y, -gradient.x) / slope;
            let along = onward.is_none_or(|onward| tangent.dot(onward) >= 0.0);
            best = Some(OnCurve {
                phi,
                tangent: if along { tangent } else { -tangent },
                value,
                slope_left: if along { slope } else { -slope },
            });
            if value.abs() <= ROUNDING {
                break;
            }
            phi -= gradient * (value / (slope * slope));
        }
        best.filter(|best| best.value.abs() <= POLISHED)
    }
}
