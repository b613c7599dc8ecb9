//! The limits of a polygon: rates of its sides, bounds of its corners.

use nalgebra::{DVector, Matrix2};

use super::super::chain::Layout;
use super::super::problem::Setting;
use crate::region::Bound;

/// One inequality, `value ≥ 0`, with the entries of its slope.
pub(super) struct Inequality {
    pub(super) value: f64,
    pub(super) slope: [(usize, f64); 3],
    /// Second derivatives in the corner's two coordinates, for curved bounds.
    pub(super) curved: Option<Matrix2<f64>>,
}

/// All limits of a polygon: four of each side's rates, then those of each corner.
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
                all.push(Inequality {
                    value: limit * z[time] - sign * way,
                    slope: [(time, limit), (to + joint, -sign), (from + joint, sign)],
                    curved: None,
                });
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
            all.push(Inequality {
                value: bound.margin(&phi),
                slope: [(at, gradient.x), (at + 1, gradient.y), (at, 0.0)],
                curved,
            });
        }
    }
    all
}
