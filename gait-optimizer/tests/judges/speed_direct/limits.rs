//! The limits of a polygon: no servo faster than it can, no corner beyond the bounds. All are linear.

use nalgebra::{DMatrix, DVector};

/// A limit, `value ≥ 0`, with the entries of its slope.
pub(super) struct Slack {
    pub(super) value: f64,
    slopes: [(usize, f64); 3],
}

impl Slack {
    /// Its change along a step.
    pub(super) fn along(&self, step: &DVector<f64>) -> f64 {
        self.slopes
            .iter()
            .map(|(at, slope)| slope * step[*at])
            .sum()
    }

    pub(super) fn add(&self, sum: &mut DVector<f64>, weight: f64) {
        for (at, slope) in self.slopes {
            sum[at] += weight * slope;
        }
    }

    pub(super) fn stiffen(&self, matrix: &mut DMatrix<f64>, weight: f64) {
        for (i, a) in self.slopes {
            for (j, b) in self.slopes {
                matrix[(i, j)] += weight * a * b;
            }
        }
    }
}

pub(super) fn slacks(
    z: &DVector<f64>,
    sides: usize,
    rates: [f64; 2],
    max_angle: f64,
) -> Vec<Slack> {
    let mut all = Vec::new();
    for k in 0..sides {
        for (joint, rate) in rates.into_iter().enumerate() {
            let (from, to) = (2 * k + joint, 2 * ((k + 1) % sides) + joint);
            let time = 2 * sides + k;
            for sign in [1.0, -1.0] {
                all.push(Slack {
                    value: rate * z[time] - sign * (z[to] - z[from]),
                    slopes: [(time, rate), (to, -sign), (from, sign)],
                });
                if max_angle.is_finite() {
                    all.push(Slack {
                        value: max_angle - sign * z[from],
                        slopes: [(from, -sign), (from, 0.0), (from, 0.0)],
                    });
                }
            }
        }
    }
    all
}

/// The share of a step, at most 1, that keeps all values above a hundredth of what they are.
pub(super) fn longest(values: impl Iterator<Item = (f64, f64)>) -> f64 {
    values.fold(1.0, |share: f64, (value, along)| {
        if along < 0.0 {
            share.min(-0.99 * value / along)
        } else {
            share
        }
    })
}
