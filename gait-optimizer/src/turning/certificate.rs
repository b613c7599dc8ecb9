//! The proof of a turning gait: it runs along the edge of what turns left, and by two other ways turns as much.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, ArcKind};
use swimmer_model::{Gait as _, Model, Stroke, Tolerance, swim};

use super::piece::Piece;
use crate::certificate::{Certificate, Check, simple_and_turning_once};
use crate::cycle::Cycle;
use crate::height_map::Level;
use crate::height_map::legendre::gauss;
use crate::region::Region;

/// Slopes are asked for farther than this from the ends of a free arc \[rad\]: where zero-level curves cross, they vanish.
const FROM_ENDS: f64 = 0.02;
/// Centres of circles are tried on a grid of this many points a side.
const CIRCLES: u32 = 9;

/// Signed area that the pieces enclose \[rad²\].
pub(super) fn area(pieces: &[Piece]) -> f64 {
    let twice: f64 = pieces
        .iter()
        .flat_map(|piece| piece.points.iter().zip(piece.points.iter().skip(1)))
        .map(|(a, b)| a.perp(b))
        .sum();
    0.5 * twice
}

/// All conditions. None where the cycle makes no gait.
pub(super) fn certificate<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)>(
    model: &Model<f64>,
    region: &Region,
    level: &Level<F>,
    pieces: &[Piece],
    cycle: &Cycle,
    stroke: &Stroke<f64>,
) -> Option<Certificate> {
    let gait = cycle.gait().ok()?;
    let mut checks = Vec::new();
    let (mut free, mut slope, mut on_bound) = (0.0_f64, f64::INFINITY, f64::INFINITY);
    for piece in pieces {
        let (first, last) = (piece.points.first()?, piece.points.last()?);
        for (i, phi) in piece.points.iter().enumerate() {
            let (value, gradient) = level.at(phi);
            if piece.kind == ArcKind::Singular {
                free = free.max(value.abs());
                let from_ends = (phi - first).norm().min((phi - last).norm());
                if let (Some(before), Some(after)) = (
                    i.checked_sub(1).and_then(|i| piece.points.get(i)),
                    piece.points.get(i + 1),
                ) && from_ends > FROM_ENDS
                {
                    let along = after - before;
                    let left = Vector2::new(-along.y, along.x) / along.norm();
                    slope = slope.min(gradient.dot(&left));
                }
            } else {
                on_bound = on_bound.min(value);
            }
        }
    }
    let has = |kind: bool| {
        pieces
            .iter()
            .any(|piece| (piece.kind == ArcKind::Singular) == kind)
    };
    if has(true) {
        checks.push(Check::at_most("curvature_on_free_arcs", free, 1e-12));
    }
    if slope.is_finite() {
        checks.push(Check::at_least("slope_to_the_left_least", slope, 1e-9));
    }
    if has(false) {
        checks.push(Check::at_least(
            "curvature_on_bounds_least",
            on_bound,
            -1e-12,
        ));
    }
    let overstepped = cycle
        .phi
        .iter()
        .map(|phi| region.overstepped(phi))
        .fold(f64::NEG_INFINITY, f64::max);
    checks.push(Check::at_most("bound_overstepped_rad", overstepped, 1e-10));
    checks.extend(simple_and_turning_once(&cycle.phi, &cycle.phi));
    let enclosed = enclosed(model, &gait, cycle);
    checks.push(Check::at_most(
        "rotation_off_area_integral_rad",
        (enclosed - stroke.rotation).abs(),
        1e-8,
    ));
    checks.push(Check::at_least("rotation_rad_least", stroke.rotation, 1e-9));
    checks.push(Check::at_most(
        "best_circle_inside_gain_rad",
        best_circle(model, &cycle.phi) - stroke.rotation,
        0.0,
    ));
    Some(Certificate::new(checks))
}

/// ∬ F_θ over what the gait encloses, from the curvature alone: ∮ G dφ₂ with ∂G/∂φ₁ = F_θ.
fn enclosed(model: &Model<f64>, gait: &AnyGait, cycle: &Cycle) -> f64 {
    // The gait is a cubic between its samples, its rate a parabola: exact but for the potential beyond the second degree.
    let (outer, outer_weights) = gauss(3);
    let (inner, inner_weights) = gauss(24);
    let middle = cycle.phi.iter().map(|phi| phi.x).sum::<f64>() / cycle.phi.len().max(1) as f64;
    let potential = |phi: &Vector2<f64>| -> f64 {
        let half = 0.5 * (phi.x - middle);
        let sum: f64 = inner
            .iter()
            .zip(&inner_weights)
            .map(|(s, w)| {
                let at = Vector2::new(middle + half * (s + 1.0), phi.y);
                w * model.first_derivatives(&at).curvature().z
            })
            .sum();
        half * sum
    };
    let mut sum = 0.0;
    for (a, b) in cycle.u.iter().zip(cycle.u.iter().skip(1)) {
        for (s, w) in outer.iter().zip(&outer_weights) {
            let point = gait.at(a + 0.5 * (s + 1.0) * (b - a));
            sum += 0.5 * w * (b - a) * potential(&point.phi) * point.rate.y;
        }
    }
    sum
}

/// The most that a circle inside the loop turns.
fn best_circle(model: &Model<f64>, curve: &[Vector2<f64>]) -> f64 {
    let low = curve
        .iter()
        .fold(Vector2::repeat(f64::INFINITY), |low, phi| low.inf(phi));
    let high = curve
        .iter()
        .fold(Vector2::repeat(f64::NEG_INFINITY), |high, phi| {
            high.sup(phi)
        });
    let mut best = f64::NEG_INFINITY;
    for i in 1..CIRCLES {
        for j in 1..CIRCLES {
            let share = Vector2::new(f64::from(i), f64::from(j)) / f64::from(CIRCLES);
            let centre = low + (high - low).component_mul(&share);
            if !inside(curve, &centre) {
                continue;
            }
            let radius = curve
                .iter()
                .map(|phi| (phi - centre).norm())
                .fold(f64::INFINITY, f64::min);
            let turned = circle(&centre, 0.999 * radius)
                .map(|gait| swim(model, &gait, &Tolerance::new(1e-9)).rotation);
            best = best.max(turned.unwrap_or(f64::NEG_INFINITY));
        }
    }
    best
}

fn circle(centre: &Vector2<f64>, radius: f64) -> Option<AnyGait> {
    let u: Vec<f64> = (0..=96).map(|k| f64::from(k) / 96.0).collect();
    let mut phi: Vec<Vector2<f64>> = u
        .iter()
        .map(|u| {
            let (sin, cos) = (u * std::f64::consts::TAU).sin_cos();
            centre + Vector2::new(cos, sin) * radius
        })
        .collect();
    let first = *phi.first()?;
    *phi.last_mut()? = first;
    AnyGait::from_samples(&u, &phi, &[]).ok()
}

/// Whether a point lies inside a closed polygon.
fn inside(curve: &[Vector2<f64>], point: &Vector2<f64>) -> bool {
    let crossed = curve.iter().zip(curve.iter().skip(1)).filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y)
            && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}
