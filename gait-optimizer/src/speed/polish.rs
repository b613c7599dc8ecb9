//! A chain of known arcs brought to rounding: Newton's method on its corners, times and bends, with all multipliers.

mod conditions;

use nalgebra::DVector;

use self::conditions::{Conditions, Equation, equations};
use super::chain::{Layout, Net};
use super::ensemble::turned;
use super::expansion::Expansion;
use super::quadrature::Rule;
use super::setting::Setting;
use super::structure::Link;
use crate::member::Member;

/// A chain that meets all equations of its arcs.
#[derive(Debug, Clone)]
pub(crate) struct Polished {
    pub(crate) links: Vec<Link>,
    pub(crate) layout: Layout,
    pub(crate) z: DVector<f64>,
    pub(crate) net: Net,
    pub(crate) speed: f64,
    /// Multipliers of the holds, corner by corner: what the bound pushes with, positive where it is needed.
    pub(crate) hold_pushes: Vec<Vec<f64>>,
    /// Least eigenvalue of the second variation on shifts that keep all equations; positive at a maximum of the speed.
    pub(crate) convexity: f64,
}

/// Quadrature points on an arc.
pub(super) const POINTS: usize = 32;
const MOST_STEPS: usize = 39;
/// Most times that a solution gives way to the other of its fold.
const FOLDS: usize = 4;
/// Residuals below this are rounding, for shapes of the scale of 1 rad.
const ROUNDING: f64 = 2e-12;
/// Bends of a singular arc.
pub(crate) const BENDS: usize = 8;

/// |d|/(L T) of a chain, played to one swimmer of many.
pub(crate) fn speed_of(chain: &Polished, member: &Member) -> f64 {
    let Polished { layout, z, .. } = chain;
    let turned = turned(layout, z, member.gain);
    let (_, net) = layout.net(&member.model, &Rule::new(POINTS), &turned);
    net.distance() / layout.period(z)
}

/// Polishes a chain. Returns `None` if Newton's method does not converge.
pub(crate) fn polish(setting: &Setting, links: &[Link]) -> Option<Polished> {
    let rule = Rule::new(POINTS);
    let (layout, z) = written(setting, links);
    let equations = equations(setting, links);
    let conditions = Conditions {
        setting,
        layout: &layout,
        rule: &rule,
        equations: &equations,
    };
    let mut solution = solve(&conditions, z)?;
    for _ in 0..FOLDS {
        if solution.convexity > 0.0 {
            break;
        }
        let Some(other) = beyond_the_fold(&conditions, &solution) else {
            break;
        };
        solution = other;
    }
    let Solution {
        z,
        y,
        evaluate,
        convexity,
        ..
    } = solution;
    let net = evaluate.net;
    let mut hold_pushes = vec![Vec::new(); links.len()];
    for (equation, push) in equations.iter().zip(y.iter().skip(conditions.global())) {
        if let Equation::Held { corner, .. } = equation {
            // Minimised: the multiplier of margin ≥ 0 is minus the equation's.
            hold_pushes[*corner].push(-push);
        }
    }
    let mut links = links.to_vec();
    for (k, link) in links.iter_mut().enumerate() {
        link.corner = layout.corner(&z, k);
        link.time = z[layout.time_index(k)];
        link.bends = layout.bends(&z, k).to_vec();
    }
    Some(Polished {
        links,
        speed: setting.measure(&net) / layout.period(&z),
        layout,
        z,
        net,
        hold_pushes,
        convexity,
    })
}

/// The least eigenvalue of the second variation of a chain that is known to meet all equations, whoever made it.
pub(crate) fn second_variation(setting: &Setting, links: &[Link]) -> Option<f64> {
    let rule = Rule::new(POINTS);
    let (layout, z) = written(setting, links);
    let conditions = Conditions {
        setting,
        layout: &layout,
        rule: &rule,
        equations: &equations(setting, links),
    };
    let y = conditions.evaluate(&z, None)?.nearest_multipliers()?;
    Some(conditions.evaluate(&z, Some(&y))?.convexity().0)
}

/// A chain as unknowns.
fn written(setting: &Setting, links: &[Link]) -> (Layout, DVector<f64>) {
    let shapes = links
        .iter()
        .map(|link| link.motion.shape(setting, link.bends.len().max(BENDS)))
        .collect();
    let layout = Layout::new(shapes);
    let mut z = DVector::zeros(layout.size);
    for (k, link) in links.iter().enumerate() {
        z[2 * k] = link.corner.x;
        z[2 * k + 1] = link.corner.y;
        z[layout.time_index(k)] = link.time;
        for (bend, value) in link.bends.iter().enumerate().take(layout.shapes[k].bends()) {
            z[layout.bends_index(k) + bend] = *value;
        }
    }
    (layout, z)
}

/// Point at which all conditions hold.
struct Solution {
    z: DVector<f64>,
    y: DVector<f64>,
    evaluate: Expansion,
    /// Least eigenvalue of the second variation, and its shift.
    convexity: f64,
    weakest: DVector<f64>,
}

/// Newton's method from `z`. Returns `None` if it does not converge.
fn solve(conditions: &Conditions, mut z: DVector<f64>) -> Option<Solution> {
    let mut y = conditions.evaluate(&z, None)?.nearest_multipliers()?;
    // Slopes of the objective, a logarithm, are over the scale of the angles.
    let size = conditions.setting.region.scale();
    let mut best = f64::INFINITY;
    let mut stalls = 0;
    for _ in 0..MOST_STEPS {
        let evaluate = conditions.evaluate(&z, Some(&y))?;
        let residual = evaluate.residual(&y, size);
        if residual < ROUNDING {
            break;
        }
        stalls = if residual < 0.5 * best { 0 } else { stalls + 1 };
        best = best.min(residual);
        if stalls > 3 && best < 1e-9 {
            break;
        }
        if stalls > 12 {
            return None;
        }
        let (step, next) = evaluate.step()?;
        let scale = (0.3 * size / step.amax()).min(1.0);
        z += step * scale;
        y = next;
    }
    let evaluate = conditions.evaluate(&z, Some(&y))?;
    if evaluate.residual(&y, size) > 1e-9 {
        return None;
    }
    let (convexity, weakest) = evaluate.convexity();
    Some(Solution {
        z,
        y,
        evaluate,
        convexity,
        weakest,
    })
}

/// The other solution of the fold to which one belongs that is no maximum.
///
/// Where a singular arc meets a bound, the few shapes that its bends describe make the meeting point weakly determined: to
/// second order hardly anything depends on it, and to third order a saddle lies close to the maximum. Along the weakest shift
/// the slope is λt + λ't²/2, so the other solution is near t = −2λ/λ'.
fn beyond_the_fold(conditions: &Conditions, saddle: &Solution) -> Option<Solution> {
    /// Step of the difference quotient, over the scale of the shapes.
    const STEP: f64 = 1e-4;
    /// Shifts of corners and times that still are near, over the same.
    const NEAR: f64 = 0.1;
    /// The next orders may put it further away.
    const FURTHER: [f64; 4] = [1.0, 1.5, 2.0, 3.0];
    let Solution {
        z,
        y,
        convexity,
        weakest,
        ..
    } = saddle;
    let bend = |t: f64| {
        let evaluate = conditions.evaluate(&(z + weakest * t), Some(y))?;
        Some(weakest.dot(&(&evaluate.hessian * weakest)))
    };
    let size = conditions.setting.region.scale();
    let step = STEP * size;
    let third = (bend(step)? - bend(-step)?) / (2.0 * step);
    let shift = -2.0 * convexity / third;
    FURTHER
        .into_iter()
        .map(|times| times * shift)
        .filter(|shift| shift.abs() < NEAR * size)
        .find_map(|shift| {
            let other = solve(conditions, z + weakest * shift)?;
            // Not back where it was.
            ((&other.z - z).norm() > 0.5 * shift.abs()).then_some(other)
        })
}
