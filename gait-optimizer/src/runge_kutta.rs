//! The integrator of every arc: Dormand and Prince's explicit method of order 8 with error estimates of order 5 and 3.
//!
//! Source of method and coefficients: E. Hairer, S. P. Nørsett, G. Wanner, *Solving Ordinary Differential Equations I*,
//! 2nd edition, section II.5 (DOP853). It is written here because the published crates either keep every step in growing
//! vectors and find no events (`ode_solvers`) or bring a second linear-algebra stack (`differential-equations`, `diffsol`),
//! while an arc needs one thing: steps of chosen length on a fixed-size array, so that a step can be cut to end exactly
//! where an event is.

mod tableau;

use tableau::{END_WEIGHTS, FIFTH_ORDER, STAGE_WEIGHTS, STAGES, THIRD_ORDER};

/// Right-hand side of an autonomous system.
pub(crate) trait System<const N: usize> {
    /// dz/ds at z.
    fn rate(&self, z: &[f64; N]) -> [f64; N];
}

impl<const N: usize, F: Fn(&[f64; N]) -> [f64; N]> System<N> for F {
    fn rate(&self, z: &[f64; N]) -> [f64; N] {
        self(z)
    }
}

/// A state with its rate.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Point<const N: usize> {
    pub(crate) z: [f64; N],
    pub(crate) rate: [f64; N],
}

impl<const N: usize> Point<N> {
    pub(crate) fn new(system: &impl System<N>, z: [f64; N]) -> Self {
        Self {
            z,
            rate: system.rate(&z),
        }
    }

    fn is_finite(&self) -> bool {
        self.z
            .iter()
            .chain(&self.rate)
            .all(|value| value.is_finite())
    }
}

/// Step size control: the local error stays below `tolerance · max(1, |z|)`.
#[derive(Debug, Clone, Copy)]
pub(crate) struct StepControl {
    pub(crate) tolerance: f64,
    pub(crate) longest: f64,
}

impl StepControl {
    /// Steps as long as this error lets them be.
    pub(crate) const fn to(tolerance: f64) -> Self {
        let longest = f64::INFINITY;
        Self { tolerance, longest }
    }
}

/// An accepted step: where it ended, how long it was, and what to try next.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Accepted<const N: usize> {
    pub(crate) end: Point<N>,
    pub(crate) length: f64,
    pub(crate) next: f64,
}

/// Steps below this are given up: the right-hand side is not smooth there.
const SHORTEST: f64 = 1e-10;

/// One step from `start` of at most `length`, shortened until its error is small enough. Returns `None` if that fails.
pub(crate) fn controlled_step<const N: usize>(
    system: &impl System<N>,
    start: &Point<N>,
    length: f64,
    control: StepControl,
) -> Option<Accepted<N>> {
    let mut length = length.min(control.longest);
    let mut rejected = false;
    loop {
        let (end, error) = trial(system, start, length, control.tolerance);
        // A step whose stages left the domain of definition counts as one that is much too long.
        let factor = if end.is_finite() && error.is_finite() {
            (0.9 / error.max(1e-16).sqrt().sqrt().sqrt()).clamp(0.2, 6.0)
        } else {
            0.2
        };
        if end.is_finite() && error <= 1.0 {
            let growth = if rejected { factor.min(1.0) } else { factor };
            return Some(Accepted {
                end,
                length,
                next: (length * growth).min(control.longest),
            });
        }
        rejected = true;
        length *= factor.min(0.9);
        if length < SHORTEST {
            return None;
        }
    }
}

/// A step of exactly this length, without a look at its error: for cutting a step that was already accepted.
pub(crate) fn exact_step<const N: usize>(
    system: &impl System<N>,
    start: &Point<N>,
    length: f64,
) -> Point<N> {
    trial(system, start, length, 1.0).0
}

/// Integrates over exactly `length`. Returns `None` if the steps become too short.
pub(crate) fn advance<const N: usize>(
    system: &impl System<N>,
    start: Point<N>,
    length: f64,
    control: StepControl,
) -> Option<Point<N>> {
    let mut here = start;
    let mut left = length;
    let mut try_length = length;
    while left > 0.0 {
        // Two nearly equal last steps rather than a long and a tiny one.
        let ahead = if try_length >= left {
            left
        } else if try_length > 0.5 * left {
            0.5 * left
        } else {
            try_length
        };
        let step = controlled_step(system, &here, ahead, control)?;
        here = step.end;
        left = if step.length >= left {
            0.0
        } else {
            left - step.length
        };
        try_length = step.next;
    }
    Some(here)
}

/// The end of a step and its error over the tolerance.
fn trial<const N: usize>(
    system: &impl System<N>,
    start: &Point<N>,
    h: f64,
    tolerance: f64,
) -> (Point<N>, f64) {
    let mut k = [[0.0; N]; STAGES];
    k[0] = start.rate;
    for (stage, weights) in STAGE_WEIGHTS.iter().enumerate() {
        let z = combined(&start.z, h, &k, weights);
        k[stage + 1] = system.rate(&z);
    }
    let z = combined(&start.z, h, &k, &END_WEIGHTS);
    let end = Point {
        z,
        rate: system.rate(&z),
    };
    let (mut fifth, mut third) = (0.0, 0.0);
    for (i, &after) in z.iter().enumerate() {
        let scale = tolerance * start.z[i].abs().max(after.abs()).max(1.0);
        fifth += (weighted(&k, &FIFTH_ORDER, i) / scale).powi(2);
        third += (weighted(&k, &THIRD_ORDER, i) / scale).powi(2);
    }
    // Hairer's mixture of both estimates, which behaves like order 8.
    let mixed = fifth + 0.01 * third;
    let error = if mixed > 0.0 {
        h.abs() * fifth / (mixed * N as f64).sqrt()
    } else {
        0.0
    };
    (end, error)
}

fn combined<const N: usize>(
    z: &[f64; N],
    h: f64,
    k: &[[f64; N]; STAGES],
    weights: &[f64],
) -> [f64; N] {
    let mut sum = [0.0; N];
    for (slope, &weight) in k.iter().zip(weights) {
        if weight != 0.0 {
            for (total, value) in sum.iter_mut().zip(slope) {
                *total += weight * value;
            }
        }
    }
    let mut end = *z;
    for (value, total) in end.iter_mut().zip(&sum) {
        *value += h * total;
    }
    end
}

fn weighted<const N: usize>(k: &[[f64; N]; STAGES], weights: &[f64; STAGES], i: usize) -> f64 {
    k.iter()
        .zip(weights)
        .map(|(slope, weight)| weight * slope[i])
        .sum()
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A planar Kepler orbit of eccentricity 0.5: x, y and their rates, period 2π.
    fn kepler(z: &[f64; 4]) -> [f64; 4] {
        let cubed = z[0].hypot(z[1]).powi(3);
        [z[2], z[3], -z[0] / cubed, -z[1] / cubed]
    }

    const PERIHELION: [f64; 4] = [0.5, 0.0, 0.0, 1.732_050_807_568_877_2];

    #[test]
    fn the_step_has_order_eight() {
        let start = Point::new(&kepler, PERIHELION);
        let reference = advance(
            &kepler,
            start,
            0.4,
            StepControl {
                tolerance: 1e-15,
                longest: 0.02,
            },
        )
        .unwrap();
        let error = |steps: i32| {
            let mut here = start;
            for _ in 0..steps {
                here = exact_step(&kepler, &here, 0.4 / f64::from(steps));
            }
            (0..4)
                .map(|i| (here.z[i] - reference.z[i]).abs())
                .fold(0.0, f64::max)
        };
        let order = (error(4) / error(8)).log2();
        assert!(
            (7.0..10.0).contains(&order),
            "order {order}: {} {}",
            error(4),
            error(8)
        );
    }

    #[test]
    fn an_orbit_closes() {
        let start = Point::new(&kepler, PERIHELION);
        let control = StepControl {
            tolerance: 1e-13,
            longest: 1.0,
        };
        let end = advance(&kepler, start, std::f64::consts::TAU, control).unwrap();
        for (value, first) in end.z.iter().zip(&PERIHELION) {
            assert!((value - first).abs() < 1e-11, "{:?}", end.z);
        }
    }

    #[test]
    fn a_singularity_is_given_up() {
        let blow_up = |z: &[f64; 1]| [z[0] * z[0]];
        let control = StepControl {
            tolerance: 1e-10,
            longest: 1.0,
        };
        assert!(advance(&blow_up, Point::new(&blow_up, [1.0]), 2.0, control).is_none());
    }
}
