//! Second derivatives of an arc's displacement, rotation and mean heading, contracted with their weights in the chain.
//!
//! If the angles of an arc are linear in its parameters, the result is exact: a sum of the model's second derivatives over the nodes,
//! weighted by the adjoint of the heading. On an arc along the clearance it is a central difference of the contracted gradient.

use nalgebra::{Vector2, Vector3};
use swimmer_model::{Model, SecondDerivatives};

use super::arc::{ArcPoint, MOST_PARAMETERS, Shape};
use super::quadrature::Rule;
use crate::batch::{Batch, Second};

/// Step of the central differences \[rad\].
const STEP: f64 = 2e-5;

impl Shape {
    /// Passes each pair of parameters `q ≤ p` to `then`, with the second derivative of
    /// `pull[0]·x + pull[1]·y + pull[2]·θ + pull[3]·θ̄`: displacement, rotation and mean heading over the arc.
    pub(super) fn curvature(
        &self,
        (model, rule): (&Model<f64>, &Rule),
        (ends, bends): (&[Vector2<f64>; 2], &[f64]),
        pull: &[f64; 4],
        then: impl FnMut(usize, usize, f64),
    ) {
        match self {
            Self::Straight => self.exact::<4>((model, rule), (ends, bends), pull, then),
            Self::Bent { .. } => {
                self.exact::<MOST_PARAMETERS>((model, rule), (ends, bends), pull, then);
            }
            Self::Along { .. } => self.differences((model, rule), ends, pull, then),
        }
    }

    fn exact<const P: usize>(
        &self,
        (model, rule): (&Model<f64>, &Rule),
        (ends, bends): (&[Vector2<f64>; 2], &[f64]),
        pull: &[f64; 4],
        mut then: impl FnMut(usize, usize, f64),
    ) {
        let count = 4 + self.bends();
        let places = rule.nodes.iter().map(|&s| self.place::<P>(ends, bends, s));
        let places: Vec<ArcPoint<P>> = places.collect();
        let mut nodes: Vec<Node<P>> = Vec::with_capacity(places.len());
        let phi = places.iter().map(|place| place.phi);
        Batch::of(model).each(Second, phi, |number, second| {
            nodes.push(Node::new(&places[number], &second, count));
        });
        let swept = rule.cumulative.iter().map(|up_to| {
            let mut theta = 0.0;
            let mut slopes = [0.0; P];
            for (weight, node) in up_to.iter().zip(&nodes) {
                theta += weight * node.rate.z;
                for (sum, slope) in slopes.iter_mut().zip(&node.slopes).take(count) {
                    *sum += weight * slope.z;
                }
            }
            (theta.sin_cos(), slopes)
        });
        let swept: Vec<((f64, f64), [f64; P])> = swept.collect();
        // Adjoint: weight of the heading at each node, and from it the weight of the rotation rate at each node.
        let along = Vector2::new(pull[0], pull[1]);
        let turned = |(sin, cos): (f64, f64), v: &Vector3<f64>| {
            Vector2::new(cos * v.x - sin * v.y, sin * v.x + cos * v.y)
        };
        let mut turning: Vec<f64> = rule.weights.iter().map(|weight| weight * pull[2]).collect();
        for (i, ((at, _), node)) in swept.iter().zip(&nodes).enumerate() {
            let heading = rule.weights[i] * (pull[3] - along.perp(&turned(*at, &node.rate)));
            for (sum, weight) in turning.iter_mut().zip(&rule.cumulative[i]) {
                *sum += heading * weight;
            }
        }
        let mut sums = [[0.0; P]; P];
        for (i, (((sin, cos), headings), node)) in swept.iter().zip(&nodes).enumerate() {
            let weight = rule.weights[i];
            let body =
                Vector2::new(cos * along.x + sin * along.y, cos * along.y - sin * along.x) * weight;
            let covector = Vector3::new(body.x, body.y, turning[i]);
            node.add_local(&places[i], &covector, count, &mut sums);
            let pulled = body.dot(&node.rate.xy());
            let mut across = [0.0; P];
            for (across, slope) in across.iter_mut().zip(&node.slopes).take(count) {
                *across = body.y * slope.x - body.x * slope.y;
            }
            for (p, row) in sums.iter_mut().enumerate().take(count) {
                let by = across[p] - pulled * headings[p];
                for (q, sum) in row.iter_mut().enumerate().take(p + 1) {
                    *sum += by * headings[q] + headings[p] * across[q];
                }
            }
        }
        for (p, row) in sums.iter().enumerate().take(count) {
            for (q, value) in row.iter().enumerate().take(p + 1) {
                then(p, q, *value);
            }
        }
    }

    fn differences(
        &self,
        (model, rule): (&Model<f64>, &Rule),
        ends: &[Vector2<f64>; 2],
        pull: &[f64; 4],
        mut then: impl FnMut(usize, usize, f64),
    ) {
        let slopes = |p: usize, by: f64| {
            let mut ends = *ends;
            ends[p / 2][p % 2] += by;
            let jet = self.jet(model, rule, &ends, &[]);
            let contracted = |q: usize| -> f64 {
                let slopes = jet.slopes[q].iter().zip(pull);
                slopes.map(|(slope, pull)| slope * pull).sum()
            };
            [0, 1, 2, 3].map(contracted)
        };
        let rows = [0, 1, 2, 3].map(|p| {
            let (up, down) = (slopes(p, STEP), slopes(p, -STEP));
            [0, 1, 2, 3].map(|q| (up[q] - down[q]) / (2.0 * STEP))
        });
        for (p, row) in rows.iter().enumerate() {
            for (q, value) in row.iter().enumerate().take(p + 1) {
                then(p, q, 0.5 * (value + rows[q][p]));
            }
        }
    }
}

/// Node of an arc: body velocity and its derivative with respect to each parameter.
struct Node<const P: usize> {
    rate: Vector3<f64>,
    slopes: [Vector3<f64>; P],
    second: SecondDerivatives<f64>,
}

impl<const P: usize> Node<P> {
    fn new(place: &ArcPoint<P>, second: &SecondDerivatives<f64>, count: usize) -> Self {
        let first = &second.first;
        let [one, two] = first.d_connection.map(|d| d * place.rate);
        let mut slopes = [Vector3::zeros(); P];
        for (p, slope) in slopes.iter_mut().enumerate().take(count) {
            let d = place.d_phi[p];
            *slope = one * d.x + two * d.y + first.connection * place.d_rate[p];
        }
        Self {
            rate: first.connection * place.rate,
            slopes,
            second: *second,
        }
    }

    /// Adds the second derivatives of the body velocity, contracted with a covector.
    fn add_local(
        &self,
        place: &ArcPoint<P>,
        covector: &Vector3<f64>,
        count: usize,
        sums: &mut [[f64; P]; P],
    ) {
        let [d11, d12, d22] = self
            .second
            .d2_connection
            .each_ref()
            .map(|d| d.tr_mul(covector).dot(&place.rate));
        let [d1, d2] = self
            .second
            .first
            .d_connection
            .each_ref()
            .map(|d| d.tr_mul(covector));
        for (p, row) in sums.iter_mut().enumerate().take(count) {
            let (phi, rate) = (&place.d_phi[p], &place.d_rate[p]);
            let by_phi = Vector2::new(
                d11 * phi.x + d12 * phi.y + d1.dot(rate),
                d12 * phi.x + d22 * phi.y + d2.dot(rate),
            );
            let by_rate = d1 * phi.x + d2 * phi.y;
            for (q, sum) in row.iter_mut().enumerate().take(p + 1) {
                *sum += place.d_phi[q].dot(&by_phi) + place.d_rate[q].dot(&by_rate);
            }
        }
    }
}
