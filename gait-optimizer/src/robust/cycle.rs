//! From the design's quarter to the sampled cycle.

use nalgebra::{DVector, Vector2};
use swimmer_files::{ArcKind, GaitArc};
use swimmer_model::{Gait, Model, SymmetricFourier};

use super::arcs::Arcs;
use crate::Arc;
use crate::cycle::Cycle;

/// Samples of an arc.
const SAMPLES: u32 = 128;
/// Samples of a cycle of a series.
const CYCLE: u32 = 1024;
/// Directions this close in angle \[rad\] make no corner.
const SMOOTH: f64 = 1e-6;

/// The cycle of a displacement gait, at constant power of the nominal swimmer, with the quarter's arcs.
pub(super) fn of_arcs(model: &Model<f64>, family: &Arcs, x: &DVector<f64>) -> (Cycle, Vec<Arc>) {
    let nodes = family.nodes();
    let curves = family.curves(x);
    let mut quarter: Vec<(f64, Vector2<f64>)> = Vec::new();
    // Where each arc ends, as ∫√P.
    let (mut length, mut ends) = (0.0, Vec::with_capacity(curves.len()));
    for curve in &curves {
        let speed: Vec<f64> = curve
            .phi
            .iter()
            .zip(&curve.slope)
            .map(|(phi, slope)| {
                slope
                    .dot(&(model.power_matrix(phi) * slope))
                    .max(0.0)
                    .sqrt()
            })
            .collect();
        let lengths: Vec<Vector2<f64>> = nodes
            .integrals(&speed)
            .into_iter()
            .map(|along| Vector2::new(along, 0.0))
            .collect();
        let from = u32::from(!quarter.is_empty());
        for sample in from..=SAMPLES {
            let t = f64::from(sample) / f64::from(SAMPLES);
            quarter.push((
                length + nodes.value(&lengths, t).x,
                nodes.value(&curve.phi, t),
            ));
        }
        length += lengths.last().map_or(0.0, |along| along.x);
        ends.push(length);
    }
    let quarter: Vec<(f64, Vector2<f64>)> = quarter
        .into_iter()
        .map(|(along, phi)| (0.25 * along / length, phi))
        .collect();
    let ends: Vec<f64> = ends.into_iter().map(|end| 0.25 * end / length).collect();
    let begins_square = curves
        .first()
        .and_then(|curve| curve.slope.first())
        .is_some_and(|slope| (slope.x + slope.y).abs() < SMOOTH * slope.norm());
    let ends_square = curves
        .last()
        .and_then(|curve| curve.slope.last())
        .is_some_and(|slope| (slope.x - slope.y).abs() < SMOOTH * slope.norm());
    // Corners of the quarter by number of sample, images and all counted below.
    let arcs = family
        .kinds()
        .zip(&curves)
        .filter_map(|(kind, curve)| {
            Some(Arc {
                kind,
                from: (*curve.phi.first()?).into(),
                to: (*curve.phi.last()?).into(),
            })
        })
        .collect();
    let inner: Vec<f64> = ends
        .iter()
        .take(ends.len().saturating_sub(1))
        .copied()
        .collect();
    let kinds: Vec<ArcKind> = family.kinds().collect();
    (
        unfolded(&quarter, &inner, &kinds, begins_square, ends_square),
        arcs,
    )
}

/// The cycle of a series, timed as it is.
pub(super) fn of_series(gait: &SymmetricFourier<Vec<[f64; 2]>>) -> (Cycle, Vec<Arc>) {
    let u: Vec<f64> = (0..=CYCLE)
        .map(|i| f64::from(i) / f64::from(CYCLE))
        .collect();
    let mut phi: Vec<Vector2<f64>> = u.iter().map(|&u| gait.at(u).phi).collect();
    if let (Some(first), Some(last)) = (phi.first().copied(), phi.last_mut()) {
        *last = first;
    }
    let arcs = vec![Arc {
        kind: ArcKind::Regular,
        from: gait.at(0.0).phi.into(),
        to: gait.at(0.25).phi.into(),
    }];
    let cycle = Cycle {
        u,
        phi,
        corners: Vec::new(),
        arcs: vec![GaitArc {
            kind: ArcKind::Regular,
            from: 0.0,
            to: 1.0,
        }],
    };
    (cycle, arcs)
}

/// Mirrored in φ₁ = −φ₂, run backwards, then turned by half.
fn unfolded(
    quarter: &[(f64, Vector2<f64>)],
    inner: &[f64],
    kinds: &[ArcKind],
    begins_square: bool,
    ends_square: bool,
) -> Cycle {
    let mut cycle = Cycle {
        u: Vec::with_capacity(4 * quarter.len()),
        phi: Vec::with_capacity(4 * quarter.len()),
        corners: Vec::new(),
        arcs: Vec::new(),
    };
    // The sample at a junction is found again by its place in the quarter, so that corners are samples to the last bit.
    let is = |u: f64, places: &[f64]| places.iter().any(|place| (place - u).abs() < 1e-12);
    for (before, sign) in [(0.0, 1.0), (0.5, -1.0)] {
        let last = quarter.len().saturating_sub(1);
        for (index, (u, phi)) in quarter.iter().enumerate().take(last) {
            if (index == 0 && !begins_square) || is(*u, inner) {
                cycle.corners.push(before + u);
            }
            cycle.u.push(before + u);
            cycle.phi.push(phi * sign);
        }
        for (index, (u, phi)) in quarter.iter().enumerate().skip(1).rev() {
            let at = before + 0.5 - u;
            if (index == last && !ends_square) || is(*u, inner) {
                cycle.corners.push(at);
            }
            cycle.u.push(at);
            cycle.phi.push(Vector2::new(-phi.y, -phi.x) * sign);
        }
        let places: Vec<f64> = std::iter::once(0.0)
            .chain(inner.iter().copied())
            .chain([0.25])
            .collect();
        let spans = || kinds.iter().zip(places.windows(2));
        for (kind, span) in spans() {
            if let [from, to] = span {
                cycle.arcs.push(GaitArc {
                    kind: *kind,
                    from: before + from,
                    to: before + to,
                });
            }
        }
        let images: Vec<GaitArc> = spans()
            .filter_map(|(kind, span)| match span {
                [from, to] => Some(GaitArc {
                    kind: *kind,
                    from: before + 0.5 - to,
                    to: before + 0.5 - from,
                }),
                _ => None,
            })
            .collect();
        cycle.arcs.extend(images.into_iter().rev());
    }
    cycle.u.push(1.0);
    cycle.phi.extend(cycle.phi.first().copied());
    cycle
}
