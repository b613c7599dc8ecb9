//! The equations of motion of an efficiency extremal with its costates, and their exact linearisation.
//!
//! Paper, section V: `H = λᵤ·u + λ₃ẋ + λ₄θ̇ + λ₅ uᵀWu` with `λ₅ = −λ₃²/4` and `λ₄ = λ₃ (y − y_f)`. Over λ₃, and with
//! `κ = 2/λ₃ = E_f/x_f`, the control from `H_u = 0` is `u = κ W⁻¹ (λ + Aᵀm)`, where m = (cos θ, −sin θ, `y − y_f`) is the
//! momentum in the body's frame; `λ̇ₖ = −m·∂ₖA u + uᵀ∂ₖW u / 2κ`. κ is the only parameter: x and E do not act back. Units:
//! L = `c_t` = `t_f` = 1, so W is over the side links' `c_t`.

use nalgebra::{Matrix2, Matrix3x2, Vector2, Vector3};
use swimmer_model::Model;

use crate::runge_kutta::{Point, StepControl, System, controlled_step};

/// φ₁, φ₂, θ, `y − y_f`, λ₁/λ₃, λ₂/λ₃ and x.
pub(crate) type State = [f64; 7];
/// Rates by column: φ₁, φ₂, θ, `y − y_f`, λ₁/λ₃, λ₂/λ₃ and κ. (Nothing depends on x.)
pub(crate) type Jacobian = [[f64; 7]; 7];

/// All extremals of one κ, run forwards (`sense` 1) or backwards (−1) in time.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Flow<'a> {
    /// The swimmer with L = 1.
    pub(crate) model: &'a Model<f64>,
    /// 2/λ₃ = `E_f/x_f`.
    pub(crate) kappa: f64,
    pub(crate) sense: f64,
}

/// What holds at one state.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Moment {
    /// `uᵀWu` over `c_t`.
    pub(crate) power: f64,
    pub(crate) rates: State,
}

pub(crate) fn shape(z: &State) -> Vector2<f64> {
    Vector2::new(z[0], z[1])
}

/// m = (cos θ, −sin θ, `y − y_f`): the momentum over λ₃ in the body's frame.
pub(crate) fn body_momentum(theta: f64, y: f64) -> Vector3<f64> {
    let (sin, cos) = theta.sin_cos();
    Vector3::new(cos, -sin, y)
}

/// Inverse of a power matrix, which is positive definite.
pub(crate) fn inverse(w: &Matrix2<f64>) -> Matrix2<f64> {
    let over = 1.0 / (w.m11 * w.m22 - w.m12 * w.m21);
    Matrix2::new(w.m22, -w.m12, -w.m21, w.m11) * over
}

fn turned(theta: f64, v: &Vector3<f64>) -> (f64, f64) {
    let (sin, cos) = theta.sin_cos();
    (cos * v.x - sin * v.y, sin * v.x + cos * v.y)
}

impl Flow<'_> {
    /// W over the side links' `c_t`, and A.
    pub(crate) fn connection_and_power(
        &self,
        phi: &Vector2<f64>,
    ) -> (Matrix3x2<f64>, Matrix2<f64>) {
        let (a, w) = self.model.connection_and_power(phi);
        (a, w / self.model.side_drag())
    }

    /// Power and rates at a state; forwards in time whatever the sense.
    pub(crate) fn moment(&self, z: &State) -> Moment {
        let first = self.model.first_derivatives(&shape(z));
        let over_drag = 1.0 / self.model.side_drag();
        let momentum = body_momentum(z[2], z[3]);
        let pushed = Vector2::new(z[4], z[5]) + first.connection.transpose() * momentum;
        let control = inverse(&first.power) * pushed * (self.kappa / over_drag);
        let body = first.connection * control;
        let (x, y) = turned(z[2], &body);
        let costate = |k: usize| {
            let curl = momentum.dot(&(first.d_connection[k] * control));
            let dearer = control.dot(&(first.d_power[k] * control)) * over_drag;
            0.5 * dearer / self.kappa - curl
        };
        Moment {
            power: control.dot(&(first.power * control)) * over_drag,
            rates: [control.x, control.y, body.z, y, costate(0), costate(1), x],
        }
    }

    /// `uᵀWu` over `c_t` and its derivatives in φ₁, φ₂, θ, `y − y_f`, λ₁/λ₃, λ₂/λ₃ and κ.
    pub(crate) fn power_slopes(&self, z: &State) -> (f64, [f64; 7]) {
        let first = self.model.first_derivatives(&shape(z));
        let over_drag = 1.0 / self.model.side_drag();
        let (a, kappa) = (first.connection, self.kappa);
        let m = body_momentum(z[2], z[3]);
        let pushed = Vector2::new(z[4], z[5]) + a.transpose() * m;
        let u = inverse(&first.power) * pushed * (kappa / over_drag);
        let power = u.dot(&(first.power * u)) * over_drag;
        // P = κ² pᵀW⁻¹p with p = λ + Aᵀm.
        let by_pushed = |d: Vector2<f64>| 2.0 * kappa * u.dot(&d);
        let by_angle = |j: usize| {
            by_pushed(first.d_connection[j].transpose() * m)
                - u.dot(&(first.d_power[j] * u)) * over_drag
        };
        let by_momentum = |dm: Vector3<f64>| by_pushed(a.transpose() * dm);
        let slopes = [
            by_angle(0),
            by_angle(1),
            by_momentum(Vector3::new(m.y, -m.x, 0.0)),
            by_momentum(Vector3::z()),
            by_pushed(Vector2::x()),
            by_pushed(Vector2::y()),
            2.0 * power / kappa,
        ];
        (power, slopes)
    }

    /// Rates and their derivatives; forwards in time whatever the sense.
    pub(crate) fn linearised(&self, z: &State) -> (State, Jacobian) {
        let second = self.model.second_derivatives(&shape(z));
        let first = &second.first;
        let (a, kappa, over_drag) = (first.connection, self.kappa, 1.0 / self.model.side_drag());
        let w = first.power * over_drag;
        let m = body_momentum(z[2], z[3]);
        let pushed = Vector2::new(z[4], z[5]) + a.transpose() * m;
        let inverse = inverse(&w);
        let u = inverse * pushed * kappa;
        let body = a * u;
        let (x, y) = turned(z[2], &body);
        let by_connection = [first.d_connection[0] * u, first.d_connection[1] * u];
        let by_power = first.d_power.map(|d| d * u * over_drag);
        let dearer = [u.dot(&by_power[0]), u.dot(&by_power[1])];
        let costate = |k: usize| 0.5 * dearer[k] / kappa - m.dot(&by_connection[k]);
        let rates = [u.x, u.y, body.z, y, costate(0), costate(1), x];
        // How the costate rates answer to a change of u and of m.
        let answer = [
            by_power[0] / kappa - first.d_connection[0].transpose() * m,
            by_power[1] / kappa - first.d_connection[1].transpose() * m,
        ];
        let column = |du: Vector2<f64>, dm: Vector3<f64>, explicit: Vector3<f64>| {
            let body = explicit + a * du;
            let (dx, dy) = turned(z[2], &body);
            let costate = [0, 1].map(|k: usize| answer[k].dot(&du) - dm.dot(&by_connection[k]));
            [du.x, du.y, body.z, dy, costate[0], costate[1], dx]
        };
        let zero = Vector3::zeros();
        let by_angle = |j: usize| {
            let du = inverse * (first.d_connection[j].transpose() * m * kappa - by_power[j]);
            let mut column = column(du, zero, by_connection[j]);
            for k in 0..2 {
                let bent = m.dot(&(second.d2_connection[j + k] * u));
                let dearer = u.dot(&(second.d2_power[j + k] * u)) * over_drag;
                column[4 + k] += 0.5 * dearer / kappa - bent;
            }
            column
        };
        let by_momentum =
            |dm: Vector3<f64>| column(inverse * (a.transpose() * dm) * kappa, dm, zero);
        let mut by_theta = by_momentum(Vector3::new(m.y, -m.x, 0.0));
        by_theta[3] += x;
        by_theta[6] -= y;
        let mut by_kappa = column(u / kappa, zero, zero);
        for k in 0..2 {
            by_kappa[4 + k] -= 0.5 * dearer[k] / (kappa * kappa);
        }
        let jacobian = [
            by_angle(0),
            by_angle(1),
            by_theta,
            by_momentum(Vector3::z()),
            column(inverse.column(0) * kappa, zero, zero),
            column(inverse.column(1) * kappa, zero, zero),
            by_kappa,
        ];
        (rates, jacobian)
    }
}

impl System<7> for Flow<'_> {
    fn rate(&self, z: &State) -> State {
        self.moment(z).rates.map(|rate| rate * self.sense)
    }
}

/// The flow with `COLUMNS` solutions of its variational equations beside it: N = 7 (1 + `COLUMNS`).
#[derive(Debug, Clone, Copy)]
pub(crate) struct Variation<'a, const COLUMNS: usize> {
    pub(crate) flow: Flow<'a>,
    /// How κ changes along each.
    pub(crate) d_kappa: [f64; COLUMNS],
}

impl<const COLUMNS: usize, const N: usize> System<N> for Variation<'_, COLUMNS> {
    fn rate(&self, z: &[f64; N]) -> [f64; N] {
        let (here, columns) = z.split_at(7);
        let here = std::array::from_fn(|i| here.get(i).copied().unwrap_or(f64::NAN));
        let (rates, jacobian) = self.flow.linearised(&here);
        let mut all = [0.0; N];
        let (first, rest) = all.split_at_mut(7);
        first.copy_from_slice(&rates.map(|rate| rate * self.flow.sense));
        let both = rest.chunks_exact_mut(7).zip(columns.chunks_exact(7));
        for ((out, column), d_kappa) in both.zip(&self.d_kappa) {
            for (part, factor) in jacobian.iter().zip(column[..6].iter().chain([d_kappa])) {
                let factor = factor * self.flow.sense;
                for (sum, value) in out.iter_mut().zip(part) {
                    *sum += factor * value;
                }
            }
        }
        all
    }
}

/// More steps than any extremal worth following takes.
const MOST_STEPS: usize = 400;
/// Joint angles beyond this have run away \[rad\].
const RUN_AWAY: f64 = 12.0;

/// Integrates over exactly `length`; none where the steps become too short or too many, or the angles run away.
pub(crate) fn advance<const N: usize>(
    system: &impl System<N>,
    start: [f64; N],
    length: f64,
    tolerance: f64,
) -> Option<[f64; N]> {
    steps(system, start, length, tolerance, f64::INFINITY, |_, _| ())
}

/// The same in steps of at most `longest`, with a look at the end of each and at its length.
pub(crate) fn steps<const N: usize>(
    system: &impl System<N>,
    start: [f64; N],
    length: f64,
    tolerance: f64,
    longest: f64,
    mut look: impl FnMut(&[f64; N], f64),
) -> Option<[f64; N]> {
    let control = StepControl { tolerance, longest };
    let mut here = Point::new(system, start);
    let (mut left, mut next) = (length, length.min(0.1));
    for _ in 0..MOST_STEPS {
        // Two nearly equal last steps rather than a long and a tiny one.
        let ahead = if next >= left {
            left
        } else {
            next.min(0.5 * left)
        };
        let step = controlled_step(system, &here, ahead, control)?;
        here = step.end;
        look(&here.z, step.length);
        if here.z.iter().take(2).any(|phi| phi.abs() > RUN_AWAY) {
            return None;
        }
        if step.length >= left {
            return Some(here.z);
        }
        left -= step.length;
        next = step.next;
    }
    None
}

#[cfg(test)]
mod tests {
    use super::*;
    use swimmer_model::Swimmer;

    const HERE: State = [0.7, 1.9, 0.4, -0.13, 0.02, -0.05, 0.3];

    /// Each column of the linearisation is the central difference of the rates.
    #[test]
    fn the_linearisation_is_the_derivative_of_the_rates() {
        for swimmer in [Swimmer::purcell(), Swimmer::robot()] {
            let model = Model::new(&swimmer.of_unit_length()).unwrap();
            let flow = Flow {
                model: &model,
                kappa: -4.1,
                sense: 1.0,
            };
            let (rates, jacobian) = flow.linearised(&HERE);
            let moment = flow.moment(&HERE);
            for (one, two) in rates.iter().zip(&moment.rates) {
                assert!((one - two).abs() < 1e-13 * (1.0 + one.abs()));
            }
            let h = 1e-5;
            for (j, column) in jacobian.iter().enumerate() {
                let moved = |h: f64| {
                    let (mut z, mut flow) = (HERE, flow);
                    if j < 6 {
                        z[j] += h;
                    } else {
                        flow.kappa += h;
                    }
                    flow.moment(&z).rates
                };
                let (up, down) = (moved(h), moved(-h));
                for (i, exact) in column.iter().enumerate() {
                    let numeric = (up[i] - down[i]) / (2.0 * h);
                    assert!(
                        (numeric - exact).abs() < 1e-7 * (1.0 + exact.abs()),
                        "row {i}, column {j}: {numeric} {exact}"
                    );
                }
            }
        }
    }

    #[test]
    fn the_slopes_of_the_power_are_its_derivatives() {
        let model = Model::new(&Swimmer::robot().of_unit_length()).unwrap();
        let flow = Flow {
            model: &model,
            kappa: -4.1,
            sense: 1.0,
        };
        let (power, slopes) = flow.power_slopes(&HERE);
        assert!((power - flow.moment(&HERE).power).abs() < 1e-13 * power);
        for (j, exact) in slopes.iter().enumerate() {
            let moved = |h: f64| {
                let (mut z, mut flow) = (HERE, flow);
                if j < 6 {
                    z[j] += h;
                } else {
                    flow.kappa += h;
                }
                flow.moment(&z).power
            };
            let numeric = (moved(1e-5) - moved(-1e-5)) / 2e-5;
            assert!((numeric - exact).abs() < 1e-6 * (1.0 + exact.abs()), "{j}");
        }
    }

    /// The power is a constant of the motion: the Hamiltonian is `−λ₅` times it.
    #[test]
    fn the_power_stays_what_it_is() {
        let model = Model::new(&Swimmer::purcell()).unwrap();
        let flow = Flow {
            model: &model,
            kappa: 3.0,
            sense: 1.0,
        };
        let before = flow.moment(&HERE).power;
        let after = flow
            .moment(&advance(&flow, HERE, 0.3, 1e-12).unwrap())
            .power;
        assert!((after / before - 1.0).abs() < 1e-10, "{before} {after}");
    }
}
