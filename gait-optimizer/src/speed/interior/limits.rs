//! The limits of a polygon: rates of its sides and what else limits their servos, bounds of its corners.

use nalgebra::{DVector, Matrix4, Vector4};

use super::super::chain::Layout;
use super::super::setting::{ALONG, Setting};
use crate::region::Bound;

/// One inequality, `value ≥ 0`, with the entries of its slope.
pub(super) struct Inequality {
    pub(super) value: f64,
    entries: [(usize, f64); 5],
    count: usize,
    /// Second derivatives in the coordinates of its first entries, where it is not linear.
    pub(super) curved: Option<Matrix4<f64>>,
}

impl Inequality {
    fn new(value: f64, slope: &[(usize, f64)], curved: Option<Matrix4<f64>>) -> Self {
        let mut entries = [(0, 0.0); 5];
        entries[..slope.len()].copy_from_slice(slope);
        Self {
            value,
            entries,
            count: slope.len(),
            curved,
        }
    }

    pub(super) fn slope(&self) -> &[(usize, f64)] {
        &self.entries[..self.count]
    }
}

/// All limits of a polygon: of each side four of its rates, then what else limits it, in the order of [`Setting::limits`], and
/// that it takes no longer than `longest`, if anything does; then those of each corner.
pub(super) fn inequalities(
    setting: &Setting,
    (layout, longest): (&Layout, f64),
    z: &DVector<f64>,
) -> Vec<Inequality> {
    let mut all = Vec::with_capacity(10 * layout.arcs());
    for side in 0..layout.arcs() {
        let (from, to) = (layout.corner_index(side), layout.corner_index(side + 1));
        let time = layout.time_index(side);
        for joint in 0..2 {
            let limit = setting.rates[joint];
            let way = z[to + joint] - z[from + joint];
            for sign in [1.0, -1.0] {
                let slope = [(time, limit), (to + joint, -sign), (from + joint, sign)];
                all.push(Inequality::new(limit * z[time] - sign * way, &slope, None));
            }
        }
        if setting.beyond.is_empty() {
            continue;
        }
        let [a, b] = layout.ends(z, side);
        let places = ALONG.map(|s| (s, setting.model.second_derivatives(&(a + (b - a) * s))));
        for limit in &setting.beyond {
            let mut value = z[time];
            let (mut slope, mut curved) = (Vector4::zeros(), Matrix4::zeros());
            for (s, place) in &places {
                let level = limit.level(place, &(b - a));
                // Shape and way by both ends.
                let ends = Matrix4::from_fn(|i, j| match (i % 2 == j % 2, i < 2, j < 2) {
                    (false, ..) => 0.0,
                    (true, true, true) => 1.0 - s,
                    (true, true, false) => *s,
                    (true, false, true) => -1.0,
                    (true, false, false) => 1.0,
                });
                let weight = 1.0 / ALONG.len() as f64;
                value -= level.value * weight;
                slope -= ends.transpose() * level.slope * weight;
                curved -= ends.transpose() * level.curved * ends * weight;
            }
            let slope = [
                (from, slope[0]),
                (from + 1, slope[1]),
                (to, slope[2]),
                (to + 1, slope[3]),
                (time, 1.0),
            ];
            all.push(Inequality::new(value, &slope, Some(curved)));
        }
        if longest.is_finite() {
            all.push(Inequality::new(longest - z[time], &[(time, -1.0)], None));
        }
    }
    for corner in 0..layout.arcs() {
        let phi = layout.corner(z, corner);
        let at = layout.corner_index(corner);
        for bound in setting.region.bounds() {
            let gradient = bound.gradient(&phi);
            let curved = match bound {
                Bound::Clearance(clearance) => {
                    let mut curved = Matrix4::zeros();
                    let hessian = clearance.deciding_level(&phi).hessian;
                    curved.fixed_view_mut::<2, 2>(0, 0).copy_from(&hessian);
                    Some(curved)
                }
                Bound::Straight(_) => None,
            };
            let slope = [(at, gradient.x), (at + 1, gradient.y)];
            all.push(Inequality::new(bound.margin(&phi), &slope, curved));
        }
    }
    all
}
