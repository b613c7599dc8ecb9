//! From the design's quarter to the sampled cycle.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitArc};
use swimmer_model::{Gait, Model, SymmetricFourier};

use super::nodes::Nodes;
use super::quarter::ArcCurve;
use crate::cycle::{Cycle, Samples};

/// Samples of an arc.
const SAMPLES: u32 = 128;
/// Samples of a cycle of a series.
const CYCLE: u32 = 1024;
/// Directions this close in angle \[rad\] make no corner.
const SMOOTH: f64 = 1e-6;

/// The cycle of a displacement gait with these arcs, at constant power of the nominal swimmer.
pub(super) fn of_arcs(
    model: &Model<f64>,
    nodes: &Nodes,
    kinds: impl Iterator<Item = ArcKind>,
    curves: &[ArcCurve],
) -> Cycle {
    let mut quarter = Samples::default();
    let mut length = 0.0;
    for (kind, curve) in kinds.zip(curves) {
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
        let first = quarter.phi.len().saturating_sub(1);
        for sample in u32::from(!quarter.phi.is_empty())..=SAMPLES {
            let t = f64::from(sample) / f64::from(SAMPLES);
            quarter.along.push(length + nodes.value(&lengths, t).x);
            quarter.phi.push(nodes.value(&curve.phi, t));
        }
        length += lengths.last().map_or(0.0, |along| along.x);
        quarter.corners.push(first);
        quarter.arcs.push((kind, first, quarter.phi.len() - 1));
    }
    let square = [
        curves.first().and_then(|curve| curve.slope.first()),
        curves.last().and_then(|curve| curve.slope.last()),
    ];
    let [begins_across, ends_across] = [1.0, -1.0].map(|sign| {
        move |slope: &Vector2<f64>| (slope.x + sign * slope.y).abs() < SMOOTH * slope.norm()
    });
    quarter.unfolded([
        square[0].is_some_and(begins_across),
        square[1].is_some_and(ends_across),
    ])
}

/// The cycle of a series, timed as it is.
pub(super) fn of_series(gait: &SymmetricFourier<Vec<[f64; 2]>>) -> Cycle {
    let u: Vec<f64> = (0..=CYCLE)
        .map(|i| f64::from(i) / f64::from(CYCLE))
        .collect();
    let mut phi: Vec<Vector2<f64>> = u.iter().map(|&u| gait.at(u).phi).collect();
    if let (Some(first), Some(last)) = (phi.first().copied(), phi.last_mut()) {
        *last = first;
    }
    Cycle {
        u,
        phi,
        corners: Vec::new(),
        arcs: vec![GaitArc {
            kind: ArcKind::Regular,
            from: 0.0,
            to: 1.0,
        }],
    }
}
