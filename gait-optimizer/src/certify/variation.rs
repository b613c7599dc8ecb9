//! Second variation of a gain under perturbations of the curve.
//!
//! The first variation of p · d + c Δθ is h · dA, the height times the swept area. The second variation therefore follows from the
//! change of the height: locally by its slope, and further along the curve by the pose, which the area swept before rotates by
//! ∫ a dA and shifts across p by −∫ C dA:
//!
//! ```text
//! δ² = ∫ δh dA + ∫∫_{σ<s} (a(σ) C(s) − C(σ) a(s)) dA(σ) dA(s),   a = F_θ,   C = μ_y F_x − μ_x F_y + (p · r) a
//! ```
//!
//! in a frame attached to the first shape. The second variation of |d| has the additional term (p × δd)²/(|p| |d|), from the rotation
//! of d, with p × δd = −∫ C dA if there is no net rotation. Efficiency has the additional term −∫√P, to second order in the shapes
//! and their slopes.

use nalgebra::{DMatrix, DVector, Matrix2, Vector2};
use swimmer_model::SecondDerivatives;

use crate::momentum::{Height, Momentum};

/// Maximised quantity, which determines the Hessian.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Gain {
    /// |d|, without net rotation.
    Displacement,
    /// ln |d| − ln S, without net rotation.
    Efficiency,
    /// |Y|, across the heading at the start, without net rotation.
    Sideways,
    /// ± Δθ.
    Turning,
}

impl Gain {
    /// Returns `true` if the gain includes effort.
    pub(super) fn is_priced(self) -> bool {
        self == Self::Efficiency
    }
}

/// Effect of a unit perturbation of one knot on an element: on the shape and on its slope.
#[derive(Debug, Clone, Copy)]
pub(super) struct Push {
    pub(super) knot: usize,
    pub(super) by: Vector2<f64>,
    pub(super) slope: Vector2<f64>,
}

/// Short interval of the curve, evaluated at one point.
#[derive(Debug, Clone)]
pub(super) struct Element {
    pub(super) second: SecondDerivatives<f64>,
    /// Derivative of Φ by the parameter of the curve, which is ∫√P if the gain includes effort.
    pub(super) rate: Vector2<f64>,
    /// x, y over L and θ.
    pub(super) pose: [f64; 3],
    /// Length in that parameter.
    pub(super) length: f64,
    pub(super) pushes: Vec<Push>,
}

/// Quadratic form on the perturbations of the knots.
pub(super) struct Form {
    /// Half of the Hessian of the gain.
    pub(super) half: DMatrix<f64>,
    /// First variation of Δθ.
    pub(super) turned: DVector<f64>,
    /// First variation of Δθ with the absolute value of every element's contribution.
    pub(super) reach: DVector<f64>,
    /// −∫ C dA.
    aside: DVector<f64>,
}

impl Form {
    /// Assembles the form from consecutive elements, starting at the origin.
    pub(super) fn new(elements: &[Element], knots: usize, gain: Gain, momentum: &Momentum) -> Self {
        let nothing = DVector::zeros(knots);
        let mut form = Self {
            half: DMatrix::zeros(knots, knots),
            turned: nothing.clone(),
            reach: nothing.clone(),
            aside: nothing,
        };
        for element in elements {
            form.add(element, gain, momentum);
        }
        form.half = 0.5 * (&form.half + form.half.transpose());
        form
    }

    fn add(&mut self, element: &Element, gain: Gain, momentum: &Momentum) {
        let Element {
            second,
            rate,
            pose,
            length,
            pushes,
        } = element;
        let (mu, curvature) = (momentum.at(pose), second.first.curvature());
        let a = curvature.z;
        let along = momentum.p.dot(&Vector2::new(pose[0], pose[1]));
        let c = mu.y * curvature.x - mu.x * curvature.y + along * a;
        let height = momentum.height(second, pose);
        let swept = |push: &Push| length * push.by.perp(rate);
        for one in pushes {
            for other in pushes {
                let mut pair = 0.5 * higher(&height, rate, one, other);
                if gain.is_priced() {
                    pair -= dearer(second, rate, one, other);
                }
                self.half[(one.knot, other.knot)] += length * pair;
            }
            // Made symmetric in the end.
            let area = 0.5 * swept(one);
            let mut before = self.half.column_mut(one.knot);
            before.axpy(area * c, &self.turned, 1.0);
            before.axpy(area * a, &self.aside, 1.0);
        }
        for push in pushes {
            self.turned[push.knot] += a * swept(push);
            self.reach[push.knot] += (a * swept(push)).abs();
            self.aside[push.knot] -= c * swept(push);
        }
    }

    /// Form of a quarter with this displacement along p. Its images reverse its rotation, so rotation is not constrained. The rotation
    /// at its end has no effect, which determines c = −p × r there; c therefore changes with the perturbation.
    pub(super) fn of_quarter(mut self, along: f64) -> Self {
        let moved = &self.aside + &self.turned * along;
        self.half.ger(-0.25, &moved, &self.turned, 1.0);
        self.half.ger(-0.25, &self.turned, &moved, 1.0);
        self
    }

    /// Form of a whole cycle, with d free to rotate, or measured against the heading at the start, which perturbations of the first
    /// shape rotate by `started`.
    pub(super) fn of_whole_cycle(
        mut self,
        gain: Gain,
        (p, d): (&Vector2<f64>, &Vector2<f64>),
        started: &DVector<f64>,
    ) -> Self {
        let along = p.dot(d);
        match gain {
            Gain::Turning => {}
            Gain::Displacement | Gain::Efficiency => {
                self.half.ger(0.5 / along, &self.aside, &self.aside, 1.0);
            }
            Gain::Sideways => {
                self.half.ger(0.5, started, &self.aside, 1.0);
                self.half.ger(0.5, &self.aside, started, 1.0);
                self.half.ger(-0.5 * along, started, started, 1.0);
            }
        }
        self
    }
}

/// Local term: change of the height by one perturbation times the area swept by the other, symmetrised.
fn higher(height: &Height, rate: &Vector2<f64>, one: &Push, other: &Push) -> f64 {
    let moved = |one: &Push, other: &Push| {
        height.gradient.dot(&one.by) * other.by.perp(rate)
            + height.value * one.by.perp(&other.slope)
    };
    0.5 * (moved(one, other) + moved(other, one))
}

/// Half of the second variation of √P at P = 1.
fn dearer(second: &SecondDerivatives<f64>, rate: &Vector2<f64>, one: &Push, other: &Push) -> f64 {
    let ([d1, d2], [w11, w12, w22]) = (&second.first.d_power, &second.d2_power);
    let heavier = |push: &Push| -> Matrix2<f64> { d1 * push.by.x + d2 * push.by.y };
    let power = |push: &Push| {
        2.0 * push.slope.dot(&(second.first.power * rate)) + rate.dot(&(heavier(push) * rate))
    };
    let xy = one.by.x * other.by.y + one.by.y * other.by.x;
    let bent = w11 * (one.by.x * other.by.x) + w12 * xy + w22 * (one.by.y * other.by.y);
    let moved = other.slope.dot(&(heavier(one) * rate)) + one.slope.dot(&(heavier(other) * rate));
    let slopes = one.slope.dot(&(second.first.power * other.slope));
    0.5 * (slopes + moved + 0.5 * rate.dot(&(bent * rate))) - 0.125 * power(one) * power(other)
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::{
        Fourier, Gait, GaitPoint, Harmonic, Model, Stroke, Swimmer, SymmetricFourier, Tolerance,
        swim,
    };

    type Round = SymmetricFourier<[[f64; 2]; 2]>;

    /// Perturbations of both joints; 0 keeps the first shape fixed.
    fn pushes(from_the_start: f64) -> [Fourier<f64, Vec<Harmonic<f64>>>; 3] {
        let push = |mean: [f64; 2], harmonics: [[[f64; 2]; 2]; 2]| Fourier {
            mean: Vector2::from(mean) * from_the_start,
            harmonics: harmonics
                .map(|[cos, sin]| Harmonic {
                    cos: Vector2::from(cos) * from_the_start,
                    sin: sin.into(),
                })
                .into(),
        };
        [
            push(
                [0.0, 0.2],
                [[[0.7, 0.0], [0.1, -0.8]], [[0.0; 2], [0.3, 1.0]]],
            ),
            push(
                [0.1, 0.0],
                [[[0.0; 2], [0.6, -0.5]], [[1.0, 0.3], [0.0, 0.4]]],
            ),
            push(
                [0.3, 0.1],
                [[[0.2, 0.4], [1.0, 0.3]], [[0.0; 2], [0.2, 0.0]]],
            ),
        ]
    }

    struct Pushed<'a>(
        &'a Round,
        &'a [Fourier<f64, Vec<Harmonic<f64>>>; 3],
        DVector<f64>,
    );

    impl Gait<f64> for Pushed<'_> {
        fn at(&self, u: f64) -> GaitPoint<f64> {
            let Self(round, pushes, weights) = self;
            let mut point = round.at(u);
            for (push, weight) in pushes.iter().zip(weights) {
                let by = push.at(u);
                point.phi += by.phi * *weight;
                point.rate += by.rate * *weight;
            }
            point
        }
    }

    /// The form agrees with mixed finite differences of the value, integrated by the model, for two perturbations without net rotation,
    /// each combined with a third.
    #[test]
    fn the_second_variation_is_that_of_the_value() {
        const COUNT: usize = 4000;
        const H: f64 = 1e-3;
        let model = Model::new(&Swimmer::robot().of_unit_length()).unwrap();
        // With the paper's symmetries it has no net rotation.
        let round: Round = SymmetricFourier {
            coefficients: [[1.3, 1.1], [0.1, -0.05]],
        };
        let swum = |pushed: &dyn Gait<f64>| swim(&model, pushed, &Tolerance::new(1e-12));
        let d = swum(&round).displacement;
        for (gain, p) in [
            (Gain::Displacement, d / d.norm()),
            (Gain::Efficiency, 3.0 * d),
            (Gain::Sideways, Vector2::new(0.6, 0.8)),
            (Gain::Turning, Vector2::zeros()),
        ] {
            let momentum = Momentum { p, c: 0.3 };
            let value = |stroke: &Stroke<f64>| {
                let d = stroke.displacement;
                // c is the weight of the rotation at the end; p along d does not contribute.
                (momentum.c + p.perp(&d)) * stroke.rotation
                    + match gain {
                        Gain::Displacement => d.norm(),
                        Gain::Efficiency => p.norm() * d.norm() - stroke.power_length,
                        Gain::Sideways | Gain::Turning => p.dot(&d),
                    }
            };
            let pushes = pushes(if gain == Gain::Sideways { 0.0 } else { 1.0 });
            let mut pose = [0.0; 3];
            let element = |k: usize| {
                let (u, length) = ((k as f64 + 0.5) / COUNT as f64, 1.0 / COUNT as f64);
                let point = round.at(u);
                let second = model.second_derivatives(&point.phi);
                let power = point.rate.dot(&(second.first.power * point.rate));
                let scale = if gain.is_priced() { power.sqrt() } else { 1.0 };
                // Half an element to its midpoint, where it is evaluated, and half beyond.
                let body = second.first.connection * point.rate * length;
                let middle = pose[2] + 0.5 * body.z;
                let (sin, cos) = middle.sin_cos();
                let way = Vector2::new(cos * body.x - sin * body.y, sin * body.x + cos * body.y);
                let [x, y, _] = pose;
                pose = [x + way.x, y + way.y, pose[2] + body.z];
                let push = |(knot, push): (usize, &Fourier<f64, _>)| {
                    let push = push.at(u);
                    let (by, slope) = (push.phi, push.rate / scale);
                    Push { knot, by, slope }
                };
                Element {
                    second,
                    rate: point.rate / scale,
                    pose: [x + 0.5 * way.x, y + 0.5 * way.y, middle],
                    length: length * scale,
                    pushes: pushes.iter().enumerate().map(push).collect(),
                }
            };
            let elements: Vec<Element> = (0..COUNT).map(element).collect();
            let form = Form::new(&elements, 3, gain, &momentum);
            let form = form.of_whole_cycle(gain, (&p, &d), &DVector::zeros(3));
            let third = [0, 1].map(|push| -form.turned[push] / form.turned[2]);
            let without = |push: usize| {
                let mut weights = DVector::zeros(3);
                (weights[push], weights[2]) = (1.0, third[push]);
                weights
            };
            for (one, other) in [(0, 0), (0, 1), (1, 1)] {
                let at = |a: f64, b: f64| {
                    let weights = (without(one) * a + without(other) * b) * H;
                    value(&swum(&Pushed(&round, &pushes, weights)))
                };
                let mixed = at(1.0, 1.0) - at(1.0, -1.0) - at(-1.0, 1.0) + at(-1.0, -1.0);
                let mixed = mixed / (4.0 * H * H);
                let exact = 2.0 * without(one).dot(&(&form.half * without(other)));
                assert!(
                    (mixed - exact).abs() < 2e-5 * (1.0 + exact.abs()),
                    "{gain:?} {one} {other}: {mixed} {exact}"
                );
            }
        }
    }
}
