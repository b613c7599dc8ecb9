//! Rows with held reflectors: the tracking system lost them, or a file was repaired by repeating the last row. They are copies of
//! a measurement, not measurements: a robot that swims on is at another place.

use nalgebra::Vector3;

use super::follow::Row;
use crate::median::median;

/// More copies than this in a row are held. Noise makes each row its own, but that of good cameras before a thing at rest is
/// a few of their digits only, and two rows of three repeat by chance.
const MOST_SAME: usize = 2;
/// If more than this share of single steps from row to row is zero, rows repeat for other reasons: coarse digits, or a rate that
/// was raised by doubling rows.
const MOST_SINGLE: f64 = 0.05;
/// After a true rest the next steps are of the usual size; after a hold they are larger, by this factor at least.
const CATCHES_UP: f64 = 1.5;
/// Steps after a held stretch that are compared.
const NEXT: usize = 3;
/// Below this share of the usual step there is no noise: a computed recording, in which rest repeats as well.
const NO_NOISE: f64 = 0.3;

/// Held rows, and number of stretches.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(super) struct Frozen {
    pub(super) rows: usize,
    pub(super) stretches: usize,
}

/// Removes the copies, which leaves a gap.
pub(super) fn take_frozen(rows: &mut Vec<Row>) -> Frozen {
    let copies = copies(rows);
    let mut at = copies.iter().flat_map(|(from, until)| *from..*until);
    let mut next = at.next();
    let mut index = 0;
    let before = rows.len();
    rows.retain(|_| {
        let keep = next != Some(index);
        if !keep {
            next = at.next();
        }
        index += 1;
        keep
    });
    Frozen {
        rows: before - rows.len(),
        stretches: copies.len(),
    }
}

/// Stretches (first copy, first row that is no copy).
fn copies(rows: &[Row]) -> Vec<(usize, usize)> {
    let way = |a: &Row, b: &Row| (b.front - a.front).norm().hypot((b.back - a.back).norm());
    let mut same: Vec<(usize, usize)> = Vec::new();
    let mut ways = Vec::new();
    for (i, pair) in rows.windows(2).enumerate() {
        let [a, b] = pair else { continue };
        if b.index - a.index > 1 {
            continue;
        }
        if (a.front, a.back) != (b.front, b.back) {
            ways.push(way(a, b));
            continue;
        }
        match same.last_mut() {
            Some((_, until)) if *until == i + 1 => *until = i + 2,
            _ => same.push((i + 1, i + 2)),
        }
    }
    let single = same.iter().filter(|(from, until)| until - from == 1);
    if single.count() as f64 > MOST_SINGLE * ways.len() as f64 {
        return Vec::new();
    }
    let usual = median(ways.into_iter()).unwrap_or(0.0);
    let noisy = bend(rows) > NO_NOISE * usual;
    let caught_up = |until: usize| {
        let after = rows.get(until - 1..).unwrap_or(&[]);
        let mut steps = after.windows(2).take(1 + NEXT).map(|pair| match pair {
            [a, b] => way(a, b),
            _ => 0.0,
        });
        let leap = steps.next().unwrap_or(0.0);
        leap > CATCHES_UP * steps.fold(0.0, f64::max)
    };
    same.retain(|(from, until)| until - from > MOST_SAME && (noisy || caught_up(*until)));
    same
}

/// By how much a row is usually off the middle of its neighbours \[m\].
fn bend(rows: &[Row]) -> f64 {
    let bends = rows.windows(3).filter_map(|w| match w {
        [a, b, c] if c.index - a.index == 2 && a.front != b.front && b.front != c.front => {
            let off: Vector3<f64> = a.front - 2.0 * b.front + c.front;
            Some(off.norm())
        }
        _ => None,
    });
    median(bends).unwrap_or(0.0)
}
