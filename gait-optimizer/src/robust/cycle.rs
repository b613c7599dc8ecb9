//! Conversion of the design's quarter to a sampled cycle.

use nalgebra::Vector2;
use swimmer_files::{ArcKind, GaitArc, GaitFile};
use swimmer_model::{Model, SymmetricFourier};

use super::nodes::Nodes;
use super::quarter::ArcCurve;
use crate::cycle::{Cycle, Samples, power};

/// Number of samples per arc.
const SAMPLES: u32 = 128;
/// Number of samples of the cycle of a series.
const CYCLE: usize = 1024;
/// Change of direction \[rad\] below which there is no corner.
const SMOOTH: f64 = 1e-6;

/// Cycle of a displacement gait with these arcs, at constant power of the nominal swimmer.
pub(super) fn of_arcs(
    model: &Model<f64>,
    nodes: &Nodes,
    kinds: impl Iterator<Item = ArcKind>,
    curves: &[ArcCurve],
) -> Cycle {
    let mut quarter = Samples::default();
    let mut length = 0.0;
    for (kind, curve) in kinds.zip(curves) {
        let moving = curve.phi.iter().zip(&curve.slope);
        let speed = moving.map(|(phi, slope)| power(model, phi, slope).max(0.0).sqrt());
        let speed: Vec<f64> = speed.collect();
        let lengths = nodes.integrals(&speed);
        let first = quarter.phi.len().saturating_sub(1);
        for sample in u32::from(!quarter.phi.is_empty())..=SAMPLES {
            let t = f64::from(sample) / f64::from(SAMPLES);
            quarter.along.push(length + nodes.value(&lengths, t));
            quarter.phi.push(nodes.value(&curve.phi, t));
        }
        length += lengths.last().copied().unwrap_or_default();
        quarter.corners.push(first);
        quarter.arcs.push((kind, first, quarter.phi.len() - 1));
    }
    let square = |slope: Option<&Vector2<f64>>, sign: f64| {
        slope.is_some_and(|slope| (slope.x + sign * slope.y).abs() < SMOOTH * slope.norm())
    };
    quarter.unfolded([
        square(curves.first().and_then(|curve| curve.slope.first()), 1.0),
        square(curves.last().and_then(|curve| curve.slope.last()), -1.0),
    ])
}

/// Cycle of a series with its own timing.
pub(super) fn of_series(gait: &SymmetricFourier<Vec<[f64; 2]>>) -> Cycle {
    let GaitFile { u, phi, .. } = GaitFile::sampled(gait, CYCLE);
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
