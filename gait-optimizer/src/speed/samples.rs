//! A polished chain as one cycle of samples, each arc with its own.

use nalgebra::Vector2;
use swimmer_files::GaitArc;

use super::arc::Shape;
use super::polish::Polished;
use super::problem::Setting;
use crate::cycle::Cycle;
use crate::optimal_gait::Arc;

/// Fewest samples on a straight arc and on a curved one.
const STRAIGHT: usize = 16;
const CURVED: usize = 160;
/// Samples of a whole cycle, about.
const SAMPLES: usize = 512;

/// The cycle timed at the servos' rates, from the corner farthest along φ₁ = φ₂.
pub(crate) fn cycle(setting: &Setting, polished: &Polished) -> (Cycle, Vec<Arc>) {
    let Polished {
        links, layout, z, ..
    } = polished;
    let n = links.len();
    let sum = |k: usize| links[k].corner.sum();
    let first = (0..n)
        .max_by(|&a, &b| sum(a).total_cmp(&sum(b)))
        .unwrap_or(0);
    let period = layout.period(z);
    let mut cycle = Cycle {
        u: Vec::new(),
        phi: Vec::new(),
        corners: Vec::new(),
        arcs: Vec::new(),
    };
    let mut arcs = Vec::with_capacity(n);
    let mut begun = 0.0;
    for k in (0..n).map(|k| (first + k) % n) {
        let share = links[k].time / period;
        let shape = layout.shapes[k];
        let fewest = if shape == Shape::Straight {
            STRAIGHT
        } else {
            CURVED
        };
        let count = (1..SAMPLES)
            .find(|&count| count as f64 >= share * SAMPLES as f64)
            .unwrap_or(SAMPLES)
            .max(fewest);
        let from = begun / period;
        let ends = layout.ends(z, k);
        for step in 0..count {
            let s = step as f64 / count as f64;
            cycle.u.push(from + share * s);
            cycle.phi.push(shape.at(&ends, layout.bends(z, k), s));
        }
        begun += links[k].time;
        let kind = links[k].motion.kind(|index| setting.region.bound(index));
        cycle.corners.push(from);
        cycle.arcs.push(GaitArc {
            kind,
            from,
            to: begun / period,
        });
        arcs.push(Arc {
            kind,
            from: ends[0].into(),
            to: ends[1].into(),
        });
    }
    cycle.u.push(1.0);
    cycle.phi.extend(cycle.phi.first().copied());
    if let Some(last) = cycle.arcs.last_mut() {
        last.to = 1.0;
    }
    (cycle, arcs)
}

/// The same cycle run backwards, from the same shape.
pub(crate) fn reversed(cycle: &Cycle, arcs: &[Arc]) -> (Cycle, Vec<Arc>) {
    let back = |u: f64| if u > 0.0 { 1.0 - u } else { 0.0 };
    let mut corners: Vec<f64> = cycle.corners.iter().map(|&u| back(u)).collect();
    corners.sort_by(f64::total_cmp);
    let u: Vec<f64> = cycle.u.iter().rev().map(|&u| 1.0 - u).collect();
    let phi: Vec<Vector2<f64>> = cycle.phi.iter().rev().copied().collect();
    let reversed = Cycle {
        u,
        phi,
        corners,
        arcs: cycle
            .arcs
            .iter()
            .rev()
            .map(|arc| GaitArc {
                kind: arc.kind,
                from: 1.0 - arc.to,
                to: 1.0 - arc.from,
            })
            .collect(),
    };
    let arcs = arcs
        .iter()
        .rev()
        .map(|arc| Arc {
            kind: arc.kind,
            from: arc.to,
            to: arc.from,
        })
        .collect();
    (reversed, arcs)
}
