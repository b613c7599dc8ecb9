//! Inequalities of a polygon: rates of its sides, bounds of its corners.

use nalgebra::{DVector, Matrix2};

use super::super::chain::Layout;
use super::super::setting::Setting;
use crate::region::Bound;

/// One inequality, `value ≥ 0`, with the entries of its slope.
pub(super) struct Inequality {
    pub(super) value: f64,
    entries: [(usize, f64); 3],
    count: usize,
    /// Second derivatives in the coordinates of its first entries; `None` for a linear limit.
    pub(super) curved: Option<Matrix2<f64>>,
}

impl Inequality {
    fn new(value: f64, slope: &[(usize, f64)], curved: Option<Matrix2<f64>>) -> Self {
        let mut entries = [(0, 0.0); 3];
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

/// All inequalities of a polygon: four rates of each side, then the bounds of each corner.
pub(super) fn inequalities(
    setting: &Setting,
    layout: &Layout,
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
    }
    for corner in 0..layout.arcs() {
        let phi = layout.corner(z, corner);
        let at = layout.corner_index(corner);
        for bound in setting.region.bounds() {
            let gradient = bound.gradient(&phi);
            let curved = match bound {
                Bound::Clearance(clearance) => Some(clearance.deciding_level(&phi).hessian),
                Bound::Straight(_) => None,
            };
            let slope = [(at, gradient.x), (at + 1, gradient.y)];
            all.push(Inequality::new(bound.margin(&phi), &slope, curved));
        }
    }
    all
}
