//! Extremals without an initial guess: circles, Fourier series of rising order, then shooting.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::fourier::{FARTHEST, Maximum, Objective, best_circles, best_ellipses, climb, series};
use super::{Branch, EfficiencyError, Method};
use crate::certificate::crossings;
use crate::extremal::Extremal;
use crate::extremal::guess::quarter_of_curve;
use crate::extremal::shooting::solve;
use crate::parallel::Watch;

/// Origin of an extremal.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Origin {
    /// Order of the Fourier series that was the initial guess.
    pub(crate) order: usize,
    /// Method that produced the initial guess.
    pub(crate) method: &'static str,
    /// ξ of the curve that a direct method found, before shooting.
    pub(crate) direct_efficiency: Option<f64>,
}

impl Origin {
    /// Origin of an extremal that started from the arcs of another.
    pub(crate) fn arcs() -> Self {
        Self {
            order: 0,
            method: Method::Shooting.word(),
            direct_efficiency: None,
        }
    }
}

/// Order of the series, number of panels per quarter, gain at which the ascent stops, and numbers of pieces of the shooting.
const LADDER: [(usize, usize, f64, &[usize]); 10] = [
    (1, 8, 1e-6, &[]),
    (2, 8, 1e-6, &[]),
    (3, 11, 1e-6, &[]),
    (4, 14, 1e-7, &[8, 16]),
    (6, 22, 1e-8, &[8, 16]),
    (9, 22, 1e-9, &[8, 16]),
    (13, 32, 1e-9, &[8, 16]),
    (18, 32, 1e-10, &[16, 32]),
    (24, 43, 1e-15, &[16, 32]),
    (32, 43, 1e-15, &[16, 32]),
];
/// Relative change of the efficiency at which a series counts as converged in its order.
const SETTLED: f64 = 1e-8;
const SETTLED_PIECES: &[usize] = &[8];
/// Accepted ratio of the extremal's efficiency to that of the direct method. Except for the quadrature error of the direct method
/// the extremal cannot be worse; outside this range it is another extremal.
const SAME_GAIT: std::ops::Range<f64> = 1.0 - 1e-5..1.05;

/// Initial guesses for a branch: coefficients of order 1.
pub(crate) fn starts(model: &Model<f64>, branch: Branch) -> Result<Vec<[f64; 2]>, EfficiencyError> {
    let circles = best_circles(model, branch.sign());
    if !circles.is_empty() {
        return Ok(circles.into_iter().map(|a| [a, a]).collect());
    }
    let (ellipses, best) = best_ellipses(model, branch.sign());
    if ellipses.is_empty() {
        return Err(EfficiencyError::NoStart { branch, best });
    }
    Ok(ellipses)
}

/// Solves the Fourier problem to a low order, then shoots; raises the order if shooting does not converge. With the method
/// `fourier`, shooting starts from the order at which the series has converged. `watch` receives the share of the orders that have
/// been solved.
pub(crate) fn extremal_from(
    model: &Model<f64>,
    (branch, method): (Branch, Method),
    start: [f64; 2],
    watch: Watch<'_>,
) -> Result<(Extremal, Origin), EfficiencyError> {
    let mut last: Option<(usize, Maximum)> = None;
    let mut saddle = None;
    let alone = method == Method::Fourier;
    for (rung, (order, panels, gain, bridges)) in LADDER.into_iter().enumerate() {
        watch(rung as f64 / LADDER.len() as f64);
        // Each order starts from the previous one.
        let (mut from, before) = match &last {
            Some((_, below)) => (below.coefficients.clone(), below.value.efficiency()),
            None => (start.to_vec(), f64::NAN),
        };
        from.resize(2 * order, 0.0);
        let mut objective = Objective::new(model, order, panels);
        let maximum = climb(|x| objective.expansion(x), &from, gain);
        let maximum = maximum.ok_or(EfficiencyError::RunsAway {
            branch,
            amplitude: start[0],
            order,
            efficiency: before,
            farthest: FARTHEST,
        })?;
        let efficiency = maximum.value.efficiency();
        let bridges = if alone {
            let settled = (efficiency / before - 1.0).abs() < SETTLED;
            if settled { SETTLED_PIECES } else { &[] }
        } else {
            bridges
        };
        for &pieces in bridges {
            let Some(extremal) = shot(model, &maximum, pieces) else {
                continue;
            };
            let origin = Origin {
                order,
                method: if alone { method } else { Method::Shooting }.word(),
                direct_efficiency: alone.then_some(efficiency),
            };
            // Newton's method also converges to saddles; the converged series is a maximum.
            if alone || extremal.ascents(model) == Some(0) {
                return Ok((extremal, origin));
            }
            saddle.get_or_insert((extremal, origin));
        }
        if !alone && !bridges.is_empty() && saddle.is_none() {
            simple(branch, order, &maximum)?;
        }
        last = Some((order, maximum));
    }
    // A saddle is returned with its certificate, which reports it.
    saddle.ok_or(EfficiencyError::NotConverged {
        branch,
        order: last.as_ref().map_or(0, |(order, _)| *order),
        efficiency: last.map_or(f64::NAN, |(_, maximum)| maximum.value.efficiency()),
    })
}

/// Refuses a gait that crosses itself, which is outside the class.
fn simple(branch: Branch, order: usize, maximum: &Maximum) -> Result<(), EfficiencyError> {
    let sides = 256;
    let points: Vec<Vector2<f64>> = (0..=sides)
        .map(|i| std::f64::consts::TAU * f64::from(i % sides) / f64::from(sides))
        .map(|s| series(&maximum.coefficients, s).0)
        .collect();
    match crossings(&points) {
        0 => Ok(()),
        crossings => Err(EfficiencyError::CrossesItself {
            branch,
            order,
            efficiency: maximum.value.efficiency(),
            crossings,
        }),
    }
}

/// Extremal that shooting with this number of pieces finds near a series.
fn shot(model: &Model<f64>, maximum: &Maximum, pieces: usize) -> Option<Extremal> {
    let curve = |s| series(&maximum.coefficients, s);
    let extremal = solve(model, quarter_of_curve(model, &curve, pieces)?).ok()?;
    same_gait(model, extremal, maximum.value.efficiency(), maximum.value.x)
}

/// Returns the extremal if it is the one near the guess, and `None` if Newton's method converged to another.
pub(crate) fn same_gait(
    model: &Model<f64>,
    extremal: Extremal,
    efficiency: f64,
    x: f64,
) -> Option<Extremal> {
    let ratio = extremal.efficiency(model) / efficiency;
    (extremal.heading() * x > 0.0 && SAME_GAIT.contains(&ratio)).then_some(extremal)
}
