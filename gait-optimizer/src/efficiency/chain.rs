//! From no guess to an extremal: circles, Fourier series of rising order, shooting.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::fourier::{FARTHEST, Maximum, Objective, best_circles, best_ellipses, climb, series};
use super::{Branch, EfficiencyError, Method};
use crate::certificate::crossings;
use crate::extremal::Extremal;
use crate::extremal::guess::quarter_of_curve;
use crate::extremal::shooting::solve;

/// Where an extremal comes from.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Origin {
    /// Order of the Fourier series that it grew from.
    pub(crate) order: usize,
    /// What led to the guess that was shot from.
    pub(crate) method: &'static str,
    /// ξ of the curve that a direct method found by itself.
    pub(crate) direct_efficiency: Option<f64>,
}

impl Origin {
    /// Another extremal's arcs.
    pub(crate) fn arcs() -> Self {
        Self {
            order: 0,
            method: Method::Shooting.word(),
            direct_efficiency: None,
        }
    }
}

/// Orders of the series, the panels of the quarter, the gain that a climb stops at, and the numbers of pieces that are shot from
/// there.
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
/// A series has settled where the next order changes its efficiency by no more than this share; the pieces that it is shot in then.
const SETTLED: f64 = 1e-8;
const SETTLED_PIECES: &[usize] = &[8];
/// The extremal may be better than the gait of the direct method by this factor. It cannot be worse, but for the error of the
/// direct method's quadrature: else it is another extremal.
const SAME_GAIT: std::ops::Range<f64> = 1.0 - 1e-5..1.05;

/// Starts for a branch: coefficients of order 1.
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

/// Fourier to a low order, then shooting; higher orders where that does not converge. By Fourier alone it is shot from the order
/// where the series has settled.
pub(crate) fn extremal_from(
    model: &Model<f64>,
    (branch, method): (Branch, Method),
    start: [f64; 2],
) -> Result<(Extremal, Origin), EfficiencyError> {
    let mut last: Option<(usize, Maximum)> = None;
    let mut saddle = None;
    let alone = method == Method::Fourier;
    for (order, panels, gain, bridges) in LADDER {
        // Each order is started from the one below.
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
            // Newton's method takes saddles as well; what has settled is where the climb led.
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
    // A saddle is told with its certificate, which says so.
    saddle.ok_or(EfficiencyError::NotConverged {
        branch,
        order: last.as_ref().map_or(0, |(order, _)| *order),
        efficiency: last.map_or(f64::NAN, |(_, maximum)| maximum.value.efficiency()),
    })
}

/// A gait that crosses itself is out of the class: no need to look for an extremal near it.
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

/// The extremal that shooting in so many pieces finds near a series.
fn shot(model: &Model<f64>, maximum: &Maximum, pieces: usize) -> Option<Extremal> {
    let curve = |s| series(&maximum.coefficients, s);
    let extremal = solve(model, quarter_of_curve(model, &curve, pieces)?).ok()?;
    same_gait(model, extremal, maximum.value.efficiency(), maximum.value.x)
}

/// Newton's method may end at another extremal than the one it was started near: none then.
pub(crate) fn same_gait(
    model: &Model<f64>,
    extremal: Extremal,
    efficiency: f64,
    x: f64,
) -> Option<Extremal> {
    let ratio = extremal.efficiency(model) / efficiency;
    (extremal.heading() * x > 0.0 && SAME_GAIT.contains(&ratio)).then_some(extremal)
}
