//! Gaps: the samples next to them are not trusted, short ones are filled, and both are marked.
//!
//! A reflector that is about to be hidden is partly visible, and its measured centre is displaced. So [`TAIL`] samples on either
//! side of a gap of two rows or more become tails, which the cubic replaces. (One missing row is a lost frame, not a hidden
//! reflector.)
//!
//! A gap of at most the longest fill is filled in x and y of each reflector by the monotone cubic through the means of a few
//! trusted samples on either side: means, because over a gap of ten rows a slope between two neighbouring rows is noise. If one
//! reflector is visible in the gap, the cubic only gives the heading, and the pose comes from the visible one.

use nalgebra::Vector2;

use super::pchip::pchip;

/// Samples on either side of a gap that are not trusted.
pub(super) const TAIL: usize = 3;
/// Rows that a gap must have for that.
const HIDDEN: usize = 2;
/// Knots of the cubic on either side of a gap.
const KNOTS: usize = 2;

/// One row in which both reflectors were seen, in the plane.
#[derive(Debug, Clone, Copy)]
pub(super) struct VisibleRow {
    /// Its row in the file.
    pub(super) row: usize,
    pub(super) time_s: f64,
    pub(super) front: Vector2<f64>,
    pub(super) back: Vector2<f64>,
    /// Beside a gap.
    pub(super) tail: bool,
    /// The first after a jump or a long gap: nothing is filled across.
    pub(super) begins: bool,
}

/// Marks the samples next to gaps; returns their number.
pub(super) fn mark_tails(seen: &mut [VisibleRow]) -> usize {
    let hidden = |pair: &[VisibleRow]| match pair {
        [a, b] => b.row - a.row > HIDDEN,
        _ => false,
    };
    let gaps: Vec<usize> = seen
        .windows(2)
        .enumerate()
        .filter_map(|(i, pair)| hidden(pair).then_some(i + 1))
        .collect();
    for first_after in gaps {
        let from = first_after.saturating_sub(TAIL);
        for sample in seen.iter_mut().skip(from).take(2 * TAIL) {
            sample.tail = true;
        }
    }
    seen.iter().filter(|sample| sample.tail).count()
}

/// The cubic over the gap before `seen[after]`.
pub(super) struct Bridge {
    /// x and y of the front, x and y of the back.
    knots: [Vec<(f64, f64)>; 4],
}

impl Bridge {
    /// `None` where there is no gap.
    pub(super) fn over(seen: &[VisibleRow], after: usize) -> Option<Self> {
        let (before, from) = (seen.get(after.checked_sub(1)?)?, seen.get(after)?);
        let gap_s = from.time_s - before.time_s;
        // As far again as the gap is long, and a tail.
        let lost = from.row - before.row;
        let reach = |sample: &VisibleRow, edge: &VisibleRow| {
            sample.row.abs_diff(edge.row) < TAIL + KNOTS * lost.max(KNOTS)
                && (sample.time_s - edge.time_s).abs() < (KNOTS + TAIL) as f64 * gap_s
        };
        let left = seen.get(..after)?.iter().rev();
        let left = trusted(left.take_while(|sample| reach(sample, before)));
        let right = seen.get(after..)?.iter();
        let right = trusted(right.take_while(|sample| reach(sample, from)));
        let mut knots = blocks(&left, lost);
        knots.reverse();
        knots.extend(blocks(&right, lost));
        let of = |value: fn(&Knot) -> f64| knots.iter().map(|k| (k.0, value(k))).collect();
        Some(Self {
            knots: [of(|k| k.1.x), of(|k| k.1.y), of(|k| k.2.x), of(|k| k.2.y)],
        })
    }

    /// Front and back at a time within the gap.
    pub(super) fn at(&self, time_s: f64) -> Option<(Vector2<f64>, Vector2<f64>)> {
        let [fx, fy, bx, by] = &self.knots;
        let value = |knots: &[(f64, f64)]| pchip(knots, time_s);
        Some((
            Vector2::new(value(fx)?, value(fy)?),
            Vector2::new(value(bx)?, value(by)?),
        ))
    }
}

/// The trusted ones of the samples on one side, or all where gaps follow so closely that none is.
fn trusted<'a>(side: impl Iterator<Item = &'a VisibleRow>) -> Vec<VisibleRow> {
    let all: Vec<VisibleRow> = side.copied().collect();
    let trusted: Vec<VisibleRow> = all.iter().filter(|sample| !sample.tail).copied().collect();
    if trusted.is_empty() { all } else { trusted }
}

/// Time, front, back.
type Knot = (f64, Vector2<f64>, Vector2<f64>);

/// Means of neighbouring samples, at most [`KNOTS`] of them, each as long as half the gap.
fn blocks(samples: &[VisibleRow], lost: usize) -> Vec<Knot> {
    let size = (lost / 2).max(1);
    let mean = |block: &[VisibleRow]| {
        let n = block.len() as f64;
        let sum =
            |value: fn(&VisibleRow) -> Vector2<f64>| block.iter().map(value).sum::<Vector2<f64>>();
        let time = block.iter().map(|sample| sample.time_s).sum::<f64>();
        (time / n, sum(|s| s.front) / n, sum(|s| s.back) / n)
    };
    samples.chunks(size).take(KNOTS).map(mean).collect()
}
