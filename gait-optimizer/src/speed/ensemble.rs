//! Many swimmers with one gait: Σ wₖ |dₖ|, each swum with its own poses.

use nalgebra::{DMatrix, DVector};

use super::chain::{self, Layout, Weights};
use super::quadrature::Rule;
use crate::member::Member;

/// A chain as the servos of a member turn it: all but the times is angles.
pub(super) fn turned(layout: &Layout, z: &DVector<f64>, gain: f64) -> DVector<f64> {
    let mut turned = z * gain;
    for arc in 0..layout.arcs() {
        turned[layout.time_index(arc)] = z[layout.time_index(arc)];
    }
    turned
}

/// Gradient and second derivatives of −ln Σ wₖ |dₖ|; of no members nothing.
pub(super) fn expansion(
    (layout, rule): (&Layout, &Rule),
    z: &DVector<f64>,
    members: &[(Member, f64)],
) -> (DVector<f64>, DMatrix<f64>) {
    let weights = Weights {
        log_distance: 1.0,
        ..Weights::default()
    };
    let size = layout.size;
    let (mut sum, mut slope) = (0.0, DVector::zeros(size));
    let mut bend = DMatrix::zeros(size, size);
    if members.is_empty() {
        return (slope, bend);
    }
    for (Member { model, gain, .. }, weight) in members {
        let turned = turned(layout, z, *gain);
        let jets = layout.jets(model, rule, &turned);
        let (net, gradient) = chain::gradient(layout, &jets, &turned, weights);
        let of = (layout, model, rule);
        // |d|, its slope and its bend from those of ln |d|; times matter to none of them.
        let share = weight * net.distance();
        let hessian = chain::hessian(of, &jets, &turned, weights);
        bend += hessian * (share * gain.powi(2));
        bend.ger(share * gain.powi(2), &gradient, &gradient, 1.0);
        slope += gradient * (share * gain);
        sum += share;
    }
    slope /= sum;
    bend /= -sum;
    bend.ger(1.0, &slope, &slope, 1.0);
    (-slope, bend)
}
