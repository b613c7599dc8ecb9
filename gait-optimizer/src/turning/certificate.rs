//! The proof of a turning gait: it runs along the edge of what turns left, and by two other ways turns as much.

use nalgebra::Vector2;
use swimmer_files::{AnyGait, ArcKind};
use swimmer_model::{Fourier, Gait as _, Harmonic, Model, Tolerance, swim};

use super::Loop;
use super::piece::Piece;
use super::walk::Domain;
use crate::certificate::{Certificate, Check, simple_and_turning_once};
use crate::cycle::Cycle;
use crate::height_map::legendre::gauss;

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

/// All conditions.
pub(super) fn certificate<F: Fn(&Vector2<f64>) -> (f64, Vector2<f64>)>(
    model: &Model<f64>,
    domain: &Domain<'_, F>,
    found: &Loop,
) -> Certificate {
    let Loop {
        pieces,
        cycle,
        gait,
        stroke,
    } = found;
    let mut checks = Vec::new();
    let (mut free, mut slope, mut on_bound) = (0.0_f64, f64::INFINITY, f64::INFINITY);
    for piece in pieces {
        let ends = [piece.points.first(), piece.points.last()];
        for (i, phi) in piece.points.iter().enumerate() {
            let (value, gradient) = domain.level.at(phi);
            if piece.kind != ArcKind::Singular {
                on_bound = on_bound.min(value);
                continue;
            }
            free = free.max(value.abs());
            let near_end = |end: &Vector2<f64>| (phi - end).norm() <= FROM_ENDS;
            if ends.into_iter().flatten().any(near_end) {
                continue;
            }
            let before = i.checked_sub(1).and_then(|i| piece.points.get(i));
            if let Some((before, after)) = before.zip(piece.points.get(i + 1)) {
                let along = after - before;
                let left = Vector2::new(-along.y, along.x) / along.norm();
                slope = slope.min(gradient.dot(&left));
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
        .map(|phi| domain.region.overstepped(phi))
        .fold(f64::NEG_INFINITY, f64::max);
    checks.push(Check::at_most("bound_overstepped_rad", overstepped, 1e-10));
    checks.extend(simple_and_turning_once(&cycle.phi, &cycle.phi));
    let enclosed = enclosed(model, gait, cycle);
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
    Certificate::new(checks)
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
            let circle = Fourier {
                mean: centre,
                harmonics: [Harmonic {
                    cos: Vector2::new(0.999 * radius, 0.0),
                    sin: Vector2::new(0.0, 0.999 * radius),
                }],
            };
            best = best.max(swim(model, &circle, &Tolerance::new(1e-9)).rotation);
        }
    }
    best
}

/// Whether a point lies inside a closed polygon.
fn inside(curve: &[Vector2<f64>], point: &Vector2<f64>) -> bool {
    let crossed = curve.iter().zip(curve.iter().skip(1)).filter(|(a, b)| {
        (a.y > point.y) != (b.y > point.y)
            && point.x < a.x + (b.x - a.x) * (point.y - a.y) / (b.y - a.y)
    });
    crossed.count() % 2 == 1
}
