//! One arc: a curve between two shapes, its net pose, and the derivatives of that pose by the arc's parameters.
//!
//! Every arc is a graph over one joint angle that runs at an even rate, so time is linear along it. Values and slopes are
//! those of one and the same quadrature: a Newton method on them converges to rounding.

use nalgebra::{DMatrix, DVector, Vector2, Vector3};
use swimmer_model::Model;

use super::quadrature::Rule;
use crate::batch::{Batch, Connection, First};
use crate::height_map::legendre::legendre;
use crate::region::{Clearance, Piece};

/// Most coefficients of a bent arc.
pub(crate) const MOST_BENDS: usize = 24;
/// Both ends, and the bends.
pub(crate) const MOST_PARAMETERS: usize = 4 + MOST_BENDS;

/// Curve that joins the ends.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    /// A straight line.
    Straight,
    /// A straight line, with `s(1 − s) Σ_k b_k P_k(2s − 1)` added to this joint's angle.
    Bent { joint: usize, bends: usize },
    /// The curve on which a piece of the clearance vanishes, as a graph over joint `pace`.
    Along {
        clearance: Clearance,
        piece: Piece,
        pace: usize,
    },
}

/// x, y, θ that an arc brings, in the frame at its start, and the mean of θ over its time; with the slopes along the four
/// coordinates of both ends and the bends.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Jet {
    pub(crate) value: [f64; 4],
    pub(crate) slopes: [[f64; 4]; MOST_PARAMETERS],
}

/// A place on an arc: shape, its rate over s, and how both change with each parameter.
pub(crate) struct ArcPoint<const P: usize> {
    pub(crate) phi: Vector2<f64>,
    pub(crate) rate: Vector2<f64>,
    pub(crate) d_phi: [Vector2<f64>; P],
    pub(crate) d_rate: [Vector2<f64>; P],
}

impl Shape {
    pub(crate) fn bends(&self) -> usize {
        match self {
            Self::Bent { bends, .. } => *bends,
            _ => 0,
        }
    }

    /// The place at s in \[0, 1\], with slopes along P parameters: all four coordinates of the ends at least.
    pub(crate) fn place<const P: usize>(
        &self,
        [from, to]: &[Vector2<f64>; 2],
        bends: &[f64],
        s: f64,
    ) -> ArcPoint<P> {
        let way = to - from;
        let mut place = ArcPoint {
            phi: from + way * s,
            rate: way,
            d_phi: [Vector2::zeros(); P],
            d_rate: [Vector2::zeros(); P],
        };
        for joint in 0..2 {
            place.d_phi[joint][joint] = 1.0 - s;
            place.d_phi[2 + joint][joint] = s;
            place.d_rate[joint][joint] = -1.0;
            place.d_rate[2 + joint][joint] = 1.0;
        }
        match *self {
            Self::Straight => {}
            Self::Bent {
                joint,
                bends: count,
            } => bend(&mut place, joint, (count, bends), s),
            Self::Along {
                clearance,
                piece,
                pace,
            } => along(&clearance, piece, pace, &mut place),
        }
        place
    }

    /// Contribution of the arc to pose and time, with first derivatives by its ends and bends.
    pub(crate) fn jet(
        &self,
        model: &Model<f64>,
        rule: &Rule,
        ends: &[Vector2<f64>; 2],
        bends: &[f64],
    ) -> Jet {
        // Most arcs have no bends, and most of the time is spent here.
        match self {
            Self::Bent { .. } => self.sized::<MOST_PARAMETERS>(model, rule, ends, bends),
            _ => self.sized::<4>(model, rule, ends, bends),
        }
    }

    /// Contribution of the arc to pose and time.
    pub(crate) fn value(
        &self,
        model: &Model<f64>,
        rule: &Rule,
        ends: &[Vector2<f64>; 2],
        bends: &[f64],
    ) -> [f64; 4] {
        let place = |&s: &f64| {
            if *self == Self::Straight {
                return (ends[0] + (ends[1] - ends[0]) * s, ends[1] - ends[0]);
            }
            let place = self.place::<MOST_PARAMETERS>(ends, bends, s);
            (place.phi, place.rate)
        };
        let places: Vec<(Vector2<f64>, Vector2<f64>)> = rule.nodes.iter().map(place).collect();
        let mut rates: Vec<Vector3<f64>> = Vec::with_capacity(places.len());
        let phi = places.iter().map(|(phi, _)| *phi);
        Batch::of(model).each(Connection, phi, |node, connection| {
            rates.push(connection * places[node].1);
        });
        let mut value = [0.0; 4];
        for (rate, (weight, up_to)) in rates.iter().zip(rule.weights.iter().zip(&rule.cumulative)) {
            let theta: f64 = up_to.iter().zip(&rates).map(|(w, rate)| w * rate.z).sum();
            let (sin, cos) = theta.sin_cos();
            let terms = [
                cos * rate.x - sin * rate.y,
                sin * rate.x + cos * rate.y,
                rate.z,
                theta,
            ];
            add(&mut value, *weight, terms);
        }
        value
    }

    fn sized<const P: usize>(
        &self,
        model: &Model<f64>,
        rule: &Rule,
        ends: &[Vector2<f64>; 2],
        bends: &[f64],
    ) -> Jet {
        let parameters = 4 + self.bends();
        let places = rule.nodes.iter().map(|&s| self.place::<P>(ends, bends, s));
        let places: Vec<ArcPoint<P>> = places.collect();
        let mut nodes: Vec<(Vector3<f64>, [Vector3<f64>; P])> = Vec::with_capacity(places.len());
        let phi = places.iter().map(|place| place.phi);
        Batch::of(model).each(First, phi, |node, first| {
            let place = &places[node];
            let [one, two] = first.d_connection.map(|d| d * place.rate);
            let mut slopes = [Vector3::zeros(); P];
            for (p, slope) in slopes.iter_mut().enumerate().take(parameters) {
                let d = place.d_phi[p];
                *slope = one * d.x + two * d.y + first.connection * place.d_rate[p];
            }
            nodes.push((first.connection * place.rate, slopes));
        });
        let mut jet = Jet {
            value: [0.0; 4],
            slopes: [[0.0; 4]; MOST_PARAMETERS],
        };
        for ((rate, slopes), (weight, up_to)) in
            nodes.iter().zip(rule.weights.iter().zip(&rule.cumulative))
        {
            let theta: f64 = up_to.iter().zip(&nodes).map(|(w, node)| w * node.0.z).sum();
            let (sin, cos) = theta.sin_cos();
            let turn = |v: &Vector3<f64>| [cos * v.x - sin * v.y, sin * v.x + cos * v.y];
            let step = turn(rate);
            add(&mut jet.value, *weight, [step[0], step[1], rate.z, theta]);
            for (p, slope) in slopes.iter().enumerate().take(parameters) {
                let d_theta: f64 = up_to
                    .iter()
                    .zip(&nodes)
                    .map(|(w, node)| w * node.1[p].z)
                    .sum();
                let d = turn(slope);
                let terms = [
                    d[0] - d_theta * step[1],
                    d[1] + d_theta * step[0],
                    slope.z,
                    d_theta,
                ];
                add(&mut jet.slopes[p], *weight, terms);
            }
        }
        jet
    }
}

/// Adds `count` bends to the angle of one joint.
fn bend<const P: usize>(
    place: &mut ArcPoint<P>,
    joint: usize,
    (count, bends): (usize, &[f64]),
    s: f64,
) {
    let x = 2.0 * s - 1.0;
    let p = legendre(count, x);
    let hump = s * (1.0 - s);
    let mut slope_before = 0.0;
    for (k, value) in p.iter().enumerate().take(count) {
        // P′_k = x P′_{k−1} + k P_{k−1}.
        let slope = if k == 0 {
            0.0
        } else {
            x * slope_before + k as f64 * p[k - 1]
        };
        slope_before = slope;
        let bend = bends.get(k).copied().unwrap_or(0.0);
        let (up, along) = (hump * value, -x * value + 2.0 * hump * slope);
        place.phi[joint] += bend * up;
        place.rate[joint] += bend * along;
        place.d_phi[4 + k][joint] = up;
        place.d_rate[4 + k][joint] = along;
    }
}

/// So many bends of a joint's angle, the nearest to what it is off the straight line at some places.
pub(crate) fn fitted(places: &[(f64, f64)], count: usize) -> Option<Vec<f64>> {
    let matrix = DMatrix::from_fn(places.len(), count, |i, k| {
        let s = places[i].0;
        s * (1.0 - s) * legendre(count, 2.0 * s - 1.0)[k]
    });
    let right = DVector::from_fn(places.len(), |i, _| places[i].1);
    let bends = matrix.svd(true, true).solve(&right, 1e-9).ok()?;
    Some(bends.iter().copied().collect())
}

fn add(sum: &mut [f64; 4], weight: f64, terms: [f64; 4]) {
    for (sum, term) in sum.iter_mut().zip(terms) {
        *sum += weight * term;
    }
}

/// Puts a place onto the curve of a piece of the clearance, above the same angle of the joint that sets the pace.
fn along<const P: usize>(
    clearance: &Clearance,
    piece: Piece,
    pace: usize,
    place: &mut ArcPoint<P>,
) {
    let other = 1 - pace;
    for _ in 0..30 {
        let level = clearance.level(piece, &place.phi);
        let step = level.value / level.gradient[other];
        place.phi[other] -= step.clamp(-0.2, 0.2);
        if step.abs() < 1e-16 || !step.is_finite() {
            break;
        }
    }
    let level = clearance.level(piece, &place.phi);
    let (g, h) = (level.gradient, level.hessian);
    let ratio = -g[pace] / g[other];
    let bent =
        -(h[(pace, pace)] + 2.0 * h[(0, 1)] * ratio + h[(other, other)] * ratio * ratio) / g[other];
    let rate = place.rate[pace];
    place.rate[other] = ratio * rate;
    for p in 0..4 {
        let (d_phi, d_rate) = (place.d_phi[p][pace], place.d_rate[p][pace]);
        place.d_phi[p][other] = ratio * d_phi;
        place.d_rate[p][other] = ratio * d_rate + bent * d_phi * rate;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    fn clearance() -> Shape {
        let links = swimmer_model::Links {
            middle: 0.2,
            front: 0.4,
            back: 0.4,
        };
        Shape::Along {
            clearance: Clearance::new(&links, 0.02).unwrap(),
            piece: Piece::Tip(0),
            pace: 0,
        }
    }

    #[test]
    fn the_slopes_are_those_of_the_value() {
        let model = Model::new(&Swimmer::<f64>::robot().of_unit_length()).unwrap();
        let rule = Rule::new(24);
        let bent = Shape::Bent { joint: 1, bends: 3 };
        for shape in [Shape::Straight, bent, clearance()] {
            let value = |z: &[f64; 8]| {
                let ends = [Vector2::new(z[0], z[1]), Vector2::new(z[2], z[3])];
                shape.jet(&model, &rule, &ends, &z[4..])
            };
            let z = [0.9, 2.3, 1.4, 1.9, 0.1, -0.05, 0.02, 0.07];
            let jet = value(&z);
            for p in 0..4 + shape.bends() {
                let (mut up, mut down) = (z, z);
                up[p] += 1e-5;
                down[p] -= 1e-5;
                let (up, down) = (value(&up).value, value(&down).value);
                for i in 0..4 {
                    let slope = (up[i] - down[i]) / 2e-5;
                    assert!((slope - jet.slopes[p][i]).abs() < 1e-8, "{shape:?} {p} {i}");
                }
            }
        }
    }
}
