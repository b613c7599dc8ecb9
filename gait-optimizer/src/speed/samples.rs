//! A polished chain as one cycle of samples, each arc with its own.

use swimmer_files::GaitArc;

use super::arc::Shape;
use super::polish::Polished;
use super::setting::Setting;
use crate::cycle::Cycle;

/// Fewest samples on a straight arc and on a curved one.
const STRAIGHT: usize = 16;
const CURVED: usize = 160;
/// Samples of a whole cycle, about.
const SAMPLES: usize = 512;

/// Sums of angles that are closer than this are as far along φ₁ = φ₂ as each other.
const TIED: f64 = 1e-6;

/// The cycle timed at the servos' rates, from the corner farthest along φ₁ = φ₂ (of equals the one of the largest φ₁). With `sign`
/// −1 the mirrored swimmer's.
pub(crate) fn cycle(setting: &Setting, polished: &Polished, sign: f64) -> Cycle {
    let links = &polished.links;
    let n = links.len();
    let corner = |k: usize| links[k].corner * sign;
    let farthest = (0..n).map(|k| corner(k).sum()).fold(f64::MIN, f64::max);
    let first = (0..n)
        .filter(|&k| corner(k).sum() > farthest - TIED)
        .max_by(|&a, &b| corner(a).x.total_cmp(&corner(b).x))
        .unwrap_or(0);
    cycle_from(setting, polished, sign, first)
}

/// The same from the corner of this number.
pub(crate) fn cycle_from(setting: &Setting, polished: &Polished, sign: f64, first: usize) -> Cycle {
    let Polished {
        links, layout, z, ..
    } = polished;
    let n = links.len();
    let period = layout.period(z);
    let mut cycle = Cycle::default();
    let mut begun = 0.0;
    for k in (0..n).map(|k| (first + k) % n) {
        let share = links[k].time / period;
        let fewest = if layout.shapes[k] == Shape::Straight {
            STRAIGHT
        } else {
            CURVED
        };
        let count = (1..SAMPLES)
            .find(|&count| count as f64 >= share * SAMPLES as f64)
            .unwrap_or(SAMPLES)
            .max(fewest);
        let from = begun / period;
        for step in 0..count {
            let s = step as f64 / count as f64;
            cycle.u.push(from + share * s);
            cycle.phi.push(layout.place(z, k, s).phi * sign);
        }
        begun += links[k].time;
        let kind = links[k].motion.kind(setting.region);
        cycle.corners.push(from);
        cycle.arcs.push(GaitArc {
            kind,
            from,
            to: begun / period,
        });
    }
    cycle.u.push(1.0);
    cycle.phi.extend(cycle.phi.first().copied());
    if let Some(last) = cycle.arcs.last_mut() {
        last.to = 1.0;
    }
    cycle
}
