//! The limits of a polygon: no servo faster than it can, no corner beyond the bounds, all linear; and any others of its sides.

use nalgebra::{DMatrix, DVector, Matrix4, Vector4};

/// A limit, `value ≥ 0`, with the entries of its slope.
pub(super) struct Slack {
    pub(super) value: f64,
    slopes: Vec<(usize, f64)>,
    /// Second derivatives by the ends of its side.
    curved: Option<Matrix4<f64>>,
}

impl Slack {
    /// How it changes along a step.
    pub(super) fn along(&self, step: &DVector<f64>) -> f64 {
        self.slopes
            .iter()
            .map(|(at, slope)| slope * step[*at])
            .sum()
    }

    pub(super) fn add(&self, sum: &mut DVector<f64>, weight: f64) {
        for &(at, slope) in &self.slopes {
            sum[at] += weight * slope;
        }
    }

    pub(super) fn stiffen(&self, matrix: &mut DMatrix<f64>, weight: f64) {
        for &(i, a) in &self.slopes {
            for &(j, b) in &self.slopes {
                matrix[(i, j)] += weight * a * b;
            }
        }
    }

    /// Adds what its curvature makes of its multiplier.
    pub(super) fn bend(&self, matrix: &mut DMatrix<f64>, push: f64) {
        let Some(curved) = self.curved else { return };
        for (i, &(row, _)) in self.slopes.iter().take(4).enumerate() {
            for (j, &(column, _)) in self.slopes.iter().take(4).enumerate() {
                matrix[(row, column)] -= push * curved[(i, j)];
            }
        }
    }

    /// `time − G` for a function of the ends of a side, which these are the coordinates of; by differences.
    pub(super) fn of_side(
        (time, at_time): (f64, usize),
        (ends, at): (Vector4<f64>, [usize; 4]),
        gauge: impl Fn(&Vector4<f64>) -> f64,
    ) -> Self {
        const STEP: f64 = 1e-4;
        let unit = |i: usize| Vector4::ith(i, STEP);
        let here = gauge(&ends);
        let both = std::array::from_fn::<_, 4, _>(|i| {
            [gauge(&(ends + unit(i))), gauge(&(ends - unit(i)))]
        });
        let mut slopes: Vec<(usize, f64)> = (0..4)
            .map(|i| (at[i], -(both[i][0] - both[i][1]) / (2.0 * STEP)))
            .collect();
        slopes.push((at_time, 1.0));
        let curved = Matrix4::from_fn(|i, j| {
            let [up, down] = [1.0, -1.0].map(|sign| gauge(&(ends + (unit(i) + unit(j)) * sign)));
            let apart: f64 = both[i].iter().chain(&both[j]).sum();
            -(up + down + 2.0 * here - apart) / (2.0 * STEP * STEP)
        });
        Self {
            value: time - here,
            slopes,
            curved: Some(curved),
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
                    slopes: vec![(time, rate), (to, -sign), (from, sign)],
                    curved: None,
                });
                if max_angle.is_finite() {
                    all.push(Slack {
                        value: max_angle - sign * z[from],
                        slopes: vec![(from, -sign)],
                        curved: None,
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
