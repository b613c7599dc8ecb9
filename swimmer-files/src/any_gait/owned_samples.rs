//! Samples that live on the heap, with the slopes at their knots worked out once.

use nalgebra::Vector2;
use swimmer_model::{Gait, GaitPoint, InvalidSamples, Sampled};

/// The curve of [`Sampled`], owning its knots. The slopes come from `Sampled` itself, so the interpolation is the same.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct OwnedSamples {
    /// Knots before u = 1, the first at 0.
    u: Vec<f64>,
    intervals: Vec<Interval>,
}

/// The cubic between a knot and the next.
#[derive(Debug, Clone, Copy, PartialEq)]
struct Interval {
    end_u: f64,
    start: Vector2<f64>,
    end: Vector2<f64>,
    start_slope: Vector2<f64>,
    end_slope: Vector2<f64>,
    corner_at_end: bool,
}

impl OwnedSamples {
    pub(super) fn new(
        u: &[f64],
        phi: &[Vector2<f64>],
        corners: &[usize],
    ) -> Result<Self, InvalidSamples> {
        // A repeated last knot that differs from the first in its last digits (a file's closure) is left out.
        let knots = if u.len() == phi.len() && u.last() == Some(&1.0) {
            u.len() - 1
        } else {
            u.len()
        };
        let (u, phi) = (u.get(..knots).unwrap_or(u), phi.get(..knots).unwrap_or(phi));
        let sampled = Sampled::new(u, phi, corners)?;
        let ends = u.iter().skip(1).copied().chain([1.0]);
        let next = phi.iter().cycle().skip(1);
        let slopes: Vec<_> = (0..u.len()).map(|knot| sampled.slopes(knot)).collect();
        let next_slopes = slopes.iter().cycle().skip(1);
        let intervals = ends
            .zip(phi.iter().zip(next))
            .zip(slopes.iter().zip(next_slopes))
            .enumerate()
            .map(
                |(index, ((end_u, (&start, &end)), ([_, after], [before, _])))| Interval {
                    end_u,
                    start,
                    end,
                    start_slope: *after,
                    end_slope: *before,
                    corner_at_end: sampled.corner_at_end(index),
                },
            )
            .collect();
        Ok(Self {
            u: u.to_vec(),
            intervals,
        })
    }
}

impl Gait<f64> for OwnedSamples {
    fn at(&self, u: f64) -> GaitPoint<f64> {
        let rest = u - u.floor();
        let u = if rest < 1.0 { rest } else { 0.0 };
        let index = self.u.partition_point(|&knot| knot <= u).saturating_sub(1);
        let (Some(&start_u), Some(interval)) = (self.u.get(index), self.intervals.get(index))
        else {
            // NaN only: `new` refuses empty samples.
            return GaitPoint {
                phi: Vector2::repeat(u),
                rate: Vector2::repeat(u),
            };
        };
        interval.at(start_u, u)
    }

    fn pieces(&self) -> usize {
        self.intervals.len()
    }

    fn piece_end(&self, i: usize) -> f64 {
        self.intervals.get(i).map_or(1.0, |interval| interval.end_u)
    }

    fn corner_at_end(&self, i: usize) -> bool {
        self.intervals
            .get(i)
            .is_some_and(|interval| interval.corner_at_end)
    }
}

impl Interval {
    /// Cubic Hermite: start, chord, and how far both slopes stand off the chord.
    fn at(&self, start_u: f64, u: f64) -> GaitPoint<f64> {
        let h = self.end_u - start_u;
        let s = (u - start_u) / h;
        let rest = 1.0 - s;
        let chord = (self.end - self.start) / h;
        let (off0, off1) = (self.start_slope - chord, self.end_slope - chord);
        GaitPoint {
            phi: self.start + (chord * s + (off0 * rest - off1 * s) * (s * rest)) * h,
            rate: chord + off0 * (rest * (1.0 - 3.0 * s)) + off1 * (s * (3.0 * s - 2.0)),
        }
    }
}
