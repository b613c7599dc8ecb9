//! Loops of most displacement, started where the heading is square to it or, where none is, as near to it as it gets.

use swimmer_files::GaitArc;
use swimmer_model::{Gait, Model, Tolerance, trajectory};

use super::{Sideways, SidewaysProblem, settled};
use crate::certificate::Check;
use crate::cycle::Cycle;
use crate::simple_shapes::top;
use crate::{Arc, OptimalGait};

/// Instants that headings are looked at.
const LOOKS: usize = 720;

/// The gait from the start with most of its displacement across the heading.
pub(super) fn turned(
    problem: &SidewaysProblem,
    model: &Model<f64>,
    gait: &OptimalGait,
) -> Option<Sideways> {
    let any = gait.gait().ok()?;
    let d = (gait.displacement_over_length, gait.lateral_over_length);
    // |d · heading| at every instant: the less, the more of d is across.
    let mut along: Vec<(f64, f64)> = Vec::with_capacity(LOOKS + 1);
    trajectory(model, &any, &Tolerance::new(1e-12), LOOKS, |point| {
        let (sin, cos) = point.pose.theta.sin_cos();
        along.push((point.u, d.0 * cos + d.1 * sin));
    });
    let crossing = along
        .windows(2)
        .find(|pair| matches!(pair, [a, b] if a.1 * b.1 <= 0.0));
    let start = if let Some([low, high]) = crossing {
        crossed(*low, *high, |u| along_at(model, &any, u, d))
    } else {
        let least = along
            .iter()
            .min_by(|a, b| a.1.abs().total_cmp(&b.1.abs()))?;
        let width = 1.0 / LOOKS as f64;
        let less_along = |u: f64| -along_at(model, &any, u.rem_euclid(1.0), d).abs();
        top(&less_along, (least.0 - width, least.0 + width), 1e-13)
    };
    let cycle = shifted(gait, &any, start.rem_euclid(1.0))?;
    let across = along_at(model, &any, start.rem_euclid(1.0), d);
    let expected = (d.0 * d.0 + d.1 * d.1 - across * across).max(0.0).sqrt();
    let checks: Vec<Check> = gait
        .certificate
        .checks()
        .iter()
        .filter(|check| !matches!(check.name, "displacement_swum_again" | "net_rotation_rad"))
        .copied()
        .collect();
    let arcs = arcs(&cycle);
    settled((problem, model), (cycle, arcs), checks, (expected, 1e-8))
}

/// Where a value changes sign between two places.
fn crossed(low: (f64, f64), high: (f64, f64), value: impl Fn(f64) -> f64) -> f64 {
    let (mut low, mut high) = (low, high);
    for _ in 0..60 {
        let middle = 0.5 * (low.0 + high.0);
        let here = value(middle);
        if here * low.1 > 0.0 {
            low = (middle, here);
        } else {
            high = (middle, here);
        }
    }
    0.5 * (low.0 + high.0)
}

/// d · heading at one instant.
fn along_at(model: &Model<f64>, gait: &impl Gait<f64>, u: f64, d: (f64, f64)) -> f64 {
    let mut found = f64::NAN;
    for panel in swimmer_model::Panels::new(model, gait, &Tolerance::new(1e-12)) {
        if u <= panel.end() {
            let (sin, cos) = panel.pose(u).theta.sin_cos();
            found = d.0 * cos + d.1 * sin;
            break;
        }
    }
    found
}

/// The cycle from another start, which becomes a sample.
pub(super) fn shifted(gait: &OptimalGait, any: &impl Gait<f64>, by: f64) -> Option<Cycle> {
    const CLOSE: f64 = 1e-6;
    // A sample that is all but there already is the start.
    let by = gait
        .u()
        .iter()
        .copied()
        .find(|u| (u - by).abs() < CLOSE)
        .unwrap_or(by);
    let start = any.at(by).phi;
    let turned = |u: f64| {
        let rest = u - by;
        if rest < 0.0 { rest + 1.0 } else { rest }
    };
    let mut samples: Vec<(f64, nalgebra::Vector2<f64>)> = gait
        .u()
        .iter()
        .zip(gait.phi())
        .take(gait.u().len().checked_sub(1)?)
        .map(|(&u, phi)| (turned(u), *phi))
        .filter(|(u, _)| *u > CLOSE && *u < 1.0 - CLOSE)
        .collect();
    samples.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut u = vec![0.0];
    let mut phi = vec![start];
    for (at, shape) in samples {
        u.push(at);
        phi.push(shape);
    }
    u.push(1.0);
    phi.push(start);
    let mut corners: Vec<f64> = gait
        .corners()
        .iter()
        .map(|&u| turned(u))
        .filter(|u| *u > CLOSE && *u < 1.0 - CLOSE)
        .collect();
    corners.extend(
        gait.corners()
            .iter()
            .any(|u| turned(*u) < CLOSE || turned(*u) > 1.0 - CLOSE)
            .then_some(0.0),
    );
    corners.sort_by(f64::total_cmp);
    let mut arcs: Vec<GaitArc> = Vec::new();
    for arc in gait.cycle_arcs() {
        let (from, to) = (turned(arc.from), turned(arc.to));
        let to = if to == 0.0 { 1.0 } else { to };
        if from < to {
            arcs.push(GaitArc { from, to, ..*arc });
        } else {
            arcs.push(GaitArc {
                from,
                to: 1.0,
                ..*arc
            });
            arcs.push(GaitArc {
                from: 0.0,
                to,
                ..*arc
            });
        }
    }
    arcs.retain(|arc| arc.to - arc.from > CLOSE);
    arcs.sort_by(|a, b| a.from.total_cmp(&b.from));
    Some(Cycle {
        u,
        phi,
        corners,
        arcs,
    })
}

fn arcs(cycle: &Cycle) -> Vec<Arc> {
    let at = |u: f64| {
        let index = cycle.u.partition_point(|&place| place < u - 1e-12);
        cycle
            .phi
            .get(index)
            .map_or([f64::NAN; 2], |phi| [phi.x, phi.y])
    };
    cycle
        .arcs
        .iter()
        .map(|arc| Arc {
            kind: arc.kind,
            from: at(arc.from),
            to: at(arc.to),
        })
        .collect()
}
