//! Detection of the paper's two symmetries in a sampled cycle with any starting point.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, GaitFile};
use swimmer_model::Gait as _;

use super::limits::image;
use super::resolution::{MOST_MISSED, Rounding, missed_between};

/// Largest distance of the image of an exact sample from the curve \[rad\].
const CLOSE: f64 = 1e-7;
/// Largest number of points on the diagonal that are tried as the start.
const MOST_STARTS: usize = 16;

/// Returns `true` if the cycle has the paper's two symmetries, in time too, within the accuracy of its samples.
pub(super) fn is_symmetric(gait: &GaitFile) -> bool {
    let Ok(curve) = AnyGait::from_file(gait) else {
        return false;
    };
    let within = |close: f64| {
        gait.u.iter().zip(&gait.phi).all(|(&u, shape)| {
            (curve.at(0.5 - u).phi - image(*shape, 1)).norm() < close
                && (curve.at(u + 0.5).phi + shape).norm() < close
        })
    };
    // The rounding is evaluated only if it matters.
    let written = || CLOSE + 4.0 * Rounding::of(gait).phi;
    within(CLOSE) || within(written() + MOST_MISSED) && within(written() + missed_between(gait))
}

/// Rotates the cycle to start at φ₁ = φ₂ if it has the paper's symmetries from there but not from its first sample. Returns `None`
/// otherwise.
pub(super) fn begun_on_the_diagonal(gait: &GaitFile) -> Option<GaitFile> {
    if is_symmetric(gait) {
        return None;
    }
    let near = 1e-9 + 4.0 * Rounding::of(gait).phi;
    let alike = |phi: &Vector2<f64>| (phi.x - phi.y).abs() < near && phi.x > -near;
    // On an interval along the diagonal only its ends and the ends of arcs are tried.
    let is_end = |u: f64| gait.arcs.iter().any(|arc| (arc.from - u).abs() <= 1e-12);
    let last = gait.u.len().saturating_sub(1);
    let on = |at: usize| gait.phi.get(at).is_some_and(alike);
    (1..last)
        .filter(|&at| on(at))
        .filter(|&at| !on(at + 1) || !on(at - 1) || gait.u.get(at).is_some_and(|&u| is_end(u)))
        .take(MOST_STARTS)
        .map(|at| gait.begun_at(at))
        .find(|gait| is_symmetric(gait) && ends_upwards(gait))
}

/// Returns `true` if the first quarter ends at φ₂ > 0. A cycle crosses the diagonal twice, and its quarters begin at one of the
/// crossings.
fn ends_upwards(gait: &GaitFile) -> bool {
    let end = gait.u.partition_point(|&u| u < 0.25 - 1e-12);
    gait.phi.get(end).is_some_and(|phi| phi.y > 0.0)
}
