//! The second-order condition of a fastest gait within limits, from its curve and its multipliers alone: is a neighbour faster?
//!
//! The curve is pushed by polygons, with a corner where each part of the cycle begins: across the curve, any way at its own
//! corners, along straight bounds. Of ln |d| + c Δθ/|d| − ln T with T = ∮ Σ αⱼ Gⱼ the second variation is exact. To first order
//! a push must turn nothing and keep the limits that bind as long as each other: the first is taken out, the second (Finsler's lemma)
//! weighed by what of G each push spreads, Σ αⱼ δGⱼ² − (Σ αⱼ δGⱼ)².

use nalgebra::{DMatrix, DVector, Matrix2, Matrix3x2, Matrix4, Vector2, Vector3, Vector4};

use swimmer_model::Gait as _;

use super::costate::{Costate, Multipliers, Node};
use crate::region::Bound;

/// What a spread of the limits weighs: enough where limits hardly bind, and what is left of a spread along a polygon is none the less
/// little. Ten times less or more changes an optimum's least by a fifth at most.
const SPREAD: f64 = 1e3;
/// A direction that turns by less is no corner \[rad\], and pushes along the curve do nothing.
const CORNER: f64 = 0.1;
/// Directions are looked at so close to the end of a part, as a share of the period.
const BESIDE: f64 = 1e-9;

/// A push of the end of a part.
struct Push {
    end: usize,
    way: Vector2<f64>,
}

/// How a push moves a node: its shape and its velocity.
type Moves = Vec<(usize, Vector4<f64>)>;

/// Sums over the nodes, for each push or pair of pushes.
struct Sums {
    /// Of ln |d| + c Δθ/|d| − ln T.
    hessian: DMatrix<f64>,
    spread: DMatrix<f64>,
    /// Mean product of the pushes.
    mass: DMatrix<f64>,
    rotation: DVector<f64>,
    time: DVector<f64>,
    displacement: DMatrix<f64>,
}

const QUARTER_TURN: Matrix2<f64> = Matrix2::new(0.0, -1.0, 1.0, 0.0);

impl Costate<'_> {
    /// The least second variation of ln T − ln |d| over pushes of mean square 1 rad²; none where none is left that turns nothing.
    pub(super) fn least_second_variation(
        &self,
        parts: &[(f64, f64)],
        multipliers: &Multipliers,
    ) -> Option<f64> {
        let pushes = self.pushes(parts);
        if pushes.len() < 2 {
            return None;
        }
        let sums = self.sums(parts, &pushes, multipliers);
        let distance = self.distance();
        let along = sums.displacement.tr_mul(&self.p.normalize()) / distance;
        let across = sums
            .displacement
            .tr_mul(&(QUARTER_TURN * self.p.normalize()))
            / distance;
        let slower = &sums.time / self.period;
        let falls = &along * along.transpose()
            - &across * across.transpose()
            - &slower * slower.transpose()
            - sums.hessian
            + sums.spread * SPREAD;
        Some(least_eigenvalue(&falls, &sums.mass, &sums.rotation).unwrap_or(f64::NAN))
    }

    fn distance(&self) -> f64 {
        self.period / self.slowness
    }

    fn pushes(&self, parts: &[(f64, f64)]) -> Vec<Push> {
        let mut pushes = Vec::new();
        for (end, &(from, _)) in parts.iter().enumerate() {
            let beside = [-BESIDE, BESIDE].map(|by| self.gait.at((from + by).rem_euclid(1.0)).rate);
            let corner = beside[0].angle(&beside[1]) > CORNER;
            let across = (QUARTER_TURN * beside[1]).normalize();
            let rests: Vec<_> = self.rests(&self.gait.at(from).phi).collect();
            let ways: Vec<Vector2<f64>> = match (rests.as_slice(), corner) {
                ([], true) => vec![
                    Vector2::x_axis().into_inner(),
                    Vector2::y_axis().into_inner(),
                ],
                ([], false) => vec![across],
                ([(Bound::Straight(_), gradient)], true) => {
                    vec![(QUARTER_TURN * gradient).normalize()]
                }
                _ => Vec::new(),
            };
            pushes.extend(ways.into_iter().map(|way| Push { end, way }));
        }
        pushes
    }

    fn sums(&self, parts: &[(f64, f64)], pushes: &[Push], multipliers: &Multipliers) -> Sums {
        let size = pushes.len();
        let square = || DMatrix::zeros(size, size);
        let mut sums = Sums {
            hessian: square(),
            spread: square(),
            mass: square(),
            rotation: DVector::zeros(size),
            time: DVector::zeros(size),
            displacement: DMatrix::zeros(2, size),
        };
        for (number, ((from, to), nodes)) in parts.iter().zip(&multipliers.nodes).enumerate() {
            let time = (to - from) * self.period;
            let next = (number + 1) % parts.len();
            let moves: Vec<Moves> = self
                .rule
                .nodes
                .iter()
                .map(|s| {
                    let of = |(at, push): (usize, &Push)| {
                        let rising = (push.end == next).then_some((*s, 1.0));
                        let falling = (push.end == number).then_some((1.0 - s, -1.0));
                        let (height, slope) = rising.or(falling)?;
                        let (by, faster) = (push.way * height, push.way * (slope / time));
                        Some((at, Vector4::new(by.x, by.y, faster.x, faster.y)))
                    };
                    pushes.iter().enumerate().filter_map(of).collect()
                })
                .collect();
            let mut bodies = Vec::with_capacity(nodes.len());
            for (node, moves) in nodes.iter().zip(&moves) {
                let mut body = DMatrix::<f64>::zeros(3, size);
                for (at, by) in moves {
                    body.set_column(*at, &node.body_change(by));
                }
                bodies.push(body);
            }
            let turning: Vec<_> = bodies.iter().map(|body| body.row(2).transpose()).collect();
            let turned = |weights: &[f64]| {
                let sum = turning.iter().zip(weights);
                sum.fold(sums.rotation.clone(), |sum, (turning, weight)| {
                    sum + turning * (weight * time)
                })
            };
            let headings: Vec<_> = self.rule.cumulative.iter().map(|row| turned(row)).collect();
            let whole = turned(&self.rule.weights);
            for (q, node) in nodes.iter().enumerate() {
                let weight = self.rule.weights[q] * time;
                let shares = &multipliers.shares[number][q];
                self.local(
                    node,
                    &moves[q],
                    (shares, multipliers.rotation, weight),
                    &mut sums,
                );
                self.carried(node, (&bodies[q], &headings[q]), weight, &mut sums);
            }
            sums.rotation = whole;
        }
        sums
    }

    /// Adds what pushes bring where they are: of the body's velocity, and of the limits.
    fn local(
        &self,
        node: &Node,
        moves: &Moves,
        (shares, rotation, weight): (&[f64], f64, f64),
        sums: &mut Sums,
    ) {
        // Of what follows a turn of the body, its displacement along d.
        let [x, y, theta] = node.pose;
        let p = self.p.normalize();
        let after = p * self.distance() - Vector2::new(x, y);
        let (sin, cos) = theta.sin_cos();
        let mu = Vector3::new(
            cos * p.x + sin * p.y,
            cos * p.y - sin * p.x,
            p.dot(&(QUARTER_TURN * after)) + rotation,
        );
        let mut bent = node.body_curvature(&mu) / self.distance();
        let (mut mean, mut spread) = (Vector4::zeros(), Matrix4::zeros());
        for (level, share) in node.levels.iter().zip(shares) {
            bent -= level.curved * (share / self.period);
            mean += level.slope * *share;
            spread += level.slope * level.slope.transpose() * *share;
        }
        spread -= mean * mean.transpose();
        for (a, one) in moves {
            sums.time[*a] += weight * mean.dot(one);
            for (b, other) in moves {
                let at = (*a, *b);
                sums.hessian[at] += weight * one.dot(&(bent * other));
                sums.spread[at] += weight / self.period * one.dot(&(spread * other));
                sums.mass[at] += weight / self.period * one.xy().dot(&other.xy());
            }
        }
    }

    /// Adds what a place's velocity brings where earlier pushes have turned the body.
    fn carried(
        &self,
        node: &Node,
        (body, heading): (&DMatrix<f64>, &DVector<f64>),
        weight: f64,
        sums: &mut Sums,
    ) {
        let (sin, cos) = node.pose[2].sin_cos();
        let frame = Matrix2::new(cos, -sin, sin, cos);
        let velocity = frame * (node.second.first.connection * node.rate).xy();
        let change = frame * body.fixed_rows::<2>(0);
        sums.displacement += (&change + QUARTER_TURN * velocity * heading.transpose()) * weight;
        let p = self.p.normalize() * (weight / self.distance());
        let across = change.tr_mul(&(QUARTER_TURN.transpose() * p));
        let turned = heading * (across - heading * (0.5 * p.dot(&velocity))).transpose();
        sums.hessian += &turned;
        sums.hessian += turned.transpose();
    }
}

impl Node {
    /// How the body's velocity changes.
    fn body_change(&self, by: &Vector4<f64>) -> Vector3<f64> {
        let first = &self.second.first;
        let [d1, d2] = &first.d_connection;
        (d1 * by[0] + d2 * by[1]) * self.rate + first.connection * Vector2::new(by[2], by[3])
    }

    /// Its second derivatives by shape and velocity, along a covector.
    fn body_curvature(&self, mu: &Vector3<f64>) -> Matrix4<f64> {
        let along = |matrix: &Matrix3x2<f64>| matrix.tr_mul(mu);
        let [d11, d12, d22] = self.second.d2_connection.each_ref().map(along);
        let [d1, d2] = self.second.first.d_connection.each_ref().map(along);
        let [a, b, d] = [d11, d12, d22].map(|by| by.dot(&self.rate));
        Matrix4::new(
            a, b, d1.x, d1.y, //
            b, d, d2.x, d2.y, //
            d1.x, d2.x, 0.0, 0.0, //
            d1.y, d2.y, 0.0, 0.0,
        )
    }
}

/// The least of a form over another, on what is square to a direction.
fn least_eigenvalue(
    form: &DMatrix<f64>,
    mass: &DMatrix<f64>,
    direction: &DVector<f64>,
) -> Option<f64> {
    let factor = mass.clone().cholesky()?.unpack();
    let half = factor.solve_lower_triangular(form)?;
    let scaled = factor.solve_lower_triangular(&half.transpose())?;
    let unit = factor.solve_lower_triangular(direction)?.normalize();
    if !scaled.iter().chain(&unit).all(|value| value.is_finite()) {
        return None;
    }
    let across = DMatrix::identity(unit.len(), unit.len()) - &unit * unit.transpose();
    // The direction itself is put out of the way.
    let beyond = &unit * unit.transpose() * scaled.norm();
    Some(
        (&across * scaled * &across + beyond)
            .symmetric_eigenvalues()
            .min(),
    )
}
