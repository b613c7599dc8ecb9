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

/// Joint and sign of the four rates of a side.
const RATES: [(usize, f64); 4] = [(0, 1.0), (0, -1.0), (1, 1.0), (1, -1.0)];

/// Margins of the four rates of a side.
fn rate_margins(setting: &Setting, layout: &Layout, z: &DVector<f64>, side: usize) -> [f64; 4] {
    let (from, to) = (layout.corner_index(side), layout.corner_index(side + 1));
    let time = z[layout.time_index(side)];
    RATES
        .map(|(joint, sign)| setting.rates[joint] * time - sign * (z[to + joint] - z[from + joint]))
}

/// Values of all inequalities, in the order of [`inequalities`], without derivatives.
pub(super) fn margins(
    setting: &Setting,
    layout: &Layout,
    z: &DVector<f64>,
) -> impl Iterator<Item = f64> {
    let rates = (0..layout.arcs()).flat_map(move |side| rate_margins(setting, layout, z, side));
    let bounds = (0..layout.arcs()).flat_map(move |corner| {
        let phi = layout.corner(z, corner);
        let bounds = setting.region.bounds();
        bounds.map(move |bound| bound.margin(&phi))
    });
    rates.chain(bounds)
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
        let margins = rate_margins(setting, layout, z, side);
        for ((joint, sign), margin) in RATES.into_iter().zip(margins) {
            let limit = setting.rates[joint];
            let slope = [(time, limit), (to + joint, -sign), (from + joint, sign)];
            all.push(Inequality::new(margin, &slope, None));
        }
    }
    for corner in 0..layout.arcs() {
        let phi = layout.corner(z, corner);
        let at = layout.corner_index(corner);
        for bound in setting.region.bounds() {
            let level = bound.level(&phi);
            let curved = matches!(bound, Bound::Clearance(_)).then_some(level.hessian);
            let slope = [(at, level.gradient.x), (at + 1, level.gradient.y)];
            all.push(Inequality::new(bound.margin(&phi), &slope, curved));
        }
    }
    all
}
