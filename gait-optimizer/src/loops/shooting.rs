//! Shooting for a closed loop: Gauss–Newton iteration on the start point and the direction of the momentum.

use nalgebra::{Matrix3x2, Vector2, Vector3};
use swimmer_model::Model;

use super::flow::{ClosedOrbit, Launch, ReturnCondition};
use crate::momentum::{Momentum, Motion, pose, shape};
use crate::numerics::damped;
use crate::region::Region;

/// One-parameter family of starts.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Section {
    /// Start for parameter 0.
    pub(crate) at: Vector2<f64>,
    /// Derivative of the start by the parameter.
    pub(crate) along: Vector2<f64>,
    /// Bound that contains the start, which the curve leaves there.
    pub(crate) bound: Option<usize>,
}

/// Initial guess for a closed loop.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Guess {
    pub(crate) section: Section,
    /// Angle of p against the heading at the section's start \[rad\].
    pub(crate) angle: f64,
    /// Approximate length of the loop \[rad\].
    pub(crate) length: f64,
}

/// Unknowns: parameter of the section, and angle of p against the heading at the start \[rad\].
type At = Vector2<f64>;

/// Tolerances of the integration.
const COARSE: f64 = 1e-8;
const FINE: f64 = 1e-13;
const ROUNDS: usize = 30;
/// Largest step in both unknowns.
const STRIDE: f64 = 0.12;
/// Residual at which the fine integration starts; the next constant is the residual at which the iteration stops.
const NEAR: f64 = 1e-4;
const CLOSED: f64 = 1e-11;

struct Problem<'a> {
    model: &'a Model<f64>,
    region: &'a Region,
    guess: Guess,
}

/// Closes a loop from an initial guess.
pub(crate) fn close(model: &Model<f64>, region: &Region, guess: Guess) -> Option<ClosedOrbit> {
    let problem = Problem {
        model,
        region,
        guess,
    };
    let mut here = At::new(0.0, guess.angle);
    let mut tolerance = COARSE;
    let (mut miss, mut orbit) = problem.shoot(&here, tolerance)?;
    for _ in 0..ROUNDS {
        if miss.norm() < NEAR && tolerance > FINE {
            tolerance = FINE;
            (miss, orbit) = problem.shoot(&here, tolerance)?;
        }
        let step = problem.step(&here, &miss, tolerance)?;
        let mut factors = damped((STRIDE / step.amax()).min(1.0)).take(8);
        let better = factors.find_map(|factor| {
            let there = here + step * factor;
            let (new, new_lap) = problem.shoot(&there, tolerance)?;
            (new.norm() < miss.norm()).then_some((there, new, new_lap))
        });
        let Some((there, new, new_lap)) = better else {
            break;
        };
        (here, miss, orbit) = (there, new, new_lap);
        if miss.norm() < 1e-13 {
            break;
        }
    }
    (tolerance <= FINE && miss.norm() < CLOSED).then_some(orbit)
}

impl Problem<'_> {
    fn start(&self, at: &At) -> Vector2<f64> {
        let section = &self.guess.section;
        let straight = section.at + section.along * at.x;
        match section.bound.and_then(|index| self.region.bound(index)) {
            Some(bound) => bound.onto(&straight),
            None => straight,
        }
    }

    /// Residuals at the end of the orbit: position, heading, and displacement across p.
    fn shoot(&self, at: &At, tolerance: f64) -> Option<(Vector3<f64>, ClosedOrbit)> {
        let section = &self.guess.section;
        let start = self.start(at);
        let momentum = Momentum::of_zero(self.model, &start, at.y)?;
        let state = [start.x, start.y, 0.0, 0.0, 0.0, 0.0];
        let (height, ..) = momentum.evaluate(self.model, &shape(&state), &pose(&state));
        let ahead = height.singular_direction();
        let launch = Launch {
            model: self.model,
            region: self.region,
            momentum,
            start,
            first: Motion::Singular,
            until: section
                .bound
                .map_or(ReturnCondition::Line, ReturnCondition::Exit),
            ahead,
            shortest: 0.5 * self.guess.length,
            near: 1.0,
            tolerance,
        };
        let orbit = launch.orbit()?;
        let end = orbit.end;
        let off = Vector2::new(end[0], end[1]) - start;
        let miss = Vector3::new(
            off.dot(&section.along),
            end[4],
            momentum.p.perp(&Vector2::new(end[2], end[3])),
        );
        miss.norm().is_finite().then_some((miss, orbit))
    }

    /// Gauss–Newton step with a finite-difference Jacobian.
    fn step(&self, at: &At, miss: &Vector3<f64>, tolerance: f64) -> Option<Vector2<f64>> {
        let h = if tolerance < 1e-10 { 1e-6 } else { 1e-4 };
        let column = |way: Vector2<f64>| {
            let [there, back] = [h, -h].map(|h| self.shoot(&(at + way * h), tolerance));
            match (there, back) {
                (Some((a, _)), Some((b, _))) => Some((a - b) / (2.0 * h)),
                (Some((a, _)), None) => Some((a - miss) / h),
                (None, Some((b, _))) => Some((miss - b) / h),
                (None, None) => None,
            }
        };
        let slopes = Matrix3x2::from_columns(&[column(Vector2::x())?, column(Vector2::y())?]);
        let step = slopes.tr_mul(&slopes).try_inverse()? * slopes.tr_mul(&-miss);
        step.norm().is_finite().then_some(step)
    }
}
