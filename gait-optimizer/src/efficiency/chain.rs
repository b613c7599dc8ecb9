//! From no guess to a polished extremal: circles, Fourier series of rising order, multiple shooting, single shooting.

use nalgebra::Vector2;
use swimmer_model::Model;

use super::fourier::{
    Ends, Grid, Maximum, Objective, best_circles, best_ellipses, climb, raised, series,
};
use super::shooting::{Final, Polished, RESIDUAL, last_state, polish};
use super::start::Start;
use super::{Branch, EfficiencyError, Method, multiple, second_order};
use crate::certificate::crossings;

/// A polished extremal and where it came from.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Found {
    pub(crate) polished: Polished,
    /// What led to the start of the polish.
    pub(crate) method: Method,
    /// ξ of the curve that a direct method found by itself.
    pub(crate) direct_efficiency: Option<f64>,
}

/// Joint angles beyond this are not followed \[rad\].
pub(crate) const FARTHEST: f64 = 9.0;
/// Weight of constant speed in the Fourier objective: enough to make the Hessian regular.
const GAUGE: f64 = 0.01;
/// Orders that lead to multiple shooting, the nodes of the quarter's grid, the gain that a climb stops at, and the numbers
/// of segments tried from there.
const BRIDGES: [(usize, usize, f64, &[usize]); 8] = [
    (1, 24, 1e-6, &[]),
    (2, 24, 1e-6, &[]),
    (3, 32, 1e-6, &[]),
    (4, 40, 1e-7, &[8, 16]),
    (6, 64, 1e-8, &[8, 16]),
    (9, 64, 1e-9, &[8, 16]),
    (13, 96, 1e-9, &[8, 16]),
    (18, 96, 1e-10, &[16, 32]),
];
/// Orders of the pure Fourier method, with their grids and gains.
const ORDERS: [(usize, usize, f64); 10] = [
    (1, 48, 1e-4),
    (2, 48, 1e-4),
    (3, 48, 1e-6),
    (4, 64, 1e-8),
    (6, 64, 1e-10),
    (9, 96, 1e-12),
    (13, 96, 1e-14),
    (18, 96, 1e-15),
    (24, 128, 1e-15),
    (32, 128, 1e-15),
];
/// The extremal may be better than the gait of the direct method by this factor. It cannot be worse, but for the error of the
/// direct method's quadrature: else it is another extremal.
const SAME_GAIT: std::ops::Range<f64> = 1.0 - 1e-5..1.05;

/// Starts for a branch: coefficients of order 1.
pub(crate) fn starts(model: &Model<f64>, branch: Branch) -> Result<Vec<[f64; 2]>, EfficiencyError> {
    let grid = Grid::new(32);
    let circles = best_circles(model, &grid, branch.sign());
    if !circles.is_empty() {
        return Ok(circles.into_iter().map(|a| [a, a]).collect());
    }
    let (ellipses, best) = best_ellipses(model, &grid, branch.sign());
    if ellipses.is_empty() {
        return Err(EfficiencyError::NoStart { branch, best });
    }
    Ok(ellipses)
}

/// Fourier to a low order, then multiple shooting; higher orders where that does not converge.
pub(crate) fn by_multiple_shooting(
    model: &Model<f64>,
    branch: Branch,
    start: [f64; 2],
) -> Result<Found, EfficiencyError> {
    let mut ladder = Ladder::new(model, branch, start);
    let (mut last, mut saddle) = (None, None);
    for (order, nodes, gain, bridges) in BRIDGES {
        let maximum = ladder.climb_to(order, nodes, gain)?;
        for &segments in bridges {
            if let Some(polished) = bridged(model, &maximum, segments) {
                let found = Found {
                    polished,
                    method: Method::Shooting,
                    direct_efficiency: None,
                };
                if is_maximum(model, &polished) {
                    return Ok(found);
                }
                saddle.get_or_insert(found);
            }
        }
        if !bridges.is_empty() && saddle.is_none() {
            simple(branch, order, &maximum)?;
        }
        last = Some((order, maximum));
    }
    // A saddle is told with its certificate, which says so.
    saddle.ok_or_else(|| not_converged(branch, last.as_ref()))
}

/// Whether an extremal passes the second-order test: Newton's method takes saddles as well.
fn is_maximum(model: &Model<f64>, polished: &Polished) -> bool {
    last_state(model, &polished.at_end)
        .and_then(|(flow, last)| second_order::test(flow, &last))
        .is_some_and(|test| test.least_determinant > 0.0 && test.bend_at_start < 0.0)
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

/// Fourier alone up to orders where the single shooting converges from it.
pub(crate) fn by_fourier(
    model: &Model<f64>,
    branch: Branch,
    start: [f64; 2],
) -> Result<Found, EfficiencyError> {
    let mut ladder = Ladder::new(model, branch, start);
    let mut last: Option<(usize, Maximum)> = None;
    for (order, nodes, gain) in ORDERS {
        let maximum = ladder.climb_to(order, nodes, gain)?;
        let settled = last.as_ref().is_some_and(|(_, before)| {
            (maximum.value.efficiency() / before.value.efficiency() - 1.0).abs() < 1e-8
        });
        if settled && let Some(polished) = polished(model, &maximum) {
            return Ok(Found {
                polished,
                method: Method::Fourier,
                direct_efficiency: Some(maximum.value.efficiency()),
            });
        }
        last = Some((order, maximum));
    }
    Err(not_converged(branch, last.as_ref()))
}

pub(crate) fn not_converged(branch: Branch, last: Option<&(usize, Maximum)>) -> EfficiencyError {
    EfficiencyError::NotConverged {
        branch,
        order: last.map_or(0, |(order, _)| *order),
        efficiency: last.map_or(f64::NAN, |(_, maximum)| maximum.value.efficiency()),
    }
}

/// Fourier gaits of rising order, each started from the one below.
pub(crate) struct Ladder<'a> {
    model: &'a Model<f64>,
    branch: Branch,
    amplitude: f64,
    coefficients: Vec<f64>,
    efficiency: f64,
}

impl<'a> Ladder<'a> {
    pub(crate) fn new(model: &'a Model<f64>, branch: Branch, start: [f64; 2]) -> Self {
        Self {
            model,
            branch,
            amplitude: start[0],
            coefficients: start.to_vec(),
            efficiency: f64::NAN,
        }
    }

    pub(crate) fn climb_to(
        &mut self,
        order: usize,
        nodes: usize,
        least_gain: f64,
    ) -> Result<Maximum, EfficiencyError> {
        let grid = Grid::new(nodes);
        let objective = Objective {
            model: self.model,
            grid: &grid,
            gauge: GAUGE,
        };
        let from = raised(&self.coefficients, order);
        let ends = Ends {
            least_gain,
            farthest: FARTHEST,
        };
        let maximum = climb(&objective, &from, ends).ok_or(EfficiencyError::RunsAway {
            branch: self.branch,
            amplitude: self.amplitude,
            order,
            efficiency: self.efficiency,
            farthest: FARTHEST,
        })?;
        self.coefficients.clone_from(&maximum.coefficients);
        self.efficiency = maximum.value.efficiency();
        Ok(maximum)
    }
}

fn curve(maximum: &Maximum) -> impl Fn(f64) -> (Vector2<f64>, Vector2<f64>) {
    |s| series(&maximum.coefficients, s)
}

fn polished(model: &Model<f64>, maximum: &Maximum) -> Option<Polished> {
    let start = Start::of_curve(model, &curve(maximum), 1)?;
    let polished = polish(model, &final_values(model, &start)?)?;
    same_gait(polished, maximum.value.efficiency(), maximum.value.x)
}

fn bridged(model: &Model<f64>, maximum: &Maximum, segments: usize) -> Option<Polished> {
    let start = Start::of_curve(model, &curve(maximum), segments)?;
    let solved = multiple::solve(model, &start)?;
    let polished = polish(model, &final_values(model, &solved)?)?;
    same_gait(polished, maximum.value.efficiency(), maximum.value.x)
}

/// Newton's method may end at another extremal than the one it was started near: none then.
pub(crate) fn same_gait(polished: Polished, efficiency: f64, x: f64) -> Option<Polished> {
    let ratio = polished.efficiency() / efficiency;
    let same_way = polished.at_end[1] * x > 0.0;
    (same_way && SAME_GAIT.contains(&ratio) && polished.residual <= RESIDUAL).then_some(polished)
}

/// φ₁, x, θ and E at the end: E is the power there, and `x_f = E_f/κ`.
pub(crate) fn final_values(model: &Model<f64>, start: &Start) -> Option<Final> {
    let last = start.states.last()?;
    let flow = super::flow::Flow {
        model,
        kappa: start.kappa,
        sense: 1.0,
    };
    let energy = flow.moment(last).power;
    Some(Final::new(last[0], energy / start.kappa, last[2], energy))
}
