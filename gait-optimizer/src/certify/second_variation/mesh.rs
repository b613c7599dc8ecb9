//! Mesh of the second variation: knots along the curve that carry piecewise linear perturbations (hat functions).

use super::{Gain, Neighbours, SAME};
use crate::certify::grid::Along;
use crate::certify::path::CurveNode;
use crate::certify::{SMOOTH, Subject};

/// Number of intervals of the cycle or of its first quarter; the next constant is the least number per piece.
const PARTS: f64 = 96.0;
const FEWEST: usize = 4;
/// Share of the steepest slope below which knots are not refined further.
const LOOSEST: f64 = 1e-3;

/// Knot; without an index where the curve is held.
pub(super) struct Knot {
    pub(super) u: f64,
    pub(super) number: Option<usize>,
}

/// Knots along the curve, and the number of free ones.
pub(super) struct Mesh {
    pub(super) knots: Vec<Knot>,
    pub(super) count: usize,
}

impl Neighbours<'_> {
    /// Knot density, integrated from u = 0 to every node: half ∫ du and, for objectives without effort, half ∫ ds/L, each normalised. L
    /// is the slope of the height. Where it is small, the curve is weakly determined and needs narrow perturbations.
    fn passed(&self) -> Vec<f64> {
        let Subject {
            grid, path, model, ..
        } = self.subject;
        if self.gain.is_priced() {
            return grid.nodes.iter().map(|node| node.u).collect();
        }
        let slope = |place: &CurveNode| {
            let (height, ..) = self.momentum.evaluate(model, &place.phi, &place.pose);
            height.gradient.norm()
        };
        let slopes: Vec<f64> = path.places.iter().map(slope).collect();
        let steepest = slopes.iter().copied().fold(0.0, f64::max);
        let loose = path.places.iter().zip(&slopes);
        let loose = loose.map(|(place, slope)| place.rate.norm() / slope.max(LOOSEST * steepest));
        let loose: Vec<f64> = loose.collect();
        let mut sums = vec![[0.0; 2]];
        for (nodes, loose) in grid.nodes.array_windows().zip(loose.array_windows()) {
            let ([from, to], [before, after], [u, free]) = (nodes, loose, sums[sums.len() - 1]);
            let more = (to.u - from.u) * f64::midpoint(*before, *after);
            let counts = to.along == Along::Free;
            sums.push([u + to.u - from.u, if counts { free + more } else { free }]);
        }
        let whole = sums[sums.len() - 1][1].max(f64::MIN_POSITIVE);
        sums.iter()
            .map(|[u, free]| f64::midpoint(*u, free / whole))
            .collect()
    }

    /// Knots from u = 0 over the cycle or its first quarter, uniform in [`passed`](Self::passed) within each piece.
    pub(super) fn mesh(&self) -> Mesh {
        let grid = &self.subject.grid;
        let end = if self.symmetric { 0.25 } else { 1.0 };
        let us: Vec<f64> = grid.nodes.iter().map(|node| node.u).collect();
        let passed = self.passed();
        let passed_until = |u: f64| interpolated(&us, &passed, u);
        let u = |node: usize| us.get(node).copied().unwrap_or(0.0);
        // If neither effort nor the first shape matters, perturbations may be discontinuous at the ends of arcs.
        let jumps = matches!(self.gain, Gain::Displacement | Gain::Turning);
        let (mut knots, mut count) = (Vec::new(), 0);
        let mut free_knot = || {
            count += 1;
            Some(count - 1)
        };
        // Ends are free where the cycle closes smoothly and on symmetry lines.
        let closes = self.smooth_after(grid.pieces.len().saturating_sub(1));
        let mut number = if closes { free_knot() } else { None };
        for (index, piece) in grid.pieces.iter().enumerate() {
            let (from, to) = (u(*piece.nodes.start()), u(*piece.nodes.end()));
            if from >= end - SAME {
                break;
            }
            let (free, ends) = (piece.along == Along::Free, to >= end - SAME);
            let goes_on = free && to > end + SAME || self.smooth_after(index);
            let (from, to) = (passed_until(from), passed_until(to.min(end)));
            let share = (to - from) / passed_until(end);
            #[allow(clippy::cast_possible_truncation, clippy::cast_sign_loss)] // some tens
            let parts = ((PARTS * share).round() as usize).max(FEWEST);
            for part in 0..=parts {
                if part == 0 && jumps && !(free && number.is_some()) {
                    number = if free { free_knot() } else { None };
                }
                if part > 0 {
                    let is_last = part == parts;
                    number = match is_last {
                        _ if !free => None,
                        true if !goes_on && !jumps => None,
                        true if ends && closes && !self.symmetric => Some(0),
                        _ => free_knot(),
                    };
                }
                let passed_here = from + (to - from) * part as f64 / parts as f64;
                let u = interpolated(&passed, &us, passed_here);
                knots.push(Knot { u, number });
            }
        }
        Mesh { knots, count }
    }

    /// Returns `true` if the curve is free and smooth at the end of a piece.
    fn smooth_after(&self, piece: usize) -> bool {
        let Subject { grid, path, .. } = self.subject;
        let (Some(this), Some(next)) = (
            grid.pieces.get(piece),
            grid.pieces.get((piece + 1) % grid.pieces.len().max(1)),
        ) else {
            return false;
        };
        let rate = |node: usize| path.places.get(node).map(|place| place.rate);
        let (Some(a), Some(b)) = (rate(*this.nodes.end()), rate(*next.nodes.start())) else {
            return false;
        };
        this.along == Along::Free
            && next.along == Along::Free
            && a.perp(&b).atan2(a.dot(&b)).abs() < SMOOTH
    }
}

/// Piecewise linear interpolation of an increasing function.
fn interpolated(places: &[f64], values: &[f64], at: f64) -> f64 {
    let after = places.partition_point(|&place| place < at);
    let after = after.clamp(1, places.len().saturating_sub(1).max(1));
    let (Some([from, to]), Some([low, high])) = (
        places.get(after - 1..).and_then(<[f64]>::first_chunk),
        values.get(after - 1..).and_then(<[f64]>::first_chunk),
    ) else {
        return at;
    };
    let share = (at - from) / (to - from);
    low + (high - low) * if share.is_finite() { share } else { 0.0 }
}
